# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of kinelux report."""

import argparse
import pathlib
import sys

import charts
import document
import errors
import meters
import sections
from case import Case, CaseError

EXIT_USAGE, EXIT_FILE = 2, 3
STYLE = charts.STYLE + "summary { cursor: pointer; margin: 0.5rem 0; }\n"


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(EXIT_USAGE, f"kinelux-report: error: {message}; usage: kinelux-report CASE [options]\n")


def parser():
    result = Parser(prog="kinelux-report", allow_abbrev=False,
                    description="One page of a case that needs no other file: pictures, plan, error budget, error over "
                                "frames, time and memory, meters over time, warnings.")
    result.add_argument("case", metavar="CASE", type=pathlib.Path, help="folder of the case")
    result.add_argument("-o", "--output", type=pathlib.Path, metavar="FILE", help="the page [CASE/report.html]")
    result.add_argument("--no-pictures", action="store_true", help="do not draw the scene: ParaView is then not started")
    result.add_argument("-q", "--quiet", action="store_true", help="print warnings and errors only")
    return result


def page(case, with_pictures):
    body = (sections.head(case) + sections.warnings(case) + sections.pictures(case, with_pictures) + sections.plan(case)
            + errors.budget(case) + errors.over_frames(case) + sections.cost(case) + meters.section(case) + sections.foot(case))
    return document.document(f"{case.title()}: report", body, STYLE)


def main(arguments):
    options = parser().parse_args(arguments)
    output = options.output or options.case / "report.html"
    try:
        text = page(Case(options.case), not options.no_pictures)
        document.write(output, text)
    except CaseError as error:
        print(f"kinelux-report: error: {error}", file=sys.stderr)
        return EXIT_FILE
    except OSError as error:
        print(f"kinelux-report: error: {error.filename or output}: {error.strerror}", file=sys.stderr)
        return EXIT_FILE
    if not options.quiet:
        print(output)
    return 0
