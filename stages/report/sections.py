# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the page, each a list of lines of HTML: what the case is, warnings, pictures, plan, cost."""

import pathlib
import tempfile

import charts
import flags
import picture
from case import RECORDS, STAGES
from datum import number, percent
from document import cell, escape, image, short, table, text_column, with_unit

PICTURE_SIZE = "800x600"


def sentence(words):
    return f"<p>{escape(words)}</p>"


def head(case):
    scene = case.scene
    time = scene.get("time", {})
    frames, channels = time.get("frames", 1), scene.get("channels", [])
    when = f"{frames} frames from {short(time['start_s'])} s to {short(time['end_s'])} s" if frames > 1 else "one frame"
    light = {"radiometric": "radiometric (W/m²)", "photometric": "photometric (lm/m², lx)"}.get(scene.get("quantity"), "")
    facts = [f"Made from {pathlib.PurePath(scene.get('source', '')).name}; {len(scene.get('objects', []))} objects, {when}; "
             f"{light}, {'channels' if len(channels) > 1 else 'channel'} {', '.join(channels)}."]
    lines = [f"<h1>{escape(case.title())}</h1>", *map(sentence, facts)]
    solve = case.records["solve"]
    asked = percent(case.target())
    if solve:
        worst = percent(solve.at("figures/error_estimate"))
        over = solve.get("figures/error_estimate", 0.0) > case.target().value
        verdict = "<span class=\"bad\">More than was asked for.</span>" if over else "Within what was asked for."
        lines.append(f"<p class=\"advice\">Estimated error of radiosity, worst frame: <b>{worst}</b>; asked for: {asked}. "
                     f"{verdict}{measured_words(case)}</p>")
    else:
        lines.append(f"<p class=\"advice\">Not solved yet; the error asked for is {asked}.</p>")
    return lines


def measured_words(case):
    reference = case.records["reference"]
    if not reference:
        return ""
    return (f" Measured difference from path tracing: <b>{percent(reference.at('relative_rms_difference'))}</b>, of which the "
            f"path tracing's own noise is {percent(reference.at('reference_noise'))}.")


def warnings(case):
    found = flags.all_of(case)
    lines = ["<h2>Warnings</h2>"]
    if not found:
        lines.append(sentence("None: no stage that was run flagged anything."))
    else:
        lines.append(table([text_column("stage"), text_column("warning")],
                           [[cell(escape(stage), "text"), cell(escape(words), "text", "wide")] for stage, words in found]))
    if case.stale() is None:
        lines.append(sentence("Whether files are out of date was not checked: libxxhash is not installed."))
    notes = flags.mesh_notes(case)
    if notes:
        lines += [f"<details><summary>Notes on the meshes ({len(notes)})</summary>",
                  table([text_column("object"), text_column("note")],
                        [[cell(escape(name), "text"), cell(escape(words), "text", "wide")] for name, words in notes]), "</details>"]
    return lines


def pictures(case, wanted):
    """First, middle and last of the exported frames."""
    lines = ["<h2>Pictures</h2>"]
    if not case.frames:
        return lines + [sentence("No pictures: nothing is exported yet (kinelux-export).")]
    last = len(case.frames) - 1
    shown, reason = [], "they were not asked for"
    with tempfile.TemporaryDirectory() as folder:
        for k in sorted({0, last // 2, last}) if wanted else []:
            file = pathlib.Path(folder) / f"{k}.png"
            reason = picture.draw(case.folder, file, k, PICTURE_SIZE)
            if reason:
                break
            shown.append((file.read_bytes(), "frame {}, {} s".format(case.frames[k][0], short(case.frames[k][1]))))
    kept = case.folder / "view.png"
    if not shown and kept.is_file() and kept.stat().st_mtime >= (case.folder / "view.pvd").stat().st_mtime:
        shown.append((kept.read_bytes(), "view.png, which lies in the case"))
    if shown:
        lines += ["<div class=\"charts\">"] + [
            f"<figure>{image(png, f'{case.title()}: {words}')}<figcaption>{escape(words)}</figcaption></figure>"
            for png, words in shown] + ["</div>"]
    if reason:
        lines.append(sentence(f"{'No more pictures' if shown else 'No pictures'}: {reason}."))
    return lines


def plan(case):
    lines = ["<h2>Plan: which effects are computed</h2>"]
    if case.plan is None:
        return lines + [sentence("There is no plan yet (kinelux-plan).")]
    rows = []
    for effect in case.plan.list("effects"):
        risk = effect.at("risked_error")
        needed = ("yes" if effect.get("simulated") else "no") + (", the scene says so" if effect.get("overridden") else "")
        rows.append([cell(escape(effect.get("name", "")), "text"), cell(needed, "text"),
                     cell(escape(effect.get("reason", "")), "text", "wide"),
                     cell(percent(risk) if risk and risk.value else "none")])
    size = (f"<p>{number(case.plan.at('unknowns'))} unknowns of degree {number(case.plan.at('degree'))} on patches, "
            f"{number(case.plan.at('cluster_degree'))} on clusters; at most {number(case.plan.at('predicted_blocks'))} blocks, "
            f"predicted memory {number(case.plan.at('predicted_memory_mib'), 'MiB')}.</p>")
    return lines + [table([text_column("effect"), text_column("needed"), text_column("because"), "error risked"], rows), size]


def cost(case):
    lines = ["<h2>Time and memory</h2>"]
    run = {stage: case.records[stage] for stage in STAGES if case.records[stage]}
    missing = [stage for stage in STAGES if stage not in run]
    reference = case.records["reference"]
    if run:
        total = sum(record.get("seconds", 0.0) for record in run.values())
        most = max(record.get("peak_memory_mib", 0.0) for record in run.values())
        lines.append(f"<p>All stages: <b>{with_unit(short(total), 's')}</b> wall time, <b>{with_unit(short(most), 'MiB')}</b> peak "
                     "memory.</p>")
        shown = dict(run, reference=reference) if reference else run
        lines += ["<div class=\"charts\"><figure>",
                  charts.bars("Time per stage", "s", {stage: r.get("seconds", 0.0) for stage, r in shown.items()}),
                  "</figure><figure>",
                  charts.bars("Peak memory", "MiB", {stage: r.get("peak_memory_mib", 0.0) for stage, r in shown.items()}),
                  "</figure></div>", "<details><summary>Steps of the stages</summary>", steps(shown), "</details>"]
    if missing:
        lines.append(sentence(f"No record of: {', '.join(missing)}."))
    return lines


def steps(records):
    rows = []
    for stage, record in records.items():
        rows.append([cell(f"<b>{stage}</b>", "text"), cell(f"<b>{number(record.at('seconds'), 's')}</b>"),
                     cell(f"<b>{number(record.at('peak_memory_mib'), 'MiB')}</b>")])
        for name in record.get("steps", {}):
            step = record.at("steps").at(name)
            rows.append([cell(escape(name), "text"), cell(number(step.at("seconds"), "s")),
                         cell(number(step.at("peak_memory_mib"), "MiB"))])
    return table([text_column("stage and its steps"), "time", "peak memory so far"], rows)


def foot(case):
    versions = sorted({record.get("version", "unknown") for record in case.records.values() if record})
    there = [file for file in RECORDS.values() if (case.folder / file).is_file()]
    return [f"<p><small>Kinelux {escape(', '.join(versions) or case.scene.get('program', ''))}. Numbers are rounded here; the exact "
            f"ones are in {escape(', '.join(there + ['scene.json']))} and meters.csv. Where a number follows ±, that is its "
            "estimated error.</small></p>"]
