#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""kinelux study, end to end."""

import csv
import html.parser
import json
import unittest

import scenes
from programs import StageTest


class Page(html.parser.HTMLParser):
    """Collects what a page refers to, its table cells, and whether its tags match."""

    def __init__(self):
        super().__init__()
        self.references, self.cells, self.open = [], 0, []

    def handle_starttag(self, tag, attributes):
        self.references += [value for name, value in attributes if name in ("src", "href")]
        self.cells += tag == "td"
        self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.references += [value for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag


class Study(StageTest):
    def setUp(self):
        super().setUp()
        text = scenes.write_room(self.folder, moving=True, target="10%").read_text(encoding="utf-8")
        self.scene = self.folder / "free.toml"
        self.scene.write_text(text.replace("element_size = 0.5\n", ""), encoding="utf-8")
        self.words = ("kinelux", "study", self.scene, "-o", "out", "--accuracies", "20,10,5", "--points", "60",
                      "--reference-time", "3")

    def study(self):
        return json.loads((self.folder / "out/study.json").read_text(encoding="utf-8"))

    def test_rows_have_costs_and_measured_errors_and_are_kept(self):
        done = self.run_ok(*self.words)
        self.assertRegex(done.stdout, r"Take --accuracy \d+%")
        study = self.study()
        self.assertEqual([row["accuracy"] for row in study["rows"]], [0.2, 0.1, 0.05])
        self.assertEqual(study["reference"]["frames"], [0, 1, 2])
        unknowns = [row["unknowns"] for row in study["rows"]]
        self.assertLess(unknowns[0], unknowns[-1])
        for row in study["rows"]:
            self.assertGreater(row["seconds"], 0)
            self.assertGreater(row["estimated_error"], 0)
            self.assertLess(row["measured_error"], row["accuracy"] + row["reference_noise"], row["accuracy"])
            self.assertEqual(set(row["stages"]), {"clean", "fit", "cluster", "plan", "coefficients", "solve", "export"})
        self.assertLess(study["rows"][1]["to_next_finer"], 0.2)
        with (self.folder / "out/study.csv").open(encoding="utf-8", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual(len(table), 3)
        self.assertEqual(float(table[1]["coefficients_s"]), study["rows"][1]["stages"]["coefficients"]["seconds"])

        page = Page()
        page.feed((self.folder / "out/study.html").read_text(encoding="utf-8"))
        self.assertEqual(page.open, [])
        self.assertEqual(page.cells % 3, 0)
        self.assertGreaterEqual(page.cells, 27)
        self.assertTrue(all(reference.startswith("data:") for reference in page.references))

        # Again: nothing is run or traced anew, so that all times and errors are those found before.
        self.run_ok(*self.words)
        self.assertEqual(self.study()["rows"], study["rows"])

    def test_time_limit_leaves_rows_out_and_says_so(self):
        words = [str(word).replace("20,10,5", "20,0.01") for word in self.words]
        done = self.run_ok(*words, "--time-limit", "8", code=5)
        self.assertRegex(done.stderr, r"0\.01%: (left out, would take about|stopped at the time limit)")
        self.assertEqual([row["accuracy"] for row in self.study()["rows"]], [0.2])
        self.assertEqual(len(self.study()["left_out"]), 1)
        self.assertIn("Left out for the time limit", (self.folder / "out/study.html").read_text(encoding="utf-8"))

    def test_words_that_make_no_sense(self):
        self.assert_fails(3, r"nowhere\.toml: there is no such file", "kinelux", "study", "nowhere.toml")
        for words, pattern in ((("--accuracies", "few"), r"expected percents"), (("--engines", "fast"), r"'fast': expected"),
                               (("--time-limit", "0"), r"expected a number above 0")):
            done = self.run_ok("kinelux", "study", self.scene, *words, code=2)
            self.assertRegex(done.stderr, pattern)


if __name__ == "__main__":
    unittest.main()
