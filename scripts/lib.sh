# SPDX-License-Identifier: GPL-3.0-or-later
# Shared by the scripts beside it; sourced, never run. Needs bash and nothing else until packages are installed.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_dir=$root/build/release
bin_dir=$build_dir/bin
python=/usr/bin/python3 # not the first python3 of PATH: only Debian's own sees Debian's modules
pvbatch=/usr/bin/pvbatch3.11
paraview_root=$root/build/paraview-python # where install-deps unpacks ParaView's Python side
paraview_python=$paraview_root/usr/lib/python3/dist-packages
build_jobs=2 # some CGAL sources take 2.6 GB each to compile

say() { printf '%s\n' "$*"; }
warn() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }
die() {
    warn "$1"
    exit "${2:-1}"
}

# seconds_between START END, both from now(): whole numbers would hide the fast second run.
now() { date +%s.%N; }
seconds_between() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.1f", b - a }'; }

# configure_release; build_release [TARGET...]: configures only when the build folder is not there yet (ninja itself
# configures again when a CMake file has changed).
configure_release() {
    [ -f "$build_dir/build.ninja" ] || (cd "$root" && cmake --preset release) || die "configuring failed"
}
build_release() {
    local targets=()
    [ $# -eq 0 ] || targets=(--target "$@")
    configure_release
    cmake --build "$build_dir" -j "$build_jobs" "${targets[@]}" || die "the build failed"
}

# generate_meshes SCENE.toml: a scene folder with a generate.py has meshes too large to keep in the repository; they
# are made when they are missing or older than their generator (which writes <folder name>.obj).
generate_meshes() {
    local folder mesh
    folder=$(cd "$(dirname "$1")" && pwd)
    [ -f "$folder/generate.py" ] || return 0
    mesh=$folder/$(basename "$folder").obj
    if [ ! -f "$mesh" ] || [ "$folder/generate.py" -nt "$mesh" ]; then
        "$python" "$folder/generate.py" || die "$folder/generate.py failed"
    fi
}

# A display of our own for everything that renders (Debian's VTK and ParaView draw through X only): started once,
# shared, ended by its process id (-noreset: it would start anew whenever its last client leaves, and refuse the next
# one meanwhile). Sets DISPLAY.
xvfb_pid=
stop_display() {
    [ -z "$xvfb_pid" ] || { kill "$xvfb_pid" && wait "$xvfb_pid"; } 2>/dev/null
    xvfb_pid=
}
start_display() {
    [ -z "$xvfb_pid" ] || return 0
    command -v Xvfb >/dev/null || die "Xvfb is not installed: run scripts/install-deps"
    local folder number= tries
    folder=$(mktemp -d)
    Xvfb -displayfd 3 -screen 0 1600x1200x24 -nolisten tcp -noreset 3>"$folder/number" 2>"$folder/log" &
    xvfb_pid=$!
    trap stop_display EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM
    for ((tries = 0; tries < 300; ++tries)); do
        number=$(cat "$folder/number" 2>/dev/null || true)
        [ -z "$number" ] || break
        kill -0 "$xvfb_pid" 2>/dev/null || break
        sleep 0.1
    done
    [ -n "$number" ] || { cat "$folder/log" >&2; rm -rf "$folder"; die "Xvfb did not start"; }
    rm -rf "$folder"
    export DISPLAY=:$number LIBGL_ALWAYS_SOFTWARE=1
}

# run_pvbatch SCRIPT ARGUMENTS...: needs start_display before.
run_pvbatch() {
    PYTHONPATH=$paraview_python "$pvbatch" "$@"
}

# reference_numbers CASE: prints "<error> <noise>" in percent from the report of kinelux-reference. The one place that
# knows the report's keys.
reference_numbers() {
    "$python" - "$1/reference.json" <<'PYTHON'
import json, sys
def find(node, key):
    if isinstance(node, dict):
        if key in node:
            return node[key]
        node = list(node.values())
    if isinstance(node, list):
        for child in node:
            value = find(child, key)
            if value is not None:
                return value
    return None
report = json.load(open(sys.argv[1]))
error, noise = find(report, "relative_rms_difference"), find(report, "reference_noise")
if error is None:
    sys.exit(f"{sys.argv[1]} has no relative_rms_difference")
print(f"{100 * error:.3g}", "unknown" if noise is None else f"{100 * noise:.3g}")
PYTHON
}
