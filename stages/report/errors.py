# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the page about errors: budget, estimate over frames, flux balance."""

import charts
import flags
from datum import marked, number, percent, percent_text
from document import cell, escape, table, text_column


def worst(frames, key, size=abs):
    """The frame in which a figure is largest, or None."""
    there = [frame for frame in frames if frame.get(key) is not None]
    return max(there, key=lambda frame: size(frame.get(key))) if there else None


def row(part, asked, reached, kept, where):
    """@param kept  None: cannot be said"""
    verdict = cell("") if kept is None else cell("yes") if kept else cell("no", "bad")
    return [cell(escape(part), "text", "name"), cell(asked), cell(reached), verdict, cell(escape(where), "text", "wider")]


def budget(case):
    rows = [line for part in (whole, measured, left_out, geometry, links, form_factors, solver, balance_rows, display)
            for line in part(case)]
    lines = ["<h2>Error budget</h2>"]
    if not rows:
        return lines + ["<p>No stage that has an error was run yet.</p>"]
    return lines + [table([text_column("part"), "asked for", "reached", "kept", text_column("what it is")], rows),
                    "<p>Errors are relative to the light they are of. The estimate of all parts together is no bound.</p>"]


def whole(case):
    solve, target = case.records["solve"], case.target()
    if solve:
        frame = worst(solve.list("frames"), "error_estimate")
        at = f", frame {frame.get('frame')}" if frame else ""
        yield row("radiosity, all parts together", percent(target), percent(solve.at("figures/error_estimate")),
                  solve.get("figures/error_estimate", 0.0) <= target.value,
                  f"estimate of the worst frame{at}: blocks, bases and solver, relative L2 over what does not emit")


def measured(case):
    reference = case.records["reference"]
    if reference:
        asked = reference.at("accuracy_target") or case.target()
        squared = reference.get("relative_rms_difference", 0.0) ** 2 - reference.get("reference_noise", 0.0) ** 2
        yield row("irradiance, measured", percent(asked),
                  f"{percent(reference.at('relative_rms_difference'))} ± {percent(reference.at('reference_noise'))}",
                  squared <= asked.value ** 2,
                  f"difference from path tracing at {reference.get('points')} points, relative RMS; ±: the noise of the path tracing")


def left_out(case):
    if case.plan:
        gone = [effect for effect in case.plan.list("effects") if not effect.get("simulated")]
        risk = sum(effect.get("risked_error", 0.0) for effect in gone)
        names = ", ".join(effect.get("name") for effect in gone) or "none"
        yield row("effects left out", "", percent_text(risk), risk <= case.target().value, f"what they may add: {names}")


def geometry(case):
    fit = case.records["fit"]
    if fit:
        share = fit.at("options/distance_tolerance")
        asked = f"{number(share)} of size" if share else ""
        yield row("geometry", asked, number(fit.at("figures/deviation_m"), "m"), None,
                  "largest distance of a vertex from its patch; size: the diagonal of all that is at rest")
        if fit.get("figures/chords_of_round_faces_m", 0.0) > 0:
            yield row("geometry, round patches", "", number(fit.at("figures/chords_of_round_faces_m"), "m"), None,
                      "largest distance of a face's centroid from its round patch")


def links(case):
    record = case.records["coefficients"]
    if record and record.at("figures/expected_error_of_links"):
        yield row("groups that exchange light as one", "", percent(record.at("figures/expected_error_of_links")),
                  record.get("figures/expected_error_of_links") <= case.target().value, "expected relative error of irradiance")


def form_factors(case):
    record = case.records["coefficients"]
    if not record:
        return
    if record.at("figures/exceed_1_by_up_to"):
        yield row("form factors, sums above 1", "", percent(record.at("figures/exceed_1_by_up_to")), None,
                  "by how much the largest row sum of an element exceeds 1, which none may")
        yield row("form factors, sums below 1", "", percent(record.at("figures/form_factor_rows_miss_up_to")), None,
                  "what the smallest row sum lacks: an error in a closed scene, light that leaves an open one")
    elif record.at("closure/largest_element_row"):
        yield row("form factors", "at most 1", number(record.at("closure/largest_element_row"), digits=5), None,
                  "largest row sum of an element, over the pairs that do not move")


def solver(case):
    solve = case.records["solve"]
    if solve:
        tolerance = solve.at("tolerance")
        yield row("solver", percent(tolerance) if tolerance else "", percent(solve.at("figures/solver_error")),
                  solve.get("figures/solver_error", 0.0) <= tolerance.value if tolerance else None,
                  "what the iteration left in the worst frame, relative L2 of radiosity")


def balance_rows(case):
    solve, target = case.records["solve"], case.target()
    for key, sign, meaning in flags.BALANCES if solve else ():
        frame = worst(solve.list("frames"), key, abs if sign == 0 else lambda flux, s=sign: s * flux)
        if frame is None or not frame.get("emitted_flux"):
            continue
        flux = abs(frame.get(key)) if sign == 0 else max(sign * frame.get(key), 0.0)
        yield row(f"flux, {meaning}", percent(target), percent_text(flux / frame.get("emitted_flux")),
                  not flags.violates(frame, key, target.value),
                  f"of the flux emitted, frame {frame.get('frame')}")


def display(case):
    export = case.records["export"]
    area = export.at("figures/area_of_shadow_edges_sharper_than_cells_m2") if export else None
    if area:
        yield row("display, shadow edges", "", number(area, "m2"), None,
                  "area of cells in which shadow edges are sharper than the cells show")


def over_frames(case):
    lines = ["<h2>Error estimate over frames</h2>"]
    solve = case.records["solve"]
    if solve is None:
        return lines + ["<p>Not solved yet (kinelux-solve).</p>"]
    frames = solve.list("frames")
    if len(frames) > 1:
        asked = case.target().value
        chart = charts.lines("Error estimate over frames", "frame", "error estimate of radiosity", "%",
                             {"estimate": [(f.get("frame"), 100 * f.get("error_estimate", 0.0), 0.0) for f in frames]},
                             100 * asked, f"asked for: {percent_text(asked)}")
        lines.append(f"<div class=\"charts\"><figure>{chart}</figure></div>")
    elif frames:
        lines.append(f"<p>One frame: {percent(frames[0].at('error_estimate'))}.</p>")
    return lines + flux_balance(case, frames, solve.get("flux_unit", ""))


def flux_balance(case, frames, unit):
    """First, middle and last frame, and those in which a balance is worst."""
    if not frames or frames[0].get("emitted_flux") is None:
        return []
    chosen = {0, (len(frames) - 1) // 2, len(frames) - 1}
    for key, sign, _ in flags.BALANCES:
        chosen.add(frames.index(worst(frames, key, abs if sign == 0 else lambda flux, s=sign: s * flux)))
    rows, target = [], case.target().value
    for frame in (frames[k] for k in sorted(chosen)):
        line = [cell(marked(frame.at("frame"), str(frame.get("frame"))))]
        for key in ("emitted_flux", "absorbed_flux", "lost_flux", "unsolved_flux", "negative_flux"):
            bad = any(key == k for k, _, _ in flags.BALANCES) and flags.violates(frame, key, target)
            line.append(cell(number(frame.at(key), unit), *(["bad"] if bad else [])))
        rows.append(line + [cell("yes" if frame.get("converged") else "no", *([] if frame.get("converged") else ["bad"]))])
    return ["<h3>Flux balance</h3>",
            table(["frame", "emitted", "absorbed", "lost", "not accounted for", "negative", "converged"], rows),
            "<p>First, middle and last frame, and the worst of each kind. Lost: leaves the scene or meets the back of a one-sided "
            f"face; below 0 it is made of nothing. Red: more than {percent_text(target)} of the flux emitted.</p>"]
