#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run_pvbatch.sh SCRIPT ARGUMENTS...: runs a script in ParaView without a screen. KINELUX_PVBATCH and
# KINELUX_PARAVIEW_PYTHONPATH say where ParaView is, else it is where scripts/install-deps puts it. Without a DISPLAY one
# is started for the time of the run.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/lib.sh"
pvbatch=${KINELUX_PVBATCH:-$pvbatch}
paraview_python=${KINELUX_PARAVIEW_PYTHONPATH:-$paraview_python}

[ -x "$pvbatch" ] || die "$pvbatch is not there: run scripts/install-deps picture, or set KINELUX_PVBATCH"
[ -f "$paraview_python/paraview/simple.py" ] ||
    die "$paraview_python has no ParaView modules: run scripts/install-deps picture, or set KINELUX_PARAVIEW_PYTHONPATH"
[ -n "${DISPLAY:-}" ] || start_display || die "no display could be started"
export LIBGL_ALWAYS_SOFTWARE=1
run_pvbatch "$@"
