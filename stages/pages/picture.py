# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a case, drawn by ParaView's pvbatch where there is one. $KINELUX_PVBATCH names another program,
$KINELUX_PARAVIEW_PYTHONPATH the folder of its Python modules where these are not in its own."""

import os
import shutil
import subprocess

LONGEST_S = 600
TRIES = 2     # xvfb-run may choose a display that another one takes at the same time


def draw(case, file, frame, size):
    """One frame by the case's view.py, into a PNG file.
    @param frame  number in the order of time, from 0
    @param size  "WIDTHxHEIGHT" [pixels]
    @return  nothing, or why there is no picture"""
    program = os.environ.get("KINELUX_PVBATCH") or shutil.which("pvbatch")
    if not program:
        return "there is no pvbatch"
    command = [program, str(case / "view.py"), "--png", str(file), "--frame", str(frame), "--size", size]
    if "DISPLAY" not in os.environ and shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24 -nolisten tcp"] + command
    surroundings = dict(os.environ)
    modules = os.environ.get("KINELUX_PARAVIEW_PYTHONPATH")
    if modules:
        surroundings["PYTHONPATH"] = modules
    reason = None
    for _ in range(TRIES):
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False,
                                  timeout=LONGEST_S, env=surroundings)
        except OSError as error:
            return f"{program} cannot be started: {error.strerror}"
        except subprocess.TimeoutExpired:
            return f"pvbatch took longer than {LONGEST_S} s"
        if done.returncode == 0 and file.exists():
            return None
        reason = "pvbatch failed: " + telling_line(done.stderr)
    return reason


def telling_line(output):
    """The last line that speaks of an error, or the last one."""
    lines = [line.strip() for line in output.splitlines() if line.strip()] or ["no message"]
    return next((line for line in reversed(lines) if "error" in line.lower()), lines[-1])
