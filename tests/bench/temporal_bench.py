#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a frame costs by each engine of motion, on the scenes in the kind of the publication's; scripts/bench --temporal.

Runs temporal_bench on every scene with and without occlusion and, where python3-matplotlib is there, draws CPU time and
error against the frame. Only ratios within one run mean something: times depend on the machine.
"""

import argparse
import collections
import csv
import pathlib
import subprocess
import tempfile


def prepare(programs, scene, case, size):
    subprocess.run([programs / "kinelux-clean", scene, "-o", case, "--quiet", "--degree", "2",
                    "--element-size", str(size)], check=True)
    for stage in ("fit", "cluster", "plan"):
        subprocess.run([programs / f"kinelux-{stage}", case, "--quiet"], check=True)


def draw(table, title, picture):
    """CPU time and error against the frame, one line a way."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        print("python3-matplotlib is not installed: no plots")
        return
    rows = collections.defaultdict(list)
    with open(table, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            rows[row["way"]].append((int(row["frame"]), 1e3 * float(row["cpu_s"]), 100 * float(row["error"])))
    figure, axes = pyplot.subplots(2, 1, sharex=True, figsize=(8, 6.5), layout="constrained")
    for way, values in rows.items():
        frames, milliseconds, errors = zip(*values)
        axes[0].semilogy(frames, milliseconds, ".-", label=way, markersize=3, linewidth=1)
        axes[1].semilogy(frames, [max(e, 1e-6) for e in errors], ".-", label=way, markersize=3, linewidth=1)
    axes[0].set_ylabel("CPU time per frame [ms]")
    axes[1].set_ylabel("error of radiosity [%]")
    axes[1].set_xlabel("frame")
    axes[0].set_title(title)
    axes[0].legend(ncols=6, fontsize=8)
    figure.savefig(picture, dpi=110)
    print(f"drawn: {picture}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, help="folder of the executables")
    parser.add_argument("bench", type=pathlib.Path, help="temporal_bench")
    parser.add_argument("scenes", type=pathlib.Path, nargs="+", help="scene files, with their meshes beside them")
    parser.add_argument("--element-size", type=float, default=1.5, help="largest edge of an element [m]")
    parser.add_argument("--stride", type=int, default=20, help="of the frames that the classical ways are measured on")
    parser.add_argument("--plots", type=pathlib.Path, help="folder the plots go to")
    options = parser.parse_args()
    for scene in options.scenes:
        for occlusion in (True, False):
            name = f"{scene.stem}, {'with' if occlusion else 'without'} occlusion"
            print(f"\n{name}", flush=True)
            with tempfile.TemporaryDirectory() as folder:
                case, table = pathlib.Path(folder) / "case", pathlib.Path(folder) / "frames.csv"
                prepare(options.programs, scene, case, options.element_size)
                subprocess.run([options.bench, case, "--stride", str(options.stride), "--csv", table] +
                               ([] if occlusion else ["--no-occlusion"]), check=True)
                if options.plots:
                    options.plots.mkdir(parents=True, exist_ok=True)
                    draw(table, name, options.plots / f"{scene.stem}{'' if occlusion else '-clear'}.png")


if __name__ == "__main__":
    main()
