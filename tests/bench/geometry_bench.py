#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of models: clean, fit and cluster on every mesh file of some folders; scripts/bench --geometry.

Prints a Markdown table, the largest models first, and how many were processed or refused; with --refused why. Ends with 1
when a program crashed, hung or ended without a reason.
"""

import argparse
import collections
import json
import pathlib
import subprocess
import sys
import tempfile
import time

SUFFIXES = {".obj", ".ply", ".stl", ".off", ".3ds", ".dae", ".ifc", ".glb", ".gltf", ".dxf", ".step", ".stp", ".iges", ".igs"}
FOLDERS = [pathlib.Path("/usr/share/assimp/models")]
REASONED = (2, 3, 4, 6)


def models(places):
    for place in places:
        files = [place] if place.is_file() else sorted(place.rglob("*"))
        yield from (file for file in files if file.suffix.lower() in SUFFIXES and file.is_file())


def record(case, name):
    return json.loads((case / name).read_text(encoding="utf-8"))


def run(programs, file, case, limit):
    """@return  exit code of the first stage that failed or 0, its last words, seconds of all"""
    began = time.monotonic()
    for command in (["kinelux-clean", file, "-o", case, "--allow-outside"], ["kinelux-fit", case], ["kinelux-cluster", case]):
        command = [str(programs / command[0]), *map(str, command[1:]), "--quiet"]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return None, f"took longer than {limit} s", limit
        if done.returncode != 0:
            words = [line for line in done.stderr.splitlines() if "error" in line]
            return done.returncode, words[-1] if words else "", time.monotonic() - began
    return 0, "", time.monotonic() - began


def row(file, case, seconds):
    objects = record(case, "clean.json")["objects"]
    fit, cluster = record(case, "fit.json"), record(case, "cluster.json")
    total = collections.Counter()
    for part in objects:
        for key, value in part.items():
            if isinstance(value, (int, float)):
                total[key] += value
    faces_in_patches = fit["counts"]["faces_in_patches"]
    pieces = fit["counts"]["patches"] + cluster["counts"]["clusters"]
    megabytes = max(record(case, name)["peak_memory_mib"] for name in ("clean.json", "fit.json", "cluster.json"))
    return {
        "model": file.name, "triangles": total["faces_in"],
        "removed": total["duplicate_faces"] + total["opposite_faces"] + total["degenerate_faces"],
        "stitched": total["joined_points"] + total["divided_edges"], "turned": total["flipped_faces"],
        "crossing": total["crossing_faces"], "closed parts": f"{total['closed_parts']} of {total['parts']}",
        "patches": fit["counts"]["patches"], "triangles in patches %": 100 * faces_in_patches / max(total["faces_out"], 1),
        "clusters": cluster["counts"]["clusters"], "pieces / triangles %": 100 * pieces / max(total["faces_in"], 1),
        "deviation m": fit["figures"]["deviation_m"],
        "s": seconds, "MiB": megabytes}


def shown(value):
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, help="folder of the executables")
    parser.add_argument("places", type=pathlib.Path, nargs="*", default=FOLDERS, help="mesh files and folders of them")
    parser.add_argument("--most", type=int, default=40, help="rows of the table")
    parser.add_argument("--limit", type=float, default=180, help="seconds a stage may take")
    parser.add_argument("--refused", action="store_true", help="list what was refused, and why")
    options = parser.parse_args()
    rows, refused, broken, seen = [], [], [], set()
    with tempfile.TemporaryDirectory() as folder:
        for number, file in enumerate(models(options.places)):
            content = file.read_bytes()
            if content in seen:
                continue
            seen.add(content)
            case = pathlib.Path(folder) / f"{number}.case"
            code, words, seconds = run(options.programs, file, case, options.limit)
            if code == 0:
                rows.append(row(file, case, seconds))
            elif code in REASONED and words:
                refused.append((file.name, code, words))
            else:
                broken.append((file.name, code, words))
    if not rows and not refused:
        sys.exit("no model files there; install assimp-testmodels, or name folders")
    rows.sort(key=lambda r: -r["triangles"])
    if rows:
        print("| " + " | ".join(rows[0]) + " |\n|" + "---|" * len(rows[0]))
        for one in rows[:options.most]:
            print("| " + " | ".join(shown(value) for value in one.values()) + " |")
    print(f"\n{len(rows)} models processed, {len(refused)} refused with a reason, {len(broken)} failed otherwise.")
    if options.refused:
        for name, code, words in refused:
            print(f"- {name}: exit code {code}: {words.split('error: ', 1)[-1]}")
    for name, code, words in broken:
        print(f"- FAILED {name}: {code} {words}")
    sys.exit(1 if broken else 0)


main()
