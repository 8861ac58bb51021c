# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of kinelux study."""

import argparse
import csv
import json
import pathlib
import sys

import page
import plots
import rows

EXIT_OPTIONS, EXIT_SHORT = 2, 5


def percents(text):
    """Accuracies [1] out of "10,3,1" [%]; coarse ones first."""
    try:
        values = sorted({float(word.rstrip("%")) / 100 for word in text.split(",")}, reverse=True)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': expected percents, as 10,3,1") from None
    if not values or values[-1] < 1e-6 or values[0] > 0.5:
        raise argparse.ArgumentTypeError(f"'{text}': expected percents from 0.0001 to 50")
    return values


def words_of(known):
    def words(text):
        unknown = [word for word in text.split(",") if word not in known]
        if unknown:
            raise argparse.ArgumentTypeError(f"'{unknown[0]}': expected some of {', '.join(known)}")
        return text.split(",")
    return words


def positive(text):
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f"'{text}': expected a number above 0")
    return value


def parser():
    result = argparse.ArgumentParser(
        prog="kinelux-study", formatter_class=argparse.ArgumentDefaultsHelpFormatter,
        description="What accuracy costs on this scene: solves it at several settings, measures the true error of each "
                    "against path tracing and against the next finer setting, and says which one to take.")
    result.add_argument("scene", metavar="SCENE", type=pathlib.Path,
                        help="scene file (.toml), or a mesh with emissive materials")
    result.add_argument("-o", "--output", type=pathlib.Path,
                        help="folder of the study [name of the scene with .study, in the current folder]")
    result.add_argument("--accuracies", type=percents, default="10,3,1,0.3,0.1", metavar="PERCENT,...",
                        help="relative errors of radiosity asked for [%%]")
    result.add_argument("--engines", type=words_of(rows.ENGINES), default="auto", metavar="WORD,...",
                        help="engines of motion: " + ", ".join(rows.ENGINES))
    result.add_argument("--degrees", type=words_of(rows.DEGREES), default="auto", metavar="DEGREE,...",
                        help="of the polynomial bases: 0 to 3; auto: from the accuracy")
    result.add_argument("--frames", help="first and last frame that are solved, as 0,10 [all]")
    result.add_argument("--points", type=int, default=400, help="sensor points of the reference per frame")
    result.add_argument("--reference-time", type=positive, default=120.0, metavar="S",
                        help="longest time that path tracing may take [s]")
    result.add_argument("--time-limit", type=positive, metavar="S",
                        help="rows that would end later than this are left out [s]; none: all are run")
    result.add_argument("--allow-outside", action="store_true", help="meshes may lie outside the scene file's folder tree")
    result.add_argument("-j", "--threads", type=int, default=0, help="worker threads, 0 = all cores")
    result.add_argument("-q", "--quiet", action="store_true", help="print warnings, errors and the table only")
    return result


def write(folder, study):
    (folder / "study.json").write_text(json.dumps(study, indent=2) + "\n", encoding="utf-8")
    columns = [name for name in study["rows"][0] if name not in ("stages", "frame_errors")] if study["rows"] else []
    stages = [f"{stage}_{what}" for stage in rows.STAGES for what in ("s", "MiB")]
    with (folder / "study.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(columns + stages)
        for row in study["rows"]:
            used = row["stages"]
            table.writerow([row[name] for name in columns] +
                           [used.get(stage, {}).get(key, "") for stage in rows.STAGES
                            for key in ("seconds", "peak_memory_mib")])


def main(arguments):
    options = parser().parse_args(arguments)
    folder = options.output or pathlib.Path(options.scene.stem + ".study")
    if not options.scene.is_file():
        print(f"kinelux-study: error: {options.scene}: there is no such file", file=sys.stderr)
        return 3
    try:
        study = rows.run(options, folder)
    except rows.StudyError as error:
        print(f"kinelux-study: error: {error}", file=sys.stderr)
        return error.code
    write(folder, study)
    pictures = plots.draw(study, folder)
    page.write(study, pictures, folder)
    print(page.table_text(study))
    print(study["advice"])
    print(folder / "study.html")
    return EXIT_SHORT if study["left_out"] else 0
