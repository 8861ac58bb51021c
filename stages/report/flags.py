# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not as it should be: what the stages warned of, and what the files of the case show besides."""

from datum import percent_text
from document import short, with_unit

# What a frame's balance has to obey: key of solve.json, sign that is wrong, and what it means.
BALANCES = (("unsolved_flux", 0, "not accounted for"), ("lost_flux", -1, "made of nothing"),
            ("negative_flux", 1, "of negative radiosity"))
MOST_ABOVE_1 = 0.05  # row sums of form factors that exceed 1 by less are left to the error budget


def all_of(case):
    """@return  [(stage, words)], in the order of the stages"""
    found = []
    for stage, record in case.records.items():
        if record is None:
            continue
        found += [(stage, words) for words in record.get("warnings", [])]
        if record.get("warnings") is None:
            found += [(stage, words) for words in from_figures(case, stage, record)]
        found += [(stage, words) for words in always(stage, record)]
    for stage, name in case.stale() or []:
        found.append((stage, f"out of date: {name} has changed since; run kinelux-{stage} again"))
    for name, stage in case.interrupted():
        found.append((stage, f"was interrupted: {name} holds what was done; the same command goes on there"))
    return found


def from_figures(case, stage, record):
    """Of a record that lists no warnings, those that its numbers call for."""
    target = case.target().value
    if stage == "solve":
        if record.get("figures/error_estimate", 0.0) > target:
            yield (f"the error estimate is {percent_text(record.get('figures/error_estimate'))}, {percent_text(target)} were "
                   "asked for")
        if record.get("counts/frames_not_converged", 0) > 0:
            yield f"{record.get('counts/frames_not_converged')} of {record.get('counts/frames')} frames did not converge"
        unit = record.get("flux_unit", "")
        for frame in record.list("frames"):
            for key, _, meaning in BALANCES:
                if violates(frame, key, target):
                    flux, emitted = frame.get(key), frame.get("emitted_flux")
                    yield (f"frame {frame.get('frame')}: {with_unit(short(abs(flux)), unit)} of "
                           f"{with_unit(short(emitted), unit)} emitted: {meaning}")
    if stage == "reference":
        squared = record.get("relative_rms_difference", 0.0) ** 2 - record.get("reference_noise", 0.0) ** 2
        if squared > record.get("accuracy_target", target) ** 2:
            yield f"{percent_text(record.get('accuracy_target', target))} were asked for"
        if record.get("points_without_exported_value", 0) > 0:
            yield f"{record.get('points_without_exported_value')} sensor points lie on nothing that was exported"


def always(stage, record):
    """What the stages report as counts and figures, not as warnings."""
    if stage == "clean":
        for entry in record.list("objects"):
            crossing = entry.get("crossing_faces", 0)
            if crossing:
                yield f"{entry.get('object')}: {crossing} faces cross each other; they are left as they are"
    if stage == "fit":
        count = record.get("counts/overlapping_charts", 0)
        if count:
            yield f"{count} charts overlap themselves and were taken as they are, without contact cuts"
    if stage == "coefficients":
        excess = record.get("figures/exceed_1_by_up_to", 0.0)
        if excess > MOST_ABOVE_1:
            yield f"rows of form factors exceed 1 by up to {percent_text(excess)}"
    code = record.get("exit_code", 0)
    if code:
        yield f"ended with exit code {code}" + (": short of the accuracy asked for, the result is marked" if code == 5 else "")


def violates(frame, key, target):
    """Whether a flux of a frame's balance is more than the accuracy allows."""
    sign = next(s for k, s, _ in BALANCES if k == key)
    flux = frame.get(key, 0.0)
    return (abs(flux) if sign == 0 else sign * flux) > target * frame.get("emitted_flux", 0.0)


def mesh_notes(case):
    record = case.records["clean"]
    return [(entry.get("object"), note) for entry in (record.list("objects") if record else [])
            for note in entry.get("notes", [])]
