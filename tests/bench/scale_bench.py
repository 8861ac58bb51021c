#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How time and memory of the coefficients grow with the number of elements, on the furnished rooms; scripts/bench --scale.

Prints a line per size: blocks of all pairs (never) up to 5,000 elements, links between groups (always) throughout.
CPU is the processors' time of all threads, peak the memory of the coefficient stage; the exponent is that of CPU time
from the line above. Where python3-h5py is there, the last column is the relative L2 difference of the radiosity of
what does not emit from that of all pairs. Measured at an accuracy of 1 %.
"""

import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile

SIZES = (1.4, 0.66, 0.355, 0.232, 0.157, 0.106)  # largest edges [m] for about 1, 2, 4, 8, 16 and 32 thousand elements
ACCURACY = "1%"


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def prepare(programs, scene, case, degree, size):
    """From the scene to the plan; the number of elements."""
    subprocess.run([programs / "kinelux-clean", scene, "-o", case, "--quiet", "--accuracy", ACCURACY,
                    "--degree", str(degree), "--element-size", str(size)], check=True)
    for stage in ("fit", "cluster", "plan"):
        subprocess.run([programs / f"kinelux-{stage}", case, "--quiet"], check=True)
    return json.loads((case / "cluster.json").read_text())["counts"]["elements"]


def compute(programs, case, groups):
    """Coefficients and solution; CPU seconds of the first, and both records."""
    before = cpu_seconds()
    subprocess.run([programs / "kinelux-coefficients", case, "--quiet", "--groups", groups], check=True)
    spent = cpu_seconds() - before
    done = subprocess.run([programs / "kinelux-solve", case, "--quiet"], check=False, stderr=subprocess.DEVNULL)
    if done.returncode not in (0, 5):  # 5: an accuracy not reached by such elements, which is not the question here
        raise SystemExit(f"kinelux-solve ended with {done.returncode}")
    return (spent, *(json.loads((case / f"{stage}.json").read_text()) for stage in ("coefficients", "solve")))


def radiosity(case):
    """Coefficients of what does not emit, or nothing without h5py. Emitters are brighter than what arrives."""
    try:
        import h5py
    except ImportError:
        return None
    with h5py.File(case / "solution.h5") as file:
        values = file["radiosity"][0]
        arriving = file["irradiance_direct"][0] + file["irradiance_indirect"][0]
        offsets = file["layout/offsets"][:]
    for first, end in zip(offsets[:-1], offsets[1:]):
        if (values[first] > 1.5 * abs(arriving[first])).any():
            values[first:end] = 0
    return values


def difference(found, expected):
    if found is None or expected is None:
        return "-"
    return f"{100 * float(((found - expected) ** 2).sum() / (expected ** 2).sum()) ** 0.5:.2f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, help="folder of the executables")
    parser.add_argument("scene", type=pathlib.Path, help="furnished.toml, with its meshes beside it")
    parser.add_argument("--degrees", type=int, nargs="*", default=[0, 1])
    parser.add_argument("--sizes", type=float, nargs="*", default=SIZES, help="largest edges of elements [m], falling")
    parser.add_argument("--all-pairs-until", type=int, default=5000, metavar="ELEMENTS",
                        help="larger cases are computed with links only (default 5000)")
    options = parser.parse_args()
    print("degree  groups  elements    blocks     links     Mrays    CPU s    wall s  peak MiB  solve s  exponent  difference")
    for degree in options.degrees:
        before = {}
        for size in options.sizes:
            with tempfile.TemporaryDirectory() as folder:
                case = pathlib.Path(folder) / "case"
                elements = prepare(options.programs, options.scene, case, degree, size)
                expected = None
                for groups in ("never", "always") if elements <= options.all_pairs_until else ("always",):
                    cpu, record, solved = compute(options.programs, case, groups)
                    found = radiosity(case)
                    exponent = "-"
                    if groups in before:
                        exponent = f"{math.log(cpu / before[groups][1]) / math.log(elements / before[groups][0]):.2f}"
                    before[groups] = (elements, cpu)
                    counts = record["counts"]
                    print(f"{degree:>6}  {groups:<6}  {elements:>8}  {counts['blocks']:>8}  {counts['links']:>8}  "
                          f"{counts['rays'] / 1e6:>8.0f}  {cpu:>7.1f}  {record['seconds']:>8.1f}  "
                          f"{record['peak_memory_mib']:>8.0f}  {solved['seconds']:>7.1f}  {exponent:>8}  "
                          f"{difference(found, expected):>10}", flush=True)
                    expected = found


if __name__ == "__main__":
    main()
