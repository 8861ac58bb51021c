#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""kinelux report, end to end."""

import csv
import html
import html.parser
import json
import os
import re
import shutil
import subprocess
import unittest

import scenes
from programs import BIN, STAGES, StageTest

VOID = {"meta", "link", "img", "br"}
DESK = """
[[meter]]
name = "desk"
origin = [0.3, 0.3, 0.2]
edge_u = [1.4, 0, 0]
edge_v = [0, 1.4, 0]
count_u = 2
count_v = 2
"""


class Page(html.parser.HTMLParser):
    """What a page refers to, its numbers with their sources, its plots, its text, and whether its tags match."""

    def __init__(self, file):
        super().__init__()
        self.references, self.data, self.polylines, self.open, self.words = [], [], [], [], []
        self.headings, self.images, self.labels = [], [], []
        self.text = file.read_text(encoding="utf-8")
        self.feed(self.text)
        self.close()

    def take(self, tag, attributes):
        attributes = dict(attributes)
        self.references += [attributes[name] for name in ("src", "href", "xlink:href", "data") if name in attributes]
        if tag == "data":
            self.data.append([attributes, ""])
        if tag == "polyline":
            self.polylines.append([tuple(map(float, point.split(","))) for point in attributes["points"].split()])
        if tag == "img":
            self.images.append(attributes["alt"])
        if tag == "svg" and "aria-label" in attributes:
            self.labels.append(attributes["aria-label"])

    def handle_starttag(self, tag, attributes):
        self.take(tag, attributes)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.take(tag, attributes)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        self.words.append(data)
        if "data" in self.open:
            self.data[-1][1] += data
        if self.open and self.open[-1] in ("h2", "h3"):
            self.headings.append(data)

    def all_words(self):
        return " ".join(self.words)


def at(content, path):
    for word in path.split("/"):
        content = content[int(word)] if isinstance(content, list) else content[word]
    return content


class Report(StageTest):
    PARTS = ["Warnings", "Pictures", "Plan: which effects are computed", "Error budget", "Error estimate over frames",
             "Time and memory", "Meters"]

    def make_case(self, **room):
        scene = scenes.write_room(self.folder, **room)
        self.run_ok("kinelux", "run", scene, "-o", "room.case", "--quiet")
        return self.folder / "room.case"

    def report(self, case, *words):
        done = self.run_ok("kinelux", "report", case, *(words or ("--no-pictures",)))
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.stdout, f"{case}/report.html\n")
        return self.whole_page(self.folder / case / "report.html")

    def whole_page(self, file):
        page = Page(file)
        self.assertEqual(page.open, [])
        self.assertEqual([part for part in page.headings if part in self.PARTS], self.PARTS)
        return page

    def assert_numbers_are_those_of_the_files(self, page, case):
        """@return  the places that numbers were read from"""
        places = set()
        for attributes, shown in page.data:
            if "data-from" not in attributes:
                continue
            file, path = attributes["data-from"].split(":", 1)
            exact = at(json.loads((case / file).read_text(encoding="utf-8")), path)
            self.assertEqual(json.loads(attributes["value"]), exact, attributes)
            number, _, unit = shown.partition("\u00a0")
            scale = 100 if unit == "%" else 1
            self.assertLessEqual(abs(float(number) - scale * exact), 0.0051 * scale * abs(exact), (attributes, shown))
            places.add(attributes["data-from"])
        return places

    def test_page_has_all_parts_and_the_numbers_of_the_files(self):
        case = self.make_case(moving=True, more=DESK)
        self.run_ok("kinelux", "reference", case, "--points", "20", "--quiet", code=0)
        page = self.report("room.case")
        places = self.assert_numbers_are_those_of_the_files(page, case)
        self.assertLessEqual({"solve.json:figures/error_estimate", "scene.json:accuracy/target", "solve.json:tolerance",
                              "solve.json:figures/solver_error", "plan.json:unknowns", "solve.json:frames/0/absorbed_flux",
                              "fit.json:figures/deviation_m", "reference.json:relative_rms_difference",
                              "reference.json:reference_noise"} |
                             {f"{'plan-record' if stage == 'plan' else stage}.json:{key}" for stage in STAGES
                              for key in ("seconds", "peak_memory_mib")}, places)

        words = page.all_words()
        run = json.loads((case / "run.json").read_text(encoding="utf-8"))
        self.assertIn(f"{run['totals']['seconds']:.3g}\u00a0s", words)
        for effect in json.loads((case / "plan.json").read_text(encoding="utf-8"))["effects"]:
            self.assertIn(effect["name"], words)
            self.assertIn(effect["reason"], words)

        # Readings, with their errors beside them.
        with (case / "meters.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        readings = {(int(row["frame"]), float(row["value"])) for row in rows}
        shown = [(attributes, text) for attributes, text in page.data if "data-frame" in attributes]
        self.assertGreater(len(shown), 20)
        for attributes, text in shown:
            self.assertIn((int(attributes["data-frame"]), float(attributes["value"])), readings)
        first = next(row for row in rows if row["quantity"] == "irradiance" and row["meter"] == "room")
        text = next(text for attributes, text in shown if attributes["value"] == repr(float(first["value"])))
        value, error, unit = re.fullmatch(r"([\d.]+) ± ([\d.e-]+)\u00a0(\S+)", text).groups()
        self.assertLessEqual(abs(float(value) - float(first["value"])), 0.06 * float(error))
        self.assertLessEqual(abs(float(error) - float(first["error_estimate"])), 0.06 * float(first["error_estimate"]))
        self.assertEqual(unit, "W/m²")
        self.assertIn("mean irradiance [W/m²]", words)
        self.assertNotIn("desk[0,0]", words)

    def test_plots_have_a_point_for_each_frame_and_axes_with_units(self):
        case = self.make_case(moving=True)
        page = self.report("room.case")
        self.assertIn("Error estimate over frames", page.labels)
        self.assertIn("irradiance, red over time", page.labels)
        words = page.all_words()
        for label in ("error estimate of radiosity [%]", "irradiance, red [W/m²]", "time [s]", "Time per stage [s]",
                      "Peak memory [MiB]"):
            self.assertIn(label, words)
        self.assertEqual({len(line) for line in page.polylines}, {3})
        frames = json.loads((case / "solve.json").read_text(encoding="utf-8"))["frames"]
        # The first plot is that of the estimates: linear, from 0, and above is less on paper.
        heights = [y for _, y in page.polylines[0]]
        errors = [frame["error_estimate"] for frame in frames]
        slope = (heights[1] - heights[0]) / (errors[1] - errors[0])
        self.assertLess(slope, 0)
        self.assertAlmostEqual(heights[2], heights[0] + slope * (errors[2] - errors[0]), delta=1)

    def test_nothing_outside_the_page_is_referred_to(self):
        case = self.make_case()
        page = self.report("room.case")
        self.assertTrue(all(reference.startswith("data:") for reference in page.references), page.references)
        for outside in ("http", "url(", "@import", "<script", "srcset", "file:"):
            self.assertNotIn(outside, page.text)
        self.assertNotIn(str(case), page.text)
        # As long as nothing changes, the page is the same.
        self.assertEqual(page.text, self.report("room.case").text)

    def test_one_frame_has_readings_and_no_plots_over_time(self):
        self.make_case()
        page = self.report("room.case")
        self.assertEqual(page.polylines, [])
        self.assertIn("One frame:", page.all_words())
        self.assertIn("W/m²", page.all_words())

    def test_missing_parts_give_a_sentence(self):
        scene = scenes.write_room(self.folder)
        self.run_ok("kinelux-clean", scene, "-o", "room.case")
        sentences = {"fit": "There is no plan yet", "cluster": "There is no plan yet", "plan": "Not solved yet (kinelux-solve)",
                     "coefficients": "Not solved yet (kinelux-solve)", "solve": "nothing is exported yet"}
        page = self.report("room.case")
        self.assertIn("No record of: fit, cluster, plan, coefficients, solve, export.", page.all_words())
        for stage, words in sentences.items():
            self.run_ok("kinelux", stage, "room.case")
            page = self.report("room.case")
            self.assertIn(words, page.all_words(), stage)
        self.run_ok("kinelux", "export", "room.case")
        self.assertNotIn("yet", self.report("room.case").all_words())
        # Each record alone may be missing, and so may all.
        case = self.folder / "room.case"
        for stage in STAGES:
            file = case / ("plan-record.json" if stage == "plan" else f"{stage}.json")
            file.rename(self.folder / "aside")
            self.assertIn(f"No record of: {stage}.", self.report("room.case").all_words())
            (self.folder / "aside").rename(file)
        for file in [*case.glob("*.json"), *case.glob("*.h5"), case / "meters.csv", case / "view.pvd"]:
            if file.name != "scene.json":
                file.unlink()
        self.assertIn("No stage that has an error was run yet", self.report("room.case").all_words())

    def test_records_are_read_from_run_json_where_they_are_alone(self):
        case = self.make_case()
        for stage in STAGES:
            (case / ("plan-record.json" if stage == "plan" else f"{stage}.json")).unlink()
        page = self.report("room.case")
        self.assertIn("run.json:stages/solve/figures/error_estimate", self.assert_numbers_are_those_of_the_files(page, case))

    def test_warnings_of_the_stages_are_recorded_and_shown(self):
        case = self.make_case(target="0.1%")
        solve = json.loads((case / "solve.json").read_text(encoding="utf-8"))
        self.assertRegex(solve["warnings"][0], r"^the error estimate is .* 0\.1 % were asked for$")
        page = self.report("room.case")
        self.assertIn(solve["warnings"][0], page.all_words())
        self.assertIn("More than was asked for.", page.all_words())

        # Balances that do not hold; with warnings of its own, or by the numbers alone.
        solve["frames"][0].update(lost_flux=-0.5 * solve["frames"][0]["emitted_flux"])
        solve["warnings"].append("frame 0: 1.8 W of 3.6 W emitted are <made> of nothing")
        (case / "solve.json").write_text(json.dumps(solve), encoding="utf-8")
        page = self.report("room.case")
        self.assertIn("frame 0: 1.8 W of 3.6 W emitted are <made> of nothing", page.all_words())
        del solve["warnings"]
        (case / "solve.json").write_text(json.dumps(solve), encoding="utf-8")
        self.assertRegex(self.report("room.case").all_words(), r"frame 0: \S+\sW of \S+\sW emitted: made of nothing")

    def test_parts_that_are_out_of_date_or_interrupted_are_named(self):
        case = self.make_case()
        self.assertIn("None: no stage that was run flagged anything.", self.report("room.case").all_words())
        scene = self.folder / "room.toml"
        self.run_ok("kinelux-clean", scene, "-o", "room.case", "--accuracy", "20%")
        self.assertIn("out of date: scene.json has changed since; run kinelux-fit again", self.report("room.case").all_words())
        (case / "solution-so-far.h5").write_bytes(b"begun")
        self.assertIn("was interrupted: solution-so-far.h5", self.report("room.case").all_words())

    def test_folders_that_are_no_case_and_damaged_files(self):
        (self.folder / "empty").mkdir()
        (self.folder / "file").write_text("nothing", encoding="utf-8")
        self.assert_fails(3, r"empty: not a case: there is no scene\.json in it", "kinelux", "report", "empty")
        self.assert_fails(3, r"nowhere: there is no such case; run kinelux-clean", "kinelux", "report", "nowhere")
        self.assert_fails(3, r"file: is not a folder", "kinelux", "report", "file")
        self.assert_fails(2, r"CASE.*; usage: kinelux-report CASE \[options\]", "kinelux", "report")
        self.assert_fails(2, r"--fast", "kinelux", "report", "empty", "--fast")
        self.run_ok("kinelux-clean", scenes.write_room(self.folder), "-o", "room.case")
        case = self.folder / "room.case"
        self.assert_fails(3, r"nowhere", "kinelux", "report", "room.case", "--no-pictures", "-o", "nowhere/page.html")
        good = (case / "scene.json").read_text(encoding="utf-8")
        (case / "scene.json").write_text(good.replace('"version": 1', '"version": 9'), encoding="utf-8")
        self.assert_fails(3, r"scene\.json: format version 9 is newer", "kinelux", "report", "room.case")
        (case / "scene.json").write_text(good[:100], encoding="utf-8")
        self.assert_fails(3, r"scene\.json: cannot be read", "kinelux", "report", "room.case")
        (case / "scene.json").write_text(good, encoding="utf-8")
        (case / "meters.csv").write_text("frame,time_s\n0,0\n", encoding="utf-8")
        self.assert_fails(3, r"meters\.csv: cannot be read", "kinelux", "report", "room.case")
        self.assertFalse((case / "report.html").exists())

    def test_pictures_of_first_middle_and_last_frame_or_why_there_are_none(self):
        case = self.make_case(moving=True)
        broken = dict(os.environ, KINELUX_PVBATCH=str(self.folder / "no-pvbatch"))
        subprocess.run([BIN / "kinelux-report", case, "-q"], env=broken, check=True)
        self.assertRegex(self.whole_page(case / "report.html").all_words(), r"No pictures: .*(cannot be started|failed)")
        # A program that draws: view.py's command line, one white pixel.
        png = ("89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c4944415478da63f8ffff3f0005fe02fe"
               "a73581840000000049454e44ae426082")
        painter = self.folder / "painter"
        painter.write_text("#!/usr/bin/python3\nimport sys\n"
                           f"open(sys.argv[sys.argv.index('--png') + 1], 'wb').write(bytes.fromhex('{png}'))\n", encoding="utf-8")
        painter.chmod(0o755)
        drawn = dict(os.environ, KINELUX_PVBATCH=str(painter), DISPLAY=os.environ.get("DISPLAY", ":0"))
        subprocess.run([BIN / "kinelux-report", case, "-q"], env=drawn, check=True)
        page = self.whole_page(case / "report.html")
        self.assertEqual(page.images, [f"test room: frame {k}, {t} s" for k, t in enumerate(("0", "0.5", "1"))])
        self.assertTrue(all(reference.startswith("data:") for reference in page.references))


@unittest.skipUnless(shutil.which("chromium"), "there is no chromium: apt-get install chromium")
class ReportInBrowser(StageTest):
    # How wide a page is in a frame of its own: a window without a screen is never narrower than 500 pixels.
    MEASURE = """<script>addEventListener('load', () => parent.postMessage({
        content: document.documentElement.scrollWidth, window: innerWidth,
        wide: [...document.querySelectorAll('body *')].filter(e => !(e.closest('.table') && !e.matches('.table')) &&
            e.getBoundingClientRect().right > innerWidth + 0.5).map(e => e.tagName),
        words: Math.min(...[...document.querySelectorAll('figure svg text')].map(e => e.getBoundingClientRect().height))
        }, '*'));</script></head>"""
    FRAME = """<!DOCTYPE html><html><head><title>nothing</title><link rel="icon" href="data:,"><script>
        addEventListener('message', e => { document.title = JSON.stringify(e.data); });</script></head>
        <body><iframe src="copy.html" width="WIDTH" height="2000" style="border: 0"></iframe></body></html>"""

    def browse(self, file, width, *words):
        done = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                               f"--user-data-dir={self.folder / 'browser'}", f"--window-size={width},3000",
                               "--enable-logging=stderr", "--v=0", *words, file.as_uri()],
                              capture_output=True, text=True, errors="replace", check=False, timeout=200)
        self.assertNotIn("CONSOLE", done.stderr)
        return done

    def test_page_fits_narrow_and_wide_windows_without_complaints(self):
        scene = scenes.write_room(self.folder, moving=True, more=DESK)
        self.run_ok("kinelux", "run", scene, "-o", "room.case", "--quiet")
        self.run_ok("kinelux", "report", "room.case", "--no-pictures")
        page = self.folder / "room.case/report.html"
        text = page.read_text(encoding="utf-8").replace("<details>", "<details open=\"open\">")
        (self.folder / "copy.html").write_text(text.replace("</head>", self.MEASURE, 1), encoding="utf-8")
        for width in (400, 1600):
            picture = self.folder / f"{width}.png"
            done = self.browse(page, width, f"--screenshot={picture}")
            self.assertTrue(picture.exists(), done.stderr)
            frame = self.folder / "frame.html"
            frame.write_text(self.FRAME.replace("WIDTH", str(width)), encoding="utf-8")
            shown = self.browse(frame, width + 100, "--dump-dom").stdout
            found = re.search(r"<title>(\{.*?\})</title>", shown)
            self.assertTrue(found, shown)
            measured = json.loads(html.unescape(found.group(1)))
            self.assertEqual(measured["window"], width)
            self.assertEqual(measured["wide"], [])
            self.assertLessEqual(measured["content"], width)
            self.assertGreaterEqual(measured["words"], 11)  # height of the smallest words in plots [pixels]


if __name__ == "__main__":
    unittest.main()
