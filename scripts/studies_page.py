# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/accuracy-and-cost.md out of folders of `kinelux study`; called by make_studies.

studies_page.py DOCS STUDY...
"""

import json
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "stages/study"), str(ROOT / "stages/pages")]

import page


def share(count, of):
    return f"{count} of {of}"


def summary(studies):
    """The quality of all rows together."""
    rows = [row for study in studies for row in study["rows"]]
    lines = []
    for accuracy in (0.03, 0.01):
        asked = [row for row in rows if row["accuracy"] == accuracy]
        kept = sum(row["keeps_accuracy"] for row in asked)
        lines.append(f"- asked for {100 * accuracy:g} %: the measured error is within it in {share(kept, len(asked))} scenes;")
    judged = [row for row in rows if row["estimate_to_true"] is not None]
    good = sum(0.5 <= row["estimate_to_true"] <= 3 for row in judged)
    lines.append(f"- estimate / true is between 0.5 and 3 in {share(good, len(judged))} rows whose error is above the noise, "
                 f"below 0.5 in {sum(row['estimate_to_true'] < 0.5 for row in judged)}.")
    return lines


def main():
    docs, folders = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    studies = [json.loads((folder / "study.json").read_text(encoding="utf-8")) for folder in folders]
    pictures = docs / "studies"
    pictures.mkdir(exist_ok=True)
    text = ["# What accuracy costs", "",
            "Made by `scripts/make_studies`, which runs `kinelux study` on the shipped scenes ([how](study.md)). Times are wall",
            "time of all stages on 2 cores of a shared virtual machine; of animations the first ten frames.", ""]
    text += summary(studies) + [""]
    for folder, study in zip(folders, studies):
        text += [f"## {study['title']}", "", f"`{study['scene']}`. {study['advice']}", "", page.table_markdown(study), ""]
        for name in ("error_against_time", "time_per_stage"):
            if (folder / f"{name}.png").exists():
                shutil.copy(folder / f"{name}.png", pictures / f"{folder.name}-{name}.png")
                text.append(f"![{name.replace('_', ' ')}](studies/{folder.name}-{name}.png)")
        text.append("")
        for line in page.notes(study)[2:]:
            text += [line, ""]
    text += ["Columns: *estimated* and *measured* errors are relative RMS of radiosity and irradiance in the worst judged frame;",
             "*noise* is that of the path tracing, taken out of *measured*; *to next finer* is the difference from the row below;",
             "*kept*: the measured error is within what was asked for, but for the noise.", ""]
    (docs / "accuracy-and-cost.md").write_text("\n".join(text), encoding="utf-8")
    print(docs / "accuracy-and-cost.md")


main()
