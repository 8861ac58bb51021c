# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots as SVG that stands in a page of HTML: it takes the width it is given."""

import math

from document import escape, short, unit_text

WIDTH, HEIGHT = 400, 250
LEFT, RIGHT, TOP, BOTTOM = 52, 10, 26, 42
COLOURS = ("#1f5fa8", "#c8371f", "#2a7f3f", "#8a5a00", "#7a3fa0", "#00808a", "#b0307a", "#555555")
DASHES = ("", "6 3", "2 3", "8 3 2 3")
LOGARITHMIC_FROM = 30    # ratio of the greatest to the least line from which decades are drawn

STYLE = """
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); gap: 1rem; }
.charts figure { margin: 0; max-width: 30rem; min-width: 0; }
svg { display: block; width: 100%; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: #222; }
.legend { display: flex; flex-wrap: wrap; gap: 0 1rem; list-style: none; padding: 0; margin: 0.5rem 0; font-size: 0.9rem; }
.legend svg { display: inline-block; width: 2rem; height: 0.7rem; vertical-align: middle; }
figcaption { font-size: 0.9rem; }
"""


def line_style(k):
    dash = DASHES[k // len(COLOURS) % len(DASHES)]
    return f"stroke=\"{COLOURS[k % len(COLOURS)]}\"" + (f" stroke-dasharray=\"{dash}\"" if dash else "")


def legend(names):
    """Of the lines in all plots that have them in this order."""
    return "<ul class=\"legend\">" + "".join(
        "<li><svg viewBox=\"0 0 32 10\" aria-hidden=\"true\"><line x1=\"1\" x2=\"31\" y1=\"5\" y2=\"5\" stroke-width=\"3\" "
        f"{line_style(k)}/></svg> {escape(name)}</li>" for k, name in enumerate(names)) + "</ul>"


def steps(low, high, most=5):
    """Round numbers from low to high, both within the first and the last."""
    span = high - low or abs(high) or 1.0
    size = 10.0 ** math.floor(math.log10(span / most))
    size *= next(f for f in (1, 2, 5, 10) if span / (f * size) <= most)
    return [k * size for k in range(math.floor(low / size + 1e-9), math.ceil(high / size - 1e-9) + 1)]


def decades(low, high):
    first, last = math.floor(math.log10(low) + 1e-9), math.ceil(math.log10(high) - 1e-9)
    return [10.0 ** k for k in range(first, max(last, first + 1) + 1)]


class Axis:
    """From numbers to places on the paper."""

    def __init__(self, ticks, begin, end, logarithmic=False):
        self.ticks, self.begin, self.end, self.logarithmic = ticks, begin, end, logarithmic
        self.low, self.high = self.scaled(ticks[0]), self.scaled(ticks[-1])

    def scaled(self, value):
        return math.log10(max(value, 1e-300)) if self.logarithmic else value

    def place(self, value):
        share = (self.scaled(value) - self.low) / (self.high - self.low)
        return self.begin + min(max(share, 0.0), 1.0) * (self.end - self.begin)

    def labels(self):
        """Ticks with their words, few enough to be read."""
        shown = self.ticks[::max(1, math.ceil(len(self.ticks) / 6))]
        return [(tick, short(tick)) for tick in shown]


def axes_of(lines, mark):
    xs = [x for line in lines for x, _, _ in line]
    tops = [max(y for _, y, _ in line) for line in lines]
    values = [y for line in lines for _, y, _ in line] + ([mark] if mark is not None else [])
    least, logarithmic = min(values), False
    if mark is None and least > 0 and max(tops) > LOGARITHMIC_FROM * min(tops):
        logarithmic = True
        ticks = decades(least, max(values))
    else:
        ticks = steps(min(least, 0.0), max(max(values), 0.0) or 1.0)
    x_low, x_high = min(xs), max(xs)
    x_ticks = [tick for tick in steps(x_low, x_high) if x_low <= tick <= x_high * (1 + 1e-9)]
    x = Axis([x_low, x_high], LEFT, WIDTH - RIGHT)
    x.ticks = x_ticks
    return x, Axis(ticks, HEIGHT - BOTTOM, TOP, logarithmic)


def lines(title, x_label, quantity, unit, series, mark=None, mark_words=""):
    """Lines over x, with bands as wide as their errors; from 0, or by decades where they are far apart.
    @param series  {name: [(x, y, error of y)]}, two points or more each
    @param mark  a level that is drawn across [unit], with mark_words"""
    x, y = axes_of(list(series.values()), mark)
    out = [f"<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{escape(title)}\">"]
    for tick, words in y.labels():
        at = y.place(tick)
        out.append(f"<line x1=\"{LEFT}\" x2=\"{WIDTH - RIGHT}\" y1=\"{at:.1f}\" y2=\"{at:.1f}\" stroke=\"#ddd\"/>"
                   f"<text x=\"{LEFT - 5}\" y=\"{at + 4:.1f}\" text-anchor=\"end\">{words}</text>")
    for tick, words in x.labels():
        at = x.place(tick)
        out.append(f"<line x1=\"{at:.1f}\" x2=\"{at:.1f}\" y1=\"{HEIGHT - BOTTOM}\" y2=\"{HEIGHT - BOTTOM + 4}\" "
                   f"stroke=\"#222\"/><text x=\"{at:.1f}\" y=\"{HEIGHT - BOTTOM + 17}\" text-anchor=\"middle\">{words}</text>")
    out.append(f"<path d=\"M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}\" fill=\"none\" stroke=\"#222\"/>")
    unit = f" [{unit_text(unit)}]" if unit_text(unit) else ""
    out.append(f"<text x=\"4\" y=\"14\">{escape(quantity)}{unit}</text>"
               f"<text x=\"{(LEFT + WIDTH - RIGHT) / 2}\" y=\"{HEIGHT - 6}\" text-anchor=\"middle\">{escape(x_label)}</text>")
    for k, points in enumerate(series.values()):
        if any(error > 0 for _, _, error in points):
            edge = [(a, b + e) for a, b, e in points] + [(a, b - e) for a, b, e in reversed(points)]
            out.append(f"<polygon points=\"{path(edge, x, y)}\" fill=\"{COLOURS[k % len(COLOURS)]}\" fill-opacity=\"0.18\"/>")
        out.append(f"<polyline points=\"{path([(a, b) for a, b, _ in points], x, y)}\" fill=\"none\" stroke-width=\"1.8\" "
                   f"{line_style(k)}/>")
    if mark is not None:
        at = y.place(mark)
        out.append(f"<line class=\"mark\" x1=\"{LEFT}\" x2=\"{WIDTH - RIGHT}\" y1=\"{at:.1f}\" y2=\"{at:.1f}\" stroke=\"#b00020\" "
                   f"stroke-dasharray=\"5 3\"/><text x=\"{WIDTH - RIGHT}\" y=\"{at - 4:.1f}\" text-anchor=\"end\">"
                   f"{escape(mark_words)}</text>")
    return "".join(out) + "</svg>"


def path(points, x, y):
    return " ".join(f"{x.place(a):.1f},{y.place(b):.1f}" for a, b in points)


def bars(title, unit, values):
    """@param values  {name: number}, 0 or above"""
    row, left, right = 22, 96, 74
    height = row * len(values) + 24
    most = max(values.values()) or 1.0
    out = [f"<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{escape(title)}\">",
           f"<text x=\"4\" y=\"14\">{escape(title)} [{unit_text(unit)}]</text>"]
    for k, (name, value) in enumerate(values.items()):
        top = 24 + k * row
        width = (WIDTH - left - right) * value / most
        out.append(f"<text x=\"{left - 6}\" y=\"{top + 14}\" text-anchor=\"end\">{escape(name)}</text>"
                   f"<rect x=\"{left}\" y=\"{top + 3}\" width=\"{max(width, 0.5):.1f}\" height=\"{row - 7}\" fill=\"{COLOURS[0]}\"/>"
                   f"<text x=\"{left + width + 5:.1f}\" y=\"{top + 14}\">{short(value)} {unit_text(unit)}</text>")
    return "".join(out) + "</svg>"
