# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a study for the terminal, for Markdown and as one page of HTML that needs no other file."""

import document
from document import escape


def percent(value):
    return "" if value is None else f"{100 * value:.2g}"


def table(study):
    """Columns and cells, as text."""
    several = any(row["engine"] != "auto" or row["degree"] != "auto" for row in study["rows"])
    columns = ["asked for %"] + (["engine", "degree"] if several else []) + [
        "time s", "memory MiB", "unknowns", "blocks", "estimated %", "measured %", "noise %", "to next finer %",
        "estimate / true", "kept"]
    cells = []
    for row in study["rows"]:
        ratio = row["estimate_to_true"]
        cells.append([f"{100 * row['accuracy']:g}"] + ([row["engine"], row["degree"]] if several else []) + [
            f"{row['seconds']:.3g}", f"{row['peak_memory_mib']:.0f}", str(row["unknowns"]), str(row["blocks"]),
            percent(row["estimated_error"]), percent(row["measured_error"]), percent(row["reference_noise"]),
            percent(row["to_next_finer"]), "" if ratio is None else f"{ratio:.2f}", "yes" if row["keeps_accuracy"] else "no"])
    return columns, cells


def table_text(study):
    columns, cells = table(study)
    widths = [max(len(line[k]) for line in [columns] + cells) for k in range(len(columns))]
    return "\n".join("  ".join(word.rjust(width) for word, width in zip(line, widths)) for line in [columns] + cells)


def table_markdown(study):
    columns, cells = table(study)
    return "\n".join("| " + " | ".join(line) + " |" for line in [columns, ["---"] * len(columns)] + cells)


def notes(study):
    """What the numbers are, in sentences."""
    truth = study["reference"]
    lines = [
        "Errors are relative RMS of irradiance over surfaces that do not emit, in the worst of the judged frames "
        f"({', '.join(str(f) for f in truth['frames'])}), at {truth['points_per_frame']} points per frame, against path "
        f"tracing whose own noise of {percent(truth['noise'])} % is taken out in quadrature. To next finer: difference from "
        "the row below at the same points.",
        "Time is that of all stages; it depends on the machine, ratios between rows do so less."]
    for slope in study["slopes"]:
        if slope["slope"] is not None:
            name = "" if (slope["engine"], slope["degree"]) == ("auto", "auto") else \
                f" (engine {slope['engine']}, degree {slope['degree']})"
            lines.append(f"Time grows like the measured error to the power {slope['slope']:.2f}{name}" + (
                f"; 1 % takes {slope['time_1_to_10_percent']:.1f} times as long as 10 %."
                if slope["time_1_to_10_percent"] else "."))
    if study["left_out"]:
        rows = [row["row"].removeprefix("auto-degree-auto-") + (f" (about {row['expected_seconds']:.0f} s)"
                                                                 if row["expected_seconds"] else "")
                for row in study["left_out"]]
        lines.append(f"Left out for the time limit: {', '.join(rows)}. The same command with more time goes on there.")
    return lines


def write(study, pictures, folder):
    """study.html"""
    columns, cells = table(study)
    body = [f"<h1>What accuracy costs: {escape(study['title'])}</h1>", f"<p class=\"advice\">{escape(study['advice'])}</p>",
            document.table(columns, [[cell(word) for word in line] for line in cells])]
    body += [f"<p>{escape(line)}</p>" for line in notes(study)]
    for title, name in pictures.items():
        body += [f"<h2>{escape(title)}</h2>", document.image((folder / name).read_bytes(), title)]
    body.append(f"<p>{escape(study['program'])}, {escape(study['scene'])}</p>")
    document.write(folder / "study.html", document.document(f"{study['title']}: what accuracy costs", body))


def cell(word):
    return document.cell(escape(word), *(["bad"] if word == "no" else []))
