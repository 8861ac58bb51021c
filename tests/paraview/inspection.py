# SPDX-License-Identifier: GPL-3.0-or-later
"""What the checks in real ParaView share. A failing reader does not change pvbatch's exit status, nor does it raise:
every claim is checked by what was read."""
import os
import sys
import traceback

from paraview.simple import OpenDataFile, PVDReader
from paraview.servermanager import Fetch


def require(condition, claim):
    if not condition:
        raise AssertionError(claim)


def leaves(data, name=''):
    """(block name, data set) of a data set or of all the leaves of a multi-block data set."""
    if data.IsA('vtkMultiBlockDataSet'):
        for number in range(data.GetNumberOfBlocks()):
            meta = data.GetMetaData(number)
            block_name = meta.Get(data.NAME()) if meta else None
            if data.GetBlock(number):
                yield from leaves(data.GetBlock(number), block_name)
    else:
        yield name, data


def strings(data, name):
    """A list of names kept in a data set's field data."""
    array = data.GetFieldData().GetAbstractArray(name)
    require(array is not None, 'no field data array ' + name)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def read_pvd(file):
    """The reader, its times, and a function that gives the data of a time."""
    require(os.path.isfile(file), file + ' is not there')
    reader = PVDReader(FileName=file)
    reader.UpdatePipelineInformation()

    def at(time):
        reader.UpdatePipeline(time)
        return next(leaves(Fetch(reader)))[1]
    return reader, [float(t) for t in reader.TimestepValues], at


def read_file(file):
    """The leaves of any file that ParaView opens."""
    require(os.path.isfile(file), file + ' is not there')
    reader = OpenDataFile(file)
    require(reader is not None, 'ParaView has no reader for ' + file)
    reader.UpdatePipeline()
    return list(leaves(Fetch(reader)))


def arrays(attributes):
    return [attributes.GetArrayName(i) for i in range(attributes.GetNumberOfArrays())]


def finite_range(attributes, name):
    """Smallest and largest value over all components, all of which must be numbers."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    import numpy
    array = attributes.GetArray(name)
    require(array is not None, 'no array %s; there are %s' % (name, arrays(attributes)))
    values = vtk_to_numpy(array)
    require(values.size > 0 and bool(numpy.isfinite(values).all()), name + ' has values that are not finite')
    return float(values.min()), float(values.max())


def picture_figures(png):
    """(mean, share of pixels with a channel at 255, share of pixels that are background, width, height), 0..1."""
    from vtkmodules.vtkIOImage import vtkPNGReader
    from vtkmodules.util.numpy_support import vtk_to_numpy
    require(os.path.isfile(png) and os.path.getsize(png) > 0, png + ' was not drawn')
    reader = vtkPNGReader()
    reader.SetFileName(png)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)[:, :3]
    background = pixels[0]
    empty = (abs(pixels - background).max(axis=1) <= 1.0).mean()
    return pixels.mean() / 255, (pixels.max(axis=1) >= 255).mean(), empty, width, height


def check_picture(png, size=None):
    mean, saturated, empty, width, height = picture_figures(png)
    print('%s: mean %.3f, saturated %.3f, background %.3f' % (png, mean, saturated, empty))
    require(size is None or (width, height) == size, 'the picture has %d x %d pixels' % (width, height))
    require(empty < 0.9, 'the picture is empty')
    require(mean > 0.05, 'the picture is black')
    require(saturated < 0.25, 'the picture is blown out')


def run(main):
    """Runs main(arguments); pvbatch's exit status tells whether it came through."""
    try:
        main(sys.argv[1:])
    except BaseException:
        traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(1)
    print('passed')
