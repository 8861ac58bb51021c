# SPDX-License-Identifier: GPL-3.0-or-later
"""check_case.py CASE [--picture PNG]: ParaView opens every file of a case that is meant for it, with its cells, arrays
and names, and view.py draws a picture that is neither empty nor black nor blown out."""
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inspection import arrays, check_picture, finite_range, read_file, read_pvd, require, run, strings

SIZE = (640, 480)


def check_view(folder, scene):
    units = {'photometric': ('lm_m2', 'lx'), 'radiometric': ('W_m2', 'W_m2')}[scene['quantity']]
    radiosity, irradiance = 'Radiosity_' + units[0], 'Irradiance_' + units[1]
    _, times, at = read_pvd(os.path.join(folder, 'view.pvd'))
    require(times and times == sorted(set(times)), 'times are %s' % times)
    require(len(times) <= scene['time']['frames'], 'more frames than the scene has')
    names = [thing['name'] for thing in scene['objects']]
    for time in sorted({times[0], times[len(times) // 2], times[-1]}):
        data = at(time)
        require(data.GetNumberOfCells() > 0, 'no cells at %g s' % time)
        require(strings(data, 'ObjectNames') == names, 'object names are %s' % strings(data, 'ObjectNames'))
        points, cells = data.GetPointData(), data.GetCellData()
        channels = scene['channels']
        for name in (radiosity, irradiance):
            low, high = finite_range(points, name)
            require(high > 0.0, name + ' is nowhere above 0')
            print('%s at %g s: %g to %g' % (name, time, low, high))
            array = points.GetArray(name)
            require(array.GetNumberOfComponents() == len(channels), 'components of ' + name)
            if len(channels) > 1:
                require([array.GetComponentName(c) for c in range(len(channels))] == channels, 'channels of ' + name)
        require('Color' in arrays(points) or len(channels) != 3, 'no array Color')
        finite_range(points, 'Normals')
        for name in ('PatchId', 'ObjectId', 'MaterialId', 'ElementId', 'ClusterId', 'ElementDegree'):
            finite_range(cells, name)
        require(finite_range(cells, 'ObjectId')[1] < len(names), 'an object without a name')
    print('view.pvd: %d frames, %d cells' % (len(times), data.GetNumberOfCells()))


def check_geometry(folder, scene):
    blocks = read_file(os.path.join(folder, 'clean.vtm'))
    require([name for name, _ in blocks] == [thing['name'] for thing in scene['objects']],
            'blocks of clean.vtm are %s' % [name for name, _ in blocks])
    for name, data in blocks:
        require(data.GetNumberOfCells() > 0, 'object %s has no cells' % name)
        for array in ('MaterialId', 'SourceFace', 'TwoSided', 'Reflectance'):
            finite_range(data.GetCellData(), array)
    for file, wanted in (('patches.vtu', ('PatchId', 'ObjectId', 'MaterialId', 'SurfaceType', 'Deviation_m')),
                         ('clusters.vtu', ('ElementId', 'PatchId', 'ClusterId', 'ObjectId'))):
        (_, data), = read_file(os.path.join(folder, file))
        require(data.GetNumberOfCells() > 0, file + ' has no cells')
        for array in wanted:
            finite_range(data.GetCellData(), array)
        print('%s: %d cells' % (file, data.GetNumberOfCells()))


def draw(folder, png, *options):
    """view.py runs in a process of its own, as a user would start it."""
    command = [os.environ.get('KINELUX_PVBATCH', '/usr/bin/pvbatch3.11'), os.path.join(folder, 'view.py'),
               '--png', png, '--size', '%dx%d' % SIZE, *options]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    require(result.returncode == 0, '%s failed:\n%s' % (' '.join(command), result.stdout))
    require('Traceback' not in result.stdout and 'ERR|' not in result.stdout, result.stdout)
    check_picture(png, SIZE)


def main(arguments):
    folder = os.path.abspath(arguments[0])
    scene = json.load(open(os.path.join(folder, 'scene.json')))
    check_view(folder, scene)
    check_geometry(folder, scene)
    with tempfile.TemporaryDirectory() as temporary:
        png = arguments[2] if arguments[1:2] == ['--picture'] else os.path.join(temporary, 'view.png')
        draw(folder, png, '--frame', '-1')


run(main)
