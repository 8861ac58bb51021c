# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in the page, each with its unit, and with its exact value and the place it was read from for scripts:
<data value="0.0291" data-from="solve.json:figures/error_estimate">2.91 %</data>."""

import json
import math

from document import escape, short, with_unit


def marked(part, shown):
    return f"<data value=\"{json.dumps(part.value)}\" data-from=\"{escape(part.place)}\">{shown}</data>"


def number(part, unit="1", digits=3):
    """@param part  of a record, or None  @return  HTML"""
    return "" if part is None else marked(part, with_unit(short(part.value, digits), unit))


def percent(part):
    return "" if part is None else marked(part, percent_text(part.value))


def percent_text(share):
    return f"{short(100 * share)}\u00a0%"


def with_error(value, error, unit):
    """A reading and what it may be off, to the digits that the error leaves; words, no HTML."""
    if not error > 0:
        return with_unit(short(value, 4), unit)
    decimals = min(max(1 - math.floor(math.log10(error)), 0), 12)
    if max(abs(value), error) < 1e-4:
        return with_unit(f"{value:.3g} ± {error:.2g}", unit)
    return with_unit(f"{value:.{decimals}f} ± {error:.{decimals}f}", unit)
