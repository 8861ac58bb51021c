#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The executables as a user runs them."""

import csv
import json
import math
import pathlib
import re
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy

import scenes
from programs import BIN, PROGRAMS, ROOT, STAGES, StageTest, hashes


class CommandLine(StageTest):
    def test_help_and_version_of_every_program(self):
        for program in PROGRAMS:
            self.assertRegex(self.run_ok(program, "--version").stdout, rf"^{program} \d+\.\d+\.\d+\n$")
            shown = self.run_ok(program, "--help").stdout
            self.assertTrue(shown.startswith(program), shown)
            self.assertEqual(shown, self.run_ok(program, "-h").stdout)
        for command in ["run", "form-factors", "info"] + STAGES + ["reference"]:
            self.assertIn("--threads", self.run_ok("kinelux", command, "--help").stdout)

    def test_help_states_defaults_and_units(self):
        shown = self.run_ok("kinelux-fit", "--help").stdout
        self.assertRegex(shown, r"--normal-tolerance deg .*\[0\.\.45 deg\] \(default: 5\)")

    def test_documentation_has_the_tables_of_the_programs(self):
        page = (ROOT / "docs/command-line.md").read_text(encoding="utf-8")
        commands = [[f"kinelux-{stage}"] for stage in STAGES + ["reference"]]
        for command in commands + [["kinelux", "run"], ["kinelux", "form-factors"], ["kinelux", "info"]]:
            table = self.run_ok(*command, "--help-markdown").stdout
            self.assertIn(table, page, f"docs/command-line.md: the table of {' '.join(command)} is not this:\n{table}")

    def test_wrong_command_lines_exit_with_2(self):
        self.assert_fails(2, r"unknown option --acuracy; did you mean --accuracy", "kinelux", "run", "x.toml",
                          "--acuracy=1%")
        self.assert_fails(2, r"CASE is missing; usage: kinelux-fit CASE", "kinelux-fit")
        self.assert_fails(2, r"one argument too many: 'b'", "kinelux-fit", "a", "b")
        self.assert_fails(2, r"--accuracy: 2 is outside", "kinelux-clean", "x.toml", "--accuracy", "200%")
        self.assert_fails(2, r"--accuracy: 'good' is not a number", "kinelux-clean", "x.toml", "--accuracy", "good")
        self.assert_fails(2, r"--frames: '3,1' ends before it starts", "kinelux-solve", "c", "--frames", "3,1")
        self.assert_fails(2, r"--method: 'guess' is none of", "kinelux-solve", "c", "--method", "guess")
        self.assert_fails(2, r"no command 'rum'; did you mean run", "kinelux", "rum")
        self.assert_fails(2, r"exclude each other", "kinelux-fit", "c", "-q", "-v")


class OneByOneEqualsRun(StageTest):
    def test_stages_one_by_one_give_the_bytes_of_run_and_a_second_run_does_nothing(self):
        scene = scenes.write_room(self.folder)
        self.run_ok("kinelux", "run", scene, "-o", "whole")
        self.run_ok("kinelux-clean", scene, "-o", "single")
        for stage in STAGES[1:]:
            self.run_ok("kinelux", stage, "single")
        whole, single = self.folder / "whole", self.folder / "single"
        self.assert_same_results(whole, single)

        before = hashes(whole)
        again = self.run_ok("kinelux", "run", scene, "-o", "whole")
        nothing_done = [f"kinelux-{stage}: up to date" for stage in STAGES]
        self.assertEqual(self.stage_lines(again), nothing_done)
        self.assertEqual(hashes(whole), before)

        # What is stale is found by content: a touched file is not, an option of one stage is from there on.
        scene.touch()
        self.assertEqual(self.stage_lines(self.run_ok("kinelux", "run", scene, "-o", "whole")), nothing_done)
        changed = self.run_ok("kinelux", "run", scene, "-o", "whole", "--seed", "2").stderr
        self.assertEqual([f"kinelux-{stage}: up to date\n" in changed for stage in STAGES], [True] * 4 + [False] * 3)
        self.assertNotIn("up to date", self.run_ok("kinelux", "run", scene, "-o", "whole", "--force").stderr)
        self.assert_same_results(whole, single)

        # A damaged or missing result is made again, and nothing else.
        (whole / "clusters.h5").write_bytes((whole / "clusters.h5").read_bytes()[:1000])
        (whole / "meters.csv").unlink()
        self.assertIn("kinelux-fit: up to date", self.run_ok("kinelux", "run", scene, "-o", "whole").stderr)
        self.assert_same_results(whole, single)

    def test_records_name_version_options_inputs_steps_and_totals(self):
        scene = scenes.write_room(self.folder)
        self.run_ok("kinelux", "run", scene, "--accuracy", "8%", "--log-file", "log.txt", "--quiet")
        case = self.folder / "room.case"
        record = json.loads((case / "run.json").read_text(encoding="utf-8"))
        self.assertEqual(list(record["stages"]), STAGES)
        self.assertGreater(record["totals"]["seconds"], 0)
        for stage in STAGES:
            part = record["stages"][stage]
            for key in ("program", "version", "options", "steps", "seconds", "peak_memory_mib", "key"):
                self.assertIn(key, part, stage)
            self.assertTrue(part["inputs"][0]["hash"], stage)
        self.assertEqual(record["stages"]["clean"]["options"]["accuracy"], 0.08)
        self.assertEqual(json.loads((case / "scene.json").read_text(encoding="utf-8"))["accuracy"]["target"], 0.08)
        self.assertIn("kinelux-solve: ", (self.folder / "log.txt").read_text(encoding="utf-8"))
        closure = record["stages"]["coefficients"]["closure"]
        for row in closure["rows"]:
            self.assertAlmostEqual(row["sum"], 1.0, delta=0.03, msg=row["object"])
        self.assertAlmostEqual(closure["smallest_element_row"], 1.0, delta=0.05)
        self.assertAlmostEqual(closure["largest_element_row"], 1.0, delta=0.05)
        self.assertIn("form factor rows miss up to", (self.folder / "log.txt").read_text(encoding="utf-8"))

    def test_dry_run_prints_the_plan_and_solves_nothing(self):
        scene = scenes.write_room(self.folder)
        done = self.run_ok("kinelux", "run", scene, "--dry-run")
        self.assertIn("interreflection", done.stdout)
        self.assertTrue((self.folder / "room.case/plan.json").exists())
        self.assertFalse((self.folder / "room.case/coefficients.h5").exists())


class Repeatability(StageTest):
    def test_one_and_two_threads_give_the_same_bytes(self):
        scene = scenes.write_room(self.folder, moving=True)
        for threads in (1, 2):
            self.run_ok("kinelux", "run", scene, "-o", f"t{threads}", "-j", threads)
        self.assert_same_results(self.folder / "t1", self.folder / "t2")
        for frame in sorted((self.folder / "t1/frames").iterdir()):
            self.assertEqual(frame.read_bytes(), (self.folder / "t2/frames" / frame.name).read_bytes(), frame.name)


class BadInput(StageTest):
    def setUp(self):
        super().setUp()
        self.scene = scenes.write_room(self.folder)
        self.run_ok("kinelux", "run", self.scene, "-o", "case")
        self.case = self.folder / "case"
        self.before = hashes(self.case)

    def assert_run_fails(self, code, pattern, *arguments):
        self.assert_fails(code, pattern, "kinelux", "run", *arguments, "-o", "case")
        self.assertEqual(hashes(self.case), self.before, "an earlier result has changed")
        self.assert_fails(code, pattern, "kinelux", "run", *arguments, "-o", "fresh")
        self.assertFalse((self.folder / "fresh").exists(), "a failing run has left a case")

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return self.folder / name

    def test_missing_files(self):
        self.assert_run_fails(3, r"nowhere\.toml", "nowhere.toml")
        text = self.scene.read_text(encoding="utf-8").replace("room.obj", "absent.obj")
        self.assert_run_fails(3, r"absent\.obj", self.write("absent.toml", text))

    def test_unknown_key_names_line_and_nearest_key(self):
        text = self.scene.read_text(encoding="utf-8").replace("reflectance = 0.0", "reflectence = 0.0")
        self.assert_run_fails(2, r"unknown\.toml:\d+: .*reflectence.*reflectance", self.write("unknown.toml", text))

    def test_mesh_without_faces(self):
        self.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")
        self.assert_run_fails(4, r"points\.obj", "points.obj")

    def test_vertex_that_is_not_a_number(self):
        lines = (self.folder / "room.obj").read_text(encoding="utf-8").replace("v 2 2 2", "v nan 2 2")
        self.write("broken.obj", lines)
        text = self.scene.read_text(encoding="utf-8").replace("room.obj", "broken.obj")
        self.assert_run_fails(4, r"broken\.obj", self.write("broken.toml", text))

    def test_motion_that_names_no_object(self):
        text = self.scene.read_text(encoding="utf-8") + scenes.MOTION
        self.assert_run_fails(2, r"idle\.toml:\d+: .*glide", self.write("idle.toml", text))
        text = self.scene.read_text(encoding="utf-8").replace('name = "block"', 'name = "block"\nmotion = "nothing"')
        self.assert_run_fails(2, r"lost\.toml:\d+: .*nothing", self.write("lost.toml", text))

    def test_unknown_option(self):
        self.assert_run_fails(2, r"unknown option --fast", self.scene, "--fast")

    def test_truncated_and_foreign_patches(self):
        patches = self.case / "patches.h5"
        whole = patches.read_bytes()
        for length in (0, 100, len(whole) // 2, len(whole) - 1):
            patches.write_bytes(whole[:length])
            self.assert_fails(3, r"patches\.h5.*kinelux-fit case again", "kinelux-cluster", "case")
        patches.unlink()
        self.assert_fails(3, r"patches\.h5: missing; run kinelux-fit", "kinelux-cluster", "case")
        scenes.write_room(self.folder, target="20%")
        self.run_ok("kinelux", "run", self.scene, "-o", "other")
        patches.write_bytes((self.folder / "other/patches.h5").read_bytes())
        self.assert_fails(3, r"patches\.h5: .*made from another scene\.json", "kinelux-cluster", "case")
        patches.write_bytes(whole)
        self.assertEqual(hashes(self.case), self.before)

    def test_memory_beyond_the_limit_is_refused_before_work(self):
        self.assert_fails(6, r"MiB.*--memory-limit", "kinelux-coefficients", "case", "--resume", "no", "--memory-limit", "0.01")
        self.assertEqual(hashes(self.case), self.before)

    def test_not_converged_is_written_marked_and_stays_5(self):
        self.run_ok("kinelux-solve", "case", "--max-sweeps", "1", "--tolerance", "1e-9", code=5)
        record = json.loads((self.case / "solve.json").read_text(encoding="utf-8"))
        self.assertFalse(record["frames"][0]["converged"])
        self.assertGreater(abs(record["frames"][0]["unsolved_flux"]), 1e-3 * record["frames"][0]["emitted_flux"])
        again = self.run_ok("kinelux-solve", "case", "--max-sweeps", "1", "--tolerance", "1e-9", "--if-stale", code=5)
        self.assertIn("up to date", again.stderr)
        self.run_ok("kinelux-export", "case")

    def test_interrupted_run_says_how_to_go_on_and_loses_nothing(self):
        process = subprocess.Popen([str(BIN / "kinelux"), "run", str(self.scene), "-o", "case", "--element-size", "0.1"],
                                   cwd=self.folder, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        while "kinelux-coefficients: seed" not in process.stderr.readline():
            self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, rest)
        self.assertIn("interrupted", rest)
        self.assertEqual(hashes(self.case)["coefficients.h5"], self.before["coefficients.h5"])
        self.run_ok("kinelux", "run", self.scene, "-o", "case")


class MovingScene(StageTest):
    def test_frames_meters_and_pvd(self):
        meter = '[[meter]]\nname = "plane"\norigin = [0.2, 0.2, 1.0]\nedge_u = [0.2, 0, 0]\nedge_v = [0, 0.2, 0]\n' \
                'count_u = 2\ncount_v = 1\n'
        scene = scenes.write_room(self.folder, moving=True, more=meter, quantity="photometric")
        self.run_ok("kinelux", "run", scene, "-o", "case")
        case = self.folder / "case"
        with (case / "meters.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["frame", "time_s", "meter", "quantity", "channel", "value", "unit",
                                         "error_estimate"])
        self.assertEqual({row["frame"] for row in rows}, {"0", "1", "2"})
        self.assertTrue({"room", "block", "lamp"} <= {row["meter"] for row in rows})
        self.assertTrue(all(math.isfinite(float(row["value"])) for row in rows))
        self.assertIn("lx", {row["unit"] for row in rows})

        datasets = ElementTree.parse(case / "view.pvd").getroot().findall("./Collection/DataSet")
        self.assertEqual([float(data.get("timestep")) for data in datasets], [0.0, 0.5, 1.0])
        for data in datasets:
            self.assertTrue((case / data.get("file")).exists())

        record = json.loads((case / "solve.json").read_text(encoding="utf-8"))
        self.assertGreater(record["frames"][1]["blocks_recomputed"], 0)
        self.assertEqual(record["flux_unit"], "lm")
        for frame in record["frames"]:
            self.assertAlmostEqual(frame["emitted_flux"], 2 * 0.36 * (10 + 5), 6)
            self.assertLess(abs(frame["unsolved_flux"]), 1e-3 * frame["emitted_flux"])
            self.assertEqual(frame["negative_flux"], 0)
            # The room is closed.
            self.assertLess(abs(frame["lost_flux"]), 0.02 * frame["emitted_flux"])

    def test_plan_predicts_blocks_and_memory_and_leaves_the_plan_as_it_is(self):
        scene = scenes.write_room(self.folder, moving=True, target="5%")
        self.run_ok("kinelux", "run", scene, "-o", "case", "--element-size", "0.2")
        case = self.folder / "case"
        before = (case / "plan.json").read_bytes()
        done = self.run_ok("kinelux", "plan", "case")
        self.assertRegex(done.stdout, r"predicted from \d+ of \d+ block rows")
        self.assertEqual((case / "plan.json").read_bytes(), before)
        predicted = json.loads((case / "plan-record.json").read_text(encoding="utf-8"))["predicted"]
        counts = json.loads((case / "coefficients.json").read_text(encoding="utf-8"))["counts"]
        self.assertLess(0.7, predicted["blocks"] / counts["blocks"])
        self.assertLess(predicted["blocks"] / counts["blocks"], 1.4)
        self.assertGreater(predicted["coefficients_seconds"], 0)
        self.assertGreater(predicted["solve_seconds"], 0)
        self.assertGreater(predicted["blocks_per_frame"], 0)
        elements = json.loads((case / "cluster.json").read_text(encoding="utf-8"))["counts"]["elements"]
        size = counts["blocks"] * (4 * (counts["unknowns"] / elements) ** 2 + 24) / 2**20
        self.assertLess(0.7, predicted["memory_mib"] / size)
        self.assertLess(predicted["memory_mib"] / size, 1.4)

    def test_shadows_of_the_publication_cost_what_exact_ones_do_not(self):
        scene = scenes.write_room(self.folder, moving=True, frames=4, target="3%")
        self.run_ok("kinelux", "run", scene, "-o", "case")

        def radiosity(*options):
            self.run_ok("kinelux-solve", "case", *options)
            with h5py.File(self.folder / "case/solution.h5") as file:
                return numpy.array(file["radiosity"])

        exact = radiosity("--engine", "exact")
        off = {word: numpy.linalg.norm(radiosity("--engine", "paper", "--paper-shadows", word) - exact)
                     / numpy.linalg.norm(exact) for word in ("exact", "publication", "sources-too")}
        self.assertLess(off["exact"], 1e-3)
        self.assertLess(off["exact"], 0.1 * off["publication"])
        self.assertLess(off["publication"], off["sources-too"])
        self.assertLess(off["sources-too"], 0.3)

    def test_frames_option_solves_and_exports_a_part(self):
        scene = scenes.write_room(self.folder, moving=True)
        self.run_ok("kinelux", "run", scene, "-o", "case", "--frames", "1,2")
        self.assertEqual(sorted(file.name for file in (self.folder / "case/frames").iterdir()),
                         ["frame_0001.vtu", "frame_0002.vtu"])
        self.assert_fails(2, r"--frames 7,9: the scene has frames 0 to 2", "kinelux-solve", "case", "--frames", "7,9")

    def test_linked_groups_give_every_frame_too(self):
        scene = scenes.write_room(self.folder, moving=True, target="5%")
        self.run_ok("kinelux", "run", scene, "-o", "case", "--element-size", "0.2")
        case = self.folder / "case"
        expected = json.loads((case / "solve.json").read_text(encoding="utf-8"))["frames"]
        self.run_ok("kinelux-coefficients", "case", "--groups", "always")
        counts = json.loads((case / "coefficients.json").read_text(encoding="utf-8"))["counts"]
        self.assertGreater(counts["links"], 0)
        self.run_ok("kinelux-solve", "case")
        self.run_ok("kinelux-export", "case")
        found = json.loads((case / "solve.json").read_text(encoding="utf-8"))["frames"]
        self.assertEqual([f["blocks_recomputed"] for f in found], [f["blocks_recomputed"] for f in expected])
        self.assertTrue(all(f["converged"] for f in found))
        self.assert_fails(2, r"shooting needs the blocks of all pairs", "kinelux-solve", "case", "--method", "shooting")

    def test_engines_of_motion_agree_within_the_accuracy(self):
        scene = scenes.write_room(self.folder, moving=True, frames=12)
        self.run_ok("kinelux", "run", scene, "-o", "case")
        case = self.folder / "case"
        radiosity = {}
        for engine in ("auto", "exact", "online", "offline"):
            self.run_ok("kinelux-solve", "case", "--engine", engine)
            self.run_ok("kinelux-export", "case")
            record = json.loads((case / "solve.json").read_text(encoding="utf-8"))
            self.assertEqual(record["engine"], "offline" if engine == "auto" else engine)
            for frame in record["frames"]:
                self.assertEqual(frame["blocks_changing"], frame["blocks_recomputed"] + frame["blocks_expanded"])
            self.assertGreater(record["counts"]["blocks_changing"], 0)
            self.assertEqual("memory_of_motion_MiB" in record["figures"], engine != "exact")
            with (case / "meters.csv").open(encoding="utf-8", newline="") as file:
                radiosity[engine] = [float(row["value"]) for row in csv.DictReader(file)]
        self.assertEqual(radiosity["auto"], radiosity["offline"])
        for engine in ("online", "offline"):
            for found, expected in zip(radiosity[engine], radiosity["exact"]):
                self.assertAlmostEqual(found, expected, delta=0.1 * abs(expected) + 1e-9, msg=engine)
        self.assert_fails(2, r"--engine", "kinelux-solve", "case", "--engine", "perfect")

    def readings(self, case, quantity="irradiance"):
        """{(frame, meter, channel): value} of a quantity."""
        with (self.folder / case / "meters.csv").open(encoding="utf-8", newline="") as file:
            return {(int(row["frame"]), row["meter"], row["channel"]): float(row["value"])
                    for row in csv.DictReader(file) if row["quantity"] == quantity}

    def frames_of(self, case):
        return json.loads((self.folder / case / "solve.json").read_text(encoding="utf-8"))["frames"]

    def test_a_lamp_on_an_arm_and_a_meter_on_it_read_as_in_a_scene_built_at_each_pose(self):
        scene = scenes.write_arm(self.folder, frames=3)
        self.run_ok("kinelux", "run", scene, "-o", "moving")
        moving = self.readings("moving")
        self.assertGreater(self.frames_of("moving")[1]["blocks_recomputed"], 0)
        for frame, time_s in enumerate((0.0, 1.0, 2.0)):
            still = scenes.write_arm(self.folder, frames=1, start_s=time_s, name="still")
            self.run_ok("kinelux", "run", still, "-o", f"still{frame}")
            self.assertEqual(self.frames_of(f"still{frame}")[0]["blocks_recomputed"], 0)
            counts = json.loads((self.folder / f"still{frame}/coefficients.json").read_text(encoding="utf-8"))["counts"]
            self.assertEqual((counts["moving_pairs"], counts["crossed_pairs"]), (0, 0))
            for (_, meter, channel), value in self.readings(f"still{frame}").items():
                self.assertAlmostEqual(moving[frame, meter, channel] / value, 1.0, delta=0.01,
                                       msg=f"frame {frame}, {meter}, {channel}")

    def test_a_lamp_on_an_arm_agrees_with_the_path_tracer(self):
        scene = scenes.write_arm(self.folder, frames=3)
        self.run_ok("kinelux", "run", scene, "-o", "case")
        self.call("kinelux-reference", "case", "--frames", "2", "--points", "200", "--paths", "4096")
        report = json.loads((self.folder / "case/reference.json").read_text(encoding="utf-8"))
        self.assertLess(report["relative_rms_difference"], 0.04)

    def test_a_dimmed_lamp_scales_all_light_and_recomputes_nothing(self):
        dimming = '[[dimming]]\nname = "evening"\nkeyframe = [{time_s = 0, factor = 1}, {time_s = 2, factor = 0}]\n'
        scene = scenes.write_room(self.folder, frames=3, end_s=2.0, more=dimming, lamp_more='dimming = "evening"')
        self.run_ok("kinelux", "run", scene, "-o", "case")
        readings = self.readings("case")
        for (frame, meter, channel), value in readings.items():
            self.assertAlmostEqual(value, (1.0, 0.5, 0.0)[frame] * readings[0, meter, channel],
                                   delta=1e-3 * readings[0, meter, channel], msg=f"{frame} {meter} {channel}")
        self.assertEqual([f["blocks_recomputed"] for f in self.frames_of("case")], [0, 0, 0])
        effects = json.loads((self.folder / "case/plan.json").read_text(encoding="utf-8"))["effects"]
        self.assertIn("evening (0 to 1)", {e["name"]: e["reason"] for e in effects}["dimming"])
        self.call("kinelux-reference", "case", "--frames", "1", "--points", "200", "--paths", "4096")
        report = json.loads((self.folder / "case/reference.json").read_text(encoding="utf-8"))
        self.assertLess(report["relative_rms_difference"], 0.1)

    def test_energy_that_arrives_is_energy_that_leaves(self):
        scene = scenes.write_room(self.folder, moving=True, target="5%")
        self.run_ok("kinelux", "run", scene, "-o", "case")
        with (self.folder / "case/meters.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        # The lamp is a sheet: both its sides emit, both absorb all that arrives.
        areas = {"room": 24.0, "block": 2 * (0.25 + 0.2 + 0.2), "lamp": 0.72}
        for frame in "012":
            for channel, rho, exitance in (("red", 0.7, 10.0), ("blue", 0.4, 5.0)):
                absorbed = sum((1.0 if row["meter"] == "lamp" else 1.0 - rho) * float(row["value"]) * areas[row["meter"]]
                               for row in rows
                               if (row["frame"], row["channel"], row["quantity"]) == (frame, channel, "irradiance"))
                self.assertAlmostEqual(absorbed / (exitance * 0.72), 1.0, delta=0.03, msg=f"frame {frame}, {channel}")


class FormFactorsAndInfo(StageTest):
    def test_form_factors_of_a_closed_room_sum_to_one(self):
        scene = scenes.write_room(self.folder)
        done = self.run_ok("kinelux", "form-factors", scene, "-o", "case", "--csv", "f.csv")
        self.assertIn("row sum", done.stdout)
        with (self.folder / "f.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["from", "to", "form_factor", "error_estimate", "from_area_m2", "to_area_m2"])
        for name in ("room", "block", "lamp"):
            total = sum(float(row["form_factor"]) for row in rows if row["from"] == name)
            self.assertAlmostEqual(total, 1.0, delta=0.03, msg=name)
        self.run_ok("kinelux", "form-factors", "case", "--csv", "p.csv", "--patches")
        self.assertIn("patch 0", (self.folder / "p.csv").read_text(encoding="utf-8"))

    def test_form_factors_do_not_depend_on_place_turn_and_unit(self):
        cosine, sine = math.cos(0.7), math.sin(0.7)
        places = {"as it is": lambda x, y, z: (x, y, z),
                  "turned": lambda x, y, z: (cosine * x - sine * y, sine * x + cosine * y, z),
                  "scaled by 1e-3": lambda x, y, z: (1e-3 * x, 1e-3 * y, 1e-3 * z),
                  "scaled by 1e3": lambda x, y, z: (1e3 * x, 1e3 * y, 1e3 * z),
                  "moved by 1e4": lambda x, y, z: (x + 6e3, y - 8e3, z)}
        found = {}
        for name, place in places.items():
            scenes.furnished_room(place).write(self.folder / "room.obj")
            self.run_ok("kinelux", "form-factors", "room.obj", "--csv", "f.csv")
            with (self.folder / "f.csv").open(encoding="utf-8", newline="") as file:
                found[name] = {(row["from"], row["to"]): float(row["form_factor"]) for row in csv.DictReader(file)}
            for pair, value in found["as it is"].items():
                self.assertAlmostEqual(found[name][pair], value, delta=1e-3, msg=f"{name}: {pair}")
            for group in ("room", "table", "screen"):
                total = sum(value for (start, _), value in found[name].items() if start == group)
                self.assertAlmostEqual(total, 1.0, delta=3e-3, msg=f"{name}: {group}")

    def test_form_factors_say_what_reaches_nothing_and_refuse_a_missing_folder_early(self):
        obj = scenes.Obj().group("room", *scenes.box_faces((0, 0, 0), (2, 2, 2), True))
        obj.group("cupboard", *scenes.box_faces((0.5, 0.5, 0), (1, 1, 1), False)).write(self.folder / "room.obj")
        shown = self.run_ok("kinelux", "form-factors", "room.obj").stdout
        self.assertIn("a cupboard's foot and the floor below it", shown)
        row = next(line.split() for line in shown.splitlines() if line.split()[:1] == ["cupboard"])
        self.assertAlmostEqual(float(row[4]), 0.25 / 2.5, delta=1e-3, msg="its foot")
        self.assert_fails(3, r"--csv nowhere/f.csv: there is no such folder", "kinelux", "form-factors", "room.obj", "--csv",
                          "nowhere/f.csv")

    def test_form_factors_count_moving_bodies_where_they_are(self):
        scene = scenes.write_room(self.folder, moving=True)
        for frame in (0, 2):
            self.run_ok("kinelux", "form-factors", scene, "-o", "case", "--frame", frame, "--csv", "f.csv")
            with (self.folder / "f.csv").open(encoding="utf-8", newline="") as file:
                total = sum(float(row["form_factor"]) for row in csv.DictReader(file) if row["from"] == "block")
            self.assertAlmostEqual(total, 1.0, delta=0.03)

    def test_info_of_everything(self):
        scene = scenes.write_room(self.folder)
        self.run_ok("kinelux", "run", scene, "-o", "case")
        for name, expected in (("room.toml", "a scene"), ("room.obj", "a mesh"), ("case", "view.pvd"),
                               ("case/scene.json", "kinelux-scene"), ("case/patches.h5", "patches"),
                               ("case/clusters.h5", "elements"), ("case/plan.json", "interreflection"),
                               ("case/coefficients.h5", "static blocks"), ("case/solution.h5", "residual"),
                               ("case/frames/frame_0000.vtu", "triangles"), ("case/fit.json", "record")):
            self.assertIn(expected, self.run_ok("kinelux", "info", name).stdout, name)
        # A case's scene is shown with its meshes: the lamp emits, and no object is without area.
        shown = self.run_ok("kinelux", "info", "case/scene.json").stdout
        self.assertRegex(shown, r"lamp\s+\d+\s+[\d.]+\s+\S+\s+yes")
        self.assertNotRegex(shown, r"triangles\s+0\b")
        self.assert_fails(3, r"nowhere\.h5", "kinelux", "info", "nowhere.h5")


class BareMesh(StageTest):
    def test_an_obj_with_an_emissive_material_runs(self):
        obj = scenes.Obj()
        obj.lines += ["mtllib room.mtl", "usemtl wall"]
        obj.group("room", *scenes.box_faces((0, 0, 0), (2, 2, 2), True))
        obj.lines.append("usemtl glow")
        obj.group("lamp", *scenes.lamp((0.7, 0.7), (1.3, 1.3), 1.9))
        obj.write(self.folder / "room.obj")
        materials = "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glow\nKd 0.1 0.1 0.1\nKe 3 3 3\n"
        (self.folder / "room.mtl").write_text(materials, encoding="utf-8")
        self.run_ok("kinelux", "run", "room.obj", "-o", "case", "--accuracy", "10%")
        self.assertTrue((self.folder / "case/view.pvd").exists())
        # Colours are input like any other, though they stand in a file that the mesh names.
        (self.folder / "room.mtl").write_text(materials.replace("0.5 0.5 0.5", "0.6 0.5 0.5"), encoding="utf-8")
        self.assertNotIn("kinelux-clean: up to date", self.run_ok("kinelux", "run", "room.obj", "-o", "case").stderr)


class Cornell(StageTest):
    def test_exported_irradiance_is_what_the_path_tracer_finds(self):
        scene = ROOT / "data/scenes/cornell/cornell-static.toml"
        self.run_ok("kinelux", "run", scene, "-o", "case")
        started = time.monotonic()
        done = self.call("kinelux-reference", "case")
        self.assertIn(done.returncode, (0, 5), done.stderr)
        print(done.stdout, f"in {time.monotonic() - started:.1f} s")
        report = json.loads((self.folder / "case/reference.json").read_text(encoding="utf-8"))
        self.assertLess(report["reference_noise"], 0.01)
        self.assertLess(report["relative_rms_difference"], 0.03)
        self.assertGreaterEqual(report["points"], 390)
        with (self.folder / "case/reference.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["frame", "object", "x", "y", "z", "nx", "ny", "nz", "channel", "irradiance",
                                         "standard_error", "exported", "unit"])

    def test_sensors_from_a_file(self):
        scene = scenes.write_room(self.folder, target="5%")
        self.run_ok("kinelux", "run", scene, "-o", "case")
        (self.folder / "sensors.txt").write_text("# on the floor\n1.7 1.7 0 0 0 1\n0.3 0.3 0 0 0 2\n", encoding="utf-8")
        self.call("kinelux-reference", "case", "--sensors", "sensors.txt", "--paths", "4096")
        with (self.folder / "case/reference.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 4)
        for row in rows:
            self.assertAlmostEqual(float(row["exported"]) / float(row["irradiance"]), 1.0, delta=0.1)
        (self.folder / "sensors.txt").write_text("1 2 3 four 5 6\n", encoding="utf-8")
        self.assert_fails(3, r"sensors\.txt:1: expected six numbers", "kinelux-reference", "case", "--sensors",
                          "sensors.txt")


class CadAssembly(StageTest):
    def test_instances_keep_names_sizes_and_colours_through_the_stages(self):
        scene = ROOT / "data/scenes/workshop/workshop.toml"
        self.run_ok("kinelux", "run", scene, "-o", "case", "--accuracy", "30%", "--element-size", "1.5", "--frames", "0,1")
        record = json.loads((self.folder / "case/clean.json").read_text(encoding="utf-8"))
        area = {part["object"]: part["area_out_m2"] for part in record["objects"]}
        self.assertAlmostEqual(area["walls"], 2 * (5.4 * 4.4 + 5.4 * 3.2 + 4.4 * 3.2) + 2 * (5 * 4 + 5 * 2.8 + 4 * 2.8), 6)
        column = 2 * math.pi * 0.25 * (0.25 + 2.6)
        self.assertLess(abs(area["column"] - column), 5e-3 * column)
        materials = json.loads((self.folder / "case/scene.json").read_text(encoding="utf-8"))["materials"]
        self.assertTrue(any(max(abs(a - b) for a, b in zip(m["reflectance"], (0.55, 0.35, 0.2))) < 1e-3 for m in materials))
        frames = json.loads((self.folder / "case/solve.json").read_text(encoding="utf-8"))["frames"]
        self.assertTrue(all(frame["converged"] for frame in frames))

    def test_broken_files_are_refused_and_nothing_is_lost(self):
        whole = (ROOT / "data/scenes/workshop/workshop.step").read_bytes()
        (self.folder / "half.step").write_bytes(whole[:len(whole) // 2])
        self.assert_fails(3, r"half\.step: cannot be read as a CAD model", "kinelux", "run", "half.step")
        (self.folder / "other.igs").write_bytes(whole)
        shown = self.run_ok("kinelux", "info", "other.igs").stdout
        self.assertIn("leg 4", shown)


class ForeignModels(StageTest):
    """Meshes of others, each in a lit room as large as it is."""

    FOLDER = pathlib.Path("/usr/share/assimp/models")

    def light_up(self, model):
        file = self.FOLDER / model
        if not file.exists():
            self.skipTest(f"{file} is not there (Debian: assimp-testmodels)")
        shown = self.run_ok("kinelux", "info", file).stdout
        numbers = [float(word) for word in re.search(r"bounds \[m\]\s+(.*)", shown).group(1).replace("..", " ").split()]
        low, high = numbers[:3], numbers[3:]
        size = max(b - a for a, b in zip(low, high))
        centre = [0.5 * (a + b) for a, b in zip(low, high)]
        room = [c - size for c in centre], [c + size for c in centre]
        obj = scenes.Obj().group("room", *scenes.box_faces(*room, True))
        obj.group("lamp", *scenes.lamp([centre[0] - size / 3, centre[1] - size / 3],
                                       [centre[0] + size / 3, centre[1] + size / 3], room[1][2] - 0.05 * size))
        obj.write(self.folder / "room.obj")
        text = scenes.ROOM.format(target="20%", end_s=0.0, frames=1, block_motion="", quantity="radiometric", more="", lamp="")
        text = text.replace("element_size = 0.5", f"element_size = {0.5 * size}")
        text = text.replace('mesh = "room.obj"\ngroup = "block"', f'mesh = "{file}"')
        scene = self.folder / "scene.toml"
        scene.write_text(text, encoding="utf-8")
        self.run_ok("kinelux", "run", scene, "-o", "case", "--allow-outside")
        with (self.folder / "case/meters.csv").open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        irradiance = [float(row["value"]) for row in rows
                      if row["quantity"] == "irradiance" and row["meter"] not in ("room", "lamp")]
        self.assertTrue(irradiance)
        # No surface gets more on average than the lamp's exitance, and the model is lit.
        self.assertTrue(all(0.0 <= value < 10.0 for value in irradiance), irradiance)
        self.assertGreater(max(irradiance), 0.01)
        # What arrives at the walls and what they reflect is not more than the lamp (a sheet, at most two sides) emits,
        # multiplied by what reflections add at most.
        area = 6 * (2 * size) ** 2
        at_walls = max(float(row["value"]) for row in rows if row["quantity"] == "irradiance" and row["meter"] == "room")
        emitted = 2 * 10.0 * (2 * size / 3) ** 2
        self.assertLess(at_walls * area, 1.05 * emitted / (1 - 0.7))
        self.assertGreater(at_walls * area, 0.05 * emitted)

    def test_an_obj_spider(self):
        self.light_up("OBJ/spider.obj")

    def test_a_ply_character(self):
        self.light_up("PLY/Wuson.ply")

    def test_an_stl_character(self):
        self.light_up("STL/Wuson.stl")


if __name__ == "__main__":
    unittest.main(verbosity=2)
