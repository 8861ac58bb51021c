# SPDX-License-Identifier: GPL-3.0-or-later
"""check_example.py CASE: ParaView shows what make_example wrote: times, arrays, names, ranges, counts."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inspection import arrays, finite_range, read_pvd, require, run, strings

NAMES = ['floor/main', "Lampe \u00e4 'x' & <y>"]
END_S = 0.1 + 0.2
CELLS = 2 * 16 * 16 + 2 * 4 * 4
POINTS = 17 * 17 + 5 * 5


def main(arguments):
    _, times, at = read_pvd(os.path.join(arguments[0], 'view.pvd'))
    require(times == [0.0, 0.0 + 1 * (END_S - 0.0) / 2, END_S], 'times are %s' % times)
    for time in times:
        data = at(time)
        require(data.GetNumberOfCells() == CELLS, '%d cells' % data.GetNumberOfCells())
        require(data.GetNumberOfPoints() == POINTS, '%d points' % data.GetNumberOfPoints())
        require(strings(data, 'ObjectNames') == NAMES, 'objects are %s' % strings(data, 'ObjectNames'))
        require(strings(data, 'MaterialNames') == ['white', 'lamp <1>'], 'material names')
        points, cells = data.GetPointData(), data.GetCellData()
        for name in ('Irradiance_lx', 'Radiosity_lm_m2', 'ErrorEstimate_lx', 'Normals', 'Color'):
            require(name in arrays(points), 'no point array ' + name)
        require([points.GetArray('Irradiance_lx').GetComponentName(c) for c in range(3)] == ['red', 'green', 'blue'],
                'components of irradiance')
        require(finite_range(points, 'Irradiance_lx')[1] <= 200.0, 'irradiance is above 200 lx')
        require(finite_range(points, 'Irradiance_lx')[1] > 150.0, 'the lamp is not above the floor')
        require(finite_range(points, 'Color')[1] <= 255, 'colour range')
        require(finite_range(cells, 'ObjectId') == (0.0, 1.0), 'objects of cells')
        require(finite_range(cells, 'PatchId') == (-1.0, 0.0), 'patches of cells')
        require(finite_range(cells, 'ClusterId') == (-1.0, 0.0), 'clusters of cells')
        require(finite_range(cells, 'ElementDegree') == (0.0, 2.0), 'degrees of cells')
        require(finite_range(cells, 'MaterialId') == (0.0, 1.0), 'materials of cells')
        require(finite_range(cells, 'ElementId') == (0.0, 1.0), 'elements of cells')
    first, last = at(times[0]).GetBounds(), at(times[-1]).GetBounds()
    require(first[:4] == (0.0, 2.0, 0.0, 2.0) and first[5] == 1.5, 'bounds of the first frame %s' % (first,))
    lamp = at(times[-1]).GetPoint(17 * 17)  # its corner, turned by 90 degrees about (0, 0) and moved by (1, 0.5)
    require(abs(lamp[0] - 1.0) < 1e-6 and abs(lamp[1] - 0.5) < 1e-6, 'the lamp is at %s' % (lamp,))
    require(last != first or lamp != at(times[0]).GetPoint(17 * 17), 'nothing moves')


run(main)
