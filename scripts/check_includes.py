#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks every #include of pipeline/, stages/ and tests/ against scripts/allowed_includes.toml.

    scripts/check_includes.py               prints each forbidden include as file:line: reason; exit code 1 if any
    scripts/check_includes.py --self-test   shows on a made-up tree that forbidden includes are caught
"""

import fnmatch
import pathlib
import re
import sys
import tempfile
import tomllib

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
TABLE = pathlib.Path(__file__).with_name("allowed_includes.toml")
C_HEADERS = {"errno.h", "float.h", "limits.h", "math.h", "signal.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h",
             "string.h", "time.h"}


def check_table(table):
    """Faults of the table itself: unknown modules and circles."""
    modules = table["modules"]
    for module, targets in modules.items():
        for target in targets:
            if target not in modules:
                yield f"allowed_includes.toml: {module} may include {target}, which is no module"
    finished = {}

    def closes_circle(module):
        if module in finished:
            return finished[module] == "open"
        finished[module] = "open"
        found = any(closes_circle(target) for target in modules.get(module, []))
        finished[module] = "done"
        return found

    for module in modules:
        if closes_circle(module):
            yield f"allowed_includes.toml: modules include each other in a circle through {module}"
            return
    for library, entry in table["libraries"].items():
        for module in entry["modules"]:
            if module != "*" and module not in modules:
                yield f"allowed_includes.toml: {library} lists {module}, which is no module"


def library_of(name, table):
    for library, entry in table["libraries"].items():
        if any(fnmatch.fnmatchcase(name, pattern) for pattern in entry["includes"]):
            return library
    return None


def is_standard(name):
    return ("/" not in name and "." not in name) or name in C_HEADERS


def reason_against(quoted, angled, module, is_header, table):
    """Why a file of `module` (None: a free folder) may not have this include; None if it may."""
    modules = table["modules"]
    name = quoted or angled
    if quoted:
        target = quoted.split("/")[0]
        if "/" in quoted and target in modules:
            if module is not None and target != module and target not in modules[module]:
                return f"{module} may not include {target}"
            return None
        if module is not None and library_of(name, table) is None:
            return f'"{quoted}" is not written as "module/header.h" relative to pipeline/'
        if module is None:
            return None
    library = library_of(name, table)
    if library is None:
        return None if is_standard(name) or module is None else f"<{name}> belongs to no library of the table"
    if module is None:
        return None
    entry = table["libraries"][library]
    if "*" not in entry["modules"] and module not in entry["modules"]:
        homes = ", ".join(entry["modules"]) or "tests"
        return f"{library} may not be used in {module}, its home is {homes}"
    if is_header and not entry.get("headers", False):
        return f"{library} may not show in a header"
    return None


def check_tree(root, table):
    """All faults under root, as text, and the number of files read."""
    faults = []
    files = 0
    for folder in ["pipeline", *table["free"]["folders"]]:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".hpp", ".cpp"):
                continue
            files += 1
            place = path.relative_to(root)
            module = place.parts[1] if folder == "pipeline" else None
            if module is not None and module not in table["modules"]:
                faults.append(f"{place}: {module} is no module of allowed_includes.toml")
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                reason = reason_against(match[1], match[2], module, path.suffix != ".cpp", table)
                if reason:
                    faults.append(f"{place}:{number}: {reason}")
    return faults, files


def self_test(table):
    """Each case: file, include line, what the fault must say (None: allowed)."""
    cases = [
        ("pipeline/solve/a.cpp", '#include "model/solution.h"', None),
        ("pipeline/solve/b.cpp", '#include "solve/a.h"', None),
        ("pipeline/solve/c.cpp", '#include "kernel/transport.h"', "solve may not include kernel"),
        ("pipeline/core/d.h", '#include "model/mesh.h"', "core may not include model"),
        ("pipeline/model/e.h", "#  include \"io/mesh.h\"", "model may not include io"),
        ("pipeline/clean/f.cpp", "#include <CGAL/Surface_mesh.h>", None),
        ("pipeline/clean/g.h", "#include <CGAL/Surface_mesh.h>", "cgal may not show in a header"),
        ("pipeline/kernel/h.cpp", "#include <embree3/rtcore.h>", "its home is visibility"),
        ("pipeline/solve/i.cpp", "#include <vtkPolyData.h>", "its home is io"),
        ("pipeline/io/j.cpp", '#include "mesh.h"', "relative to pipeline/"),
        ("pipeline/io/k.cpp", "#include <curl/curl.h>", "belongs to no library"),
        ("pipeline/kernel/l.cpp", "#include <vector>", None),
        ("pipeline/kernel/m.cpp", "#include <gtest/gtest.h>", "its home is tests"),
        ("pipeline/other/n.cpp", "#include <vector>", "is no module"),
        ("tests/kernel/o.cpp", "#include <gtest/gtest.h>", None),
        ("stages/p.cpp", '#include "kernel/transport.h"', None),
    ]
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, line, _ in cases:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(line + "\n", encoding="utf-8")
        faults, _ = check_tree(root, table)
    wrong = []
    for name, line, expected in cases:
        found = [fault for fault in faults if fault.startswith(name)]
        good = not found if expected is None else len(found) == 1 and expected in found[0]
        print(f"{'ok    ' if good else 'WRONG '} {name}: {line}  ->  {found[0] if found else 'allowed'}")
        if not good:
            wrong.append(name)
    circle = {**table, "modules": {**table["modules"], "core": ["solve"]}}
    if not any("circle" in fault for fault in check_table(circle)):
        wrong.append("a circle in the table was not noticed")
        print("WRONG  core -> solve -> ... -> core was accepted")
    return wrong


def main(arguments):
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    faults = list(check_table(table))
    if arguments == ["--self-test"]:
        faults += self_test(table)
        return 1 if faults else 0
    if arguments:
        sys.exit(__doc__)
    found, files = check_tree(TABLE.parent.parent, table)
    faults += found
    for fault in faults:
        print(fault)
    if files == 0:
        sys.exit("no source file found: is this the right folder?")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
