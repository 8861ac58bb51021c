#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How clean, fit and cluster grow with the model; scripts/bench --large-models [TRIANGLES ...].

Rooms full of free-form bodies and pipes of 20,000 triangles each. Prints seconds and MiB of each stage as a Markdown table and
the exponent of growth between the first and the last row.
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile

RINGS, CORNERS = 100, 100
STAGES = ("clean", "fit", "cluster")


def body_point(free_form, number, ring, corner):
    """A point of a bumpy ellipsoid without its poles, or of a pipe [m]."""
    around = 2 * math.pi * corner / CORNERS
    if not free_form:
        return 0.4 * math.cos(around), 0.4 * math.sin(around), 1.2 * ring / RINGS
    t = math.pi * (ring + 0.5) / (RINGS + 1)
    radius = 0.6 * (1 + 0.1 * math.sin(5 * around + number) * math.sin(3 * t) ** 2)
    return (radius * math.sin(t) * math.cos(around), radius * math.sin(t) * math.sin(around),
            0.8 * radius * math.cos(t) + 0.5)


def write_model(file, triangles):
    """A room with as many bodies as make so many triangles, two metres apart."""
    bodies = max(1, round(triangles / (2 * RINGS * CORNERS)))
    columns = math.ceil(math.sqrt(bodies))
    side = 2 * columns
    with file.open("w", encoding="utf-8") as out:
        out.write("o room\n")
        for x, y, z in ((x, y, z) for x in (-1, side) for y in (-1, side) for z in (-1, 3)):
            out.write(f"v {x} {y} {z}\n")
        for face in ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"):
            out.write(f"f {face}\n")
        first = 9
        for number in range(bodies):
            out.write(f"o body{number}\n")
            for ring in range(RINGS + 1):
                for corner in range(CORNERS):
                    x, y, z = body_point(number % 2 == 0, number, ring, corner)
                    out.write(f"v {x + 2 * (number % columns):.6f} {y + 2 * (number // columns):.6f} {z:.6f}\n")
            for ring in range(RINGS):
                for corner in range(CORNERS):
                    a, b = first + ring * CORNERS + corner, first + ring * CORNERS + (corner + 1) % CORNERS
                    out.write(f"f {a} {a + CORNERS} {b + CORNERS}\nf {a} {b + CORNERS} {b}\n")
            first += (RINGS + 1) * CORNERS


def measure(programs, triangles, folder):
    """@return  triangles, then seconds and MiB of each stage"""
    model, case = folder / f"{triangles}.obj", folder / f"{triangles}.case"
    write_model(model, triangles)
    result = []
    for stage in STAGES:
        arguments = [model, "-o", case] if stage == "clean" else [case]
        subprocess.run([str(programs / f"kinelux-{stage}"), *map(str, arguments), "--quiet"], check=True,
                       stderr=subprocess.DEVNULL)
        record = json.loads((case / f"{stage}.json").read_text(encoding="utf-8"))
        result += [record["seconds"], record["peak_memory_mib"]]
    faces = sum(part["faces_in"] for part in json.loads((case / "clean.json").read_text(encoding="utf-8"))["objects"])
    return [faces, *result]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, help="folder of the executables")
    parser.add_argument("triangles", type=int, nargs="*", default=[100_000, 300_000, 1_000_000])
    options = parser.parse_args()
    rows = []
    print("| triangles | " + " | ".join(f"{stage} s | MiB" for stage in STAGES) + " | sum s |\n|" + "---|" * (2 * len(STAGES) + 2))
    with tempfile.TemporaryDirectory() as folder:
        for triangles in options.triangles:
            row = measure(options.programs, triangles, pathlib.Path(folder))
            rows.append((row[0], sum(row[1::2])))
            print(f"| {row[0]} | " + " | ".join(f"{value:.3g}" for value in row[1:]) + f" | {rows[-1][1]:.3g} |", flush=True)
    if len(rows) > 1:
        (n0, s0), (n1, s1) = rows[0], rows[-1]
        print(f"\nTime grows as triangles to the power {math.log(s1 / s0) / math.log(n1 / n0):.2f}.")


main()
