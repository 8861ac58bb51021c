# SPDX-License-Identifier: GPL-3.0-or-later
"""check_view_script.py CASE: view.py draws colours, a scalar, a component, object names, and says what is wrong."""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inspection import check_picture, require, run

SIZE = (320, 240)


def call(folder, *options):
    command = [os.environ.get('KINELUX_PVBATCH', '/usr/bin/pvbatch3.11'), os.path.join(folder, 'view.py'),
               '--size', '%dx%d' % SIZE, *options]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    return result.returncode, result.stdout


def main(arguments):
    folder = os.path.abspath(arguments[0])
    with tempfile.TemporaryDirectory() as temporary:
        for number, options in enumerate(((), ('--frame', '2', '--array', 'Irradiance_lx'),
                                          ('--array', 'Irradiance_lx', '--component', '1', '--log'),
                                          ('--array', 'ErrorEstimate_lx'), ('--array', 'ObjectId'))):
            png = os.path.join(temporary, '%d.png' % number)
            status, output = call(folder, '--png', png, *options)
            require(status == 0 and 'Traceback' not in output, '%s:\n%s' % (options, output))
            check_picture(png, SIZE)
        for options, message in ((('--array', 'Nothing'), 'there is no array Nothing'),
                                 (('--frame', '3'), 'there is no frame 3')):
            status, output = call(folder, '--png', os.path.join(temporary, 'no.png'), *options)
            require(message in output, '%s is not answered by "%s":\n%s' % (options, message, output))
            require(not os.path.exists(os.path.join(temporary, 'no.png')), 'a picture in spite of an error')


run(main)
