# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the page with the readings of meters: plots over time, and numbers with their errors."""

import re

import charts
from datum import with_error
from document import cell, escape, table, text_column, unit_text

MOST_LINES = 12          # more than that cannot be told apart
FIRST_SHOWN = ("irradiance", "mean irradiance")


def section(case):
    lines = ["<h2>Meters</h2>"]
    if case.meters is None:
        return lines + ["<p>No readings: nothing is exported yet (kinelux-export).</p>"]
    if not case.meters:
        return lines + ["<p>meters.csv holds no readings.</p>"]
    points = 0
    for (quantity, unit), meters in sorted(case.meters.items(), key=lambda entry: entry[0][0] not in FIRST_SHOWN):
        whole = {name: readings for name, readings in meters.items() if not of_a_point(case, name)}
        points += len(meters) - len(whole)
        shown = {name: readings for name, readings in whole.items()
                 if any(value for channel in readings.values() for _, _, value, _ in channel)}
        if not shown:
            continue
        title = escape(quantity) + (f" [{unit_text(unit)}]" if unit_text(unit) else "")
        inside = plots(quantity, unit, shown) + numbers(unit, shown)
        dark = len(whole) - len(shown)
        if dark:
            inside.append(f"<p>{dark} {'meter reads' if dark == 1 else 'meters read'} 0 in all frames.</p>")
        if quantity in FIRST_SHOWN:
            lines += [f"<h3>{title}</h3>", *inside]
        else:
            lines += [f"<details><summary>{title}</summary>", *inside, "</details>"]
    if points:
        lines.append(f"<p>The single points of grids ({points}) are in meters.csv.</p>")
    return lines


def of_a_point(case, name):
    """Whether this is one point of a grid of sensors, as desk[0,2]."""
    found = re.fullmatch(r"(.*)\[\d+,\d+\]", name, re.DOTALL)
    return bool(found) and any(grid.get("name") == found.group(1) for grid in case.scene.list("meters"))


def plots(quantity, unit, meters):
    """One per channel, a line for each meter, brightest meters first when there are too many."""
    channels = list(dict.fromkeys(channel for readings in meters.values() for channel in readings))
    if max(len(readings[channel]) for readings in meters.values() for channel in readings) < 2:
        return []
    brightest = {name: max(value for channel in readings.values() for _, _, value, _ in channel)
                 for name, readings in meters.items()}
    most = set(sorted(meters, key=brightest.get, reverse=True)[:MOST_LINES])
    chosen = [name for name in meters if name in most]
    lines = [charts.legend(chosen), "<div class=\"charts\">"]
    for channel in channels:
        series = {name: [(time, value, error) for time, _, value, error in meters[name][channel]]
                  for name in chosen if len(meters[name].get(channel, [])) > 1}
        words = f"{quantity}, {channel}" if len(channels) > 1 else quantity
        if series:
            lines.append(f"<figure>{charts.lines(f'{words} over time', 'time [s]', words, unit, series)}</figure>")
    lines.append("</div>")
    if len(meters) > len(chosen):
        lines.append(f"<p>The plots show the {len(chosen)} meters with the largest readings of {len(meters)}.</p>")
    return lines


def numbers(unit, meters):
    """The least and the greatest reading of each meter and channel over time, with their errors."""
    several = any(len(channel) > 1 for readings in meters.values() for channel in readings.values())
    rows = []
    for name, readings in meters.items():
        for channel, values in readings.items():
            line = [cell(escape(name), "text"), cell(escape(channel), "text"), reading(values[0], unit)]
            if several:
                line += [reading(min(values, key=lambda v: v[2]), unit), reading(max(values, key=lambda v: v[2]), unit)]
            rows.append(line)
    columns = ["first frame", "least", "greatest"] if several else ["reading"]
    content = table([text_column("meter"), text_column("channel"), *columns], rows)
    return ["<details><summary>In numbers</summary>", content, "</details>"] if several else [content]


def reading(value, unit):
    _, frame, light, error = value
    return cell(f"<data value=\"{light!r}\" data-frame=\"{frame}\">{escape(with_error(light, error, unit))}</data>")
