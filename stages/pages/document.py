# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of HTML that need no other file, readable on narrow and wide screens: what study and report share."""

import base64
import html
import re

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 0 auto; padding: 1rem; color: #222;
  background: #fff; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; line-height: 1.25; } h2 { font-size: 1.15rem; margin-top: 2rem; } h3 { font-size: 1rem; }
img { max-width: 100%; height: auto; }
.table { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.9rem; white-space: nowrap; }
th, td { padding: 0.25rem 0.6rem; text-align: right; vertical-align: top; border-bottom: 1px solid #ddd; }
th { font-weight: 600; vertical-align: bottom; }
.text { text-align: left; white-space: normal; } .name { min-width: 7rem; } .wide { min-width: 10rem; }
.wider { min-width: 18rem; }
.bad { color: #b00020; font-weight: 600; }
.advice { border-left: 4px solid #4477aa; padding: 0.5rem 1rem; background: #f2f6fa; }
"""


def escape(text):
    return html.escape(str(text))


def table(columns, lines):
    """A table that scrolls in a box of its own. @param lines  of cells that cell() made"""
    head = "".join(column if column.startswith("<th") else f"<th scope=\"col\">{escape(column)}</th>" for column in columns)
    body = "\n".join("<tr>" + "".join(line) + "</tr>" for line in lines)
    return f"<div class=\"table\"><table><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table></div>"


def text_column(name):
    """The head of a column of words, which break into lines as they need."""
    return f"<th scope=\"col\" class=\"text\">{escape(name)}</th>"


def cell(markup, *classes):
    """@param markup  as HTML: words are escaped before"""
    mark = f" class=\"{' '.join(classes)}\"" if classes else ""
    return f"<td{mark}>{markup}</td>"


def image(png, words):
    """A picture inside the page. @param png  bytes"""
    data = base64.b64encode(png).decode("ascii")
    return f"<img alt=\"{escape(words)}\" src=\"data:image/png;base64,{data}\"/>"


def document(title, body, style=""):
    """@param body  lines of HTML  @return  the page"""
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
            "<link rel=\"icon\" href=\"data:,\"/>"
            f"<title>{escape(title)}</title><style>{STYLE}{style}</style></head>\n<body>\n"
            + "\n".join(body) + "\n</body></html>\n")


def write(file, text):
    """Written aside and renamed: never half a page."""
    aside = file.with_name(file.name + ".part")
    aside.write_text(text, encoding="utf-8", errors="replace")
    aside.replace(file)


def short(value, digits=3):
    """A number with at least so many digits that count; whole ones as they are."""
    if isinstance(value, int) or value == 0:
        return str(int(value))
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 <= abs(value) < 1e7:
        text = f"{value:.0f}"
    return text if "e" in text or abs(value) < 10 ** digits else f"{value:.0f}"


def unit_text(unit):
    """W/m2 as it is written by hand; nothing for a ratio."""
    return "" if unit == "1" else re.sub(r"\bm2\b", "m²", unit)


def with_unit(text, unit):
    unit = unit_text(unit)
    return f"{text}\u00a0{unit}" if unit else text
