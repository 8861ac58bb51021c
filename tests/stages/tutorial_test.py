#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/tutorial.md, word for word."""

import csv
import os
import re
import subprocess
import unittest

from programs import BIN, ROOT, StageTest


class Tutorial(StageTest):

    def test_every_command_works_and_the_figures_are_those_of_the_text(self):
        text = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
        for name, content in re.findall(r"^`([\w.]+)`:\n\n```\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
            (self.folder / name).write_text(content, encoding="utf-8")
        blocks = re.findall(r"^```sh\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
        self.assertGreaterEqual(len(blocks), 7)
        environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
        printed = []
        for block in blocks:
            done = subprocess.run(["sh", "-e", "-c", block], cwd=self.folder, env=environment, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=500)
            self.assertEqual(done.returncode, 0, block + done.stdout)
            printed.append(done.stdout)
        printed = "\n".join(printed)
        self.assertTrue((self.folder / "room.case/view.py").exists())

        with (self.folder / "room.case/meters.csv").open(encoding="utf-8", newline="") as file:
            means = [float(row["value"]) for row in csv.DictReader(file)
                     if row["meter"] == "desk" and row["quantity"] == "mean irradiance"]
        least, greatest = map(float, re.search(r"rises from (\d+) lx to (\d+) lx", text).groups())
        self.assertEqual(len(means), 9)
        self.assertAlmostEqual(means[0], least, delta=0.02 * least)
        self.assertAlmostEqual(means[4], greatest, delta=0.02 * greatest)
        off = [float(value) for value in re.findall(r"differs from the path-traced reference by ([\d.]+) %", printed)]
        self.assertEqual(len(off), 2)
        self.assertLess(off[0], 3.0)
        self.assertLess(off[1], 1.5)


if __name__ == "__main__":
    unittest.main()
