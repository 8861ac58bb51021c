#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages that are killed or asked to stop, and run again."""

import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import scenes
from programs import BIN, StageTest


class Resumed:
    """A moving scene that is computed once without interruption, and a copy of its case without one stage's result."""

    program, result, saved, resumes, begins_anew, other_options = "", "", "", "", "", ()

    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="kinelux-stages-"))
        cls.addClassCleanup(shutil.rmtree, cls.made)
        cls.scene = scenes.write_room(cls.made, moving=True, frames=12)
        text = cls.scene.read_text(encoding="utf-8").replace("element_size = 0.5", "element_size = 0.3")
        cls.scene.write_text(text, encoding="utf-8")
        subprocess.run([str(BIN / "kinelux"), "run", str(cls.scene), "-o", str(cls.made / "whole"), "-j", "2"],
                       capture_output=True, check=True, timeout=500)

    def setUp(self):
        super().setUp()
        self.whole = (self.made / "whole" / self.result).read_bytes()
        self.case, self.so_far = self.folder / "case", self.folder / "case" / self.saved
        self.fresh_copy()

    def fresh_copy(self):
        shutil.rmtree(self.case, ignore_errors=True)
        shutil.copytree(self.made / "whole", self.case)
        (self.case / self.result).unlink()

    def stop_after(self, saves, sign, *arguments):
        """Starts the stage such that it saves whenever it can, and sends a signal after so many saves.
        @return  exit code, stderr"""
        command = [str(BIN / self.program), "case", "--save-every", "0", *map(str, arguments)]
        with subprocess.Popen(command, cwd=self.folder, text=True, stderr=subprocess.PIPE,
                              stdout=subprocess.DEVNULL) as process:
            seen = set()
            while len(seen) < saves:
                self.assertIsNone(process.poll(), "ended before it could be stopped")
                if self.so_far.exists():
                    seen.add(self.so_far.stat().st_mtime_ns)
                time.sleep(0.001)
            process.send_signal(sign)
            _, printed = process.communicate(timeout=120)
            return process.returncode, printed

    def assert_finishes_as_if_never_interrupted(self, *arguments):
        done = self.run_ok(self.program, "case", *arguments)
        self.assertRegex(done.stderr, self.resumes)
        self.assertEqual((self.case / self.result).read_bytes(), self.whole)
        self.assertFalse(self.so_far.exists())

    def test_killed_anywhere_and_run_again_it_gives_the_same_bytes(self):
        for saves, threads in ((1, 1), (3, 2), (7, 1)):
            self.fresh_copy()
            self.stop_after(saves, signal.SIGKILL, "-j", threads)
            self.assertFalse((self.case / self.result).exists())
            self.assert_finishes_as_if_never_interrupted("-j", 3 - threads)
        again = self.run_ok(self.program, "case")
        self.assertIn(f"{self.program}: up to date", again.stderr)

    def test_killed_twice(self):
        for saves in (2, 3):
            self.stop_after(saves, signal.SIGKILL)
        self.assert_finishes_as_if_never_interrupted()

    def test_asked_to_stop_it_saves_what_it_has_done(self):
        code, printed = self.stop_after(1, signal.SIGTERM)
        self.assertEqual(code, 143)
        self.assertRegex(printed, r"saved \d+ (frames|rows); the same command resumes")
        self.assert_finishes_as_if_never_interrupted()

    def test_kinelux_run_goes_on_where_the_stage_was_killed(self):
        self.stop_after(2, signal.SIGKILL)
        done = self.run_ok("kinelux", "run", self.scene, "-o", "case")
        self.assertRegex(done.stderr, self.resumes)
        self.assert_same_results(self.made / "whole", self.case)

    def test_info_describes_what_is_done(self):
        self.stop_after(1, signal.SIGKILL)
        self.assertRegex(self.run_ok("kinelux", "info", self.so_far).stdout, r"(frames|rows done) +\d+")

    def test_what_was_done_with_other_options_or_is_damaged_is_not_used(self):
        self.stop_after(2, signal.SIGKILL)
        done = self.run_ok(self.program, "case", *self.other_options)
        self.assertNotIn("resumes", done.stderr)

        self.fresh_copy()
        self.stop_after(2, signal.SIGKILL)
        saved = self.so_far.read_bytes()
        self.so_far.write_bytes(saved[:len(saved) // 2])
        done = self.run_ok(self.program, "case")
        self.assertIn(self.begins_anew, done.stderr)
        self.assertEqual((self.case / self.result).read_bytes(), self.whole)

        self.so_far.write_bytes(saved)
        done = self.run_ok(self.program, "case", "--resume", "no")
        self.assertNotIn("resumes", done.stderr)
        self.assertEqual((self.case / self.result).read_bytes(), self.whole)


class ResumedSolve(Resumed, StageTest):
    program, result, saved = "kinelux-solve", "solution.h5", "solution-so-far.h5"
    resumes, begins_anew = r"resumes after frame \d+: \d+ frames are done", "begins at the first frame"
    other_options = ("--tolerance", "1e-6")


class ResumedCoefficients(Resumed, StageTest):
    program, result, saved = "kinelux-coefficients", "coefficients.h5", "coefficients-so-far.h5"
    resumes, begins_anew = r"resumes after row \d+ of \d+", "begins at the first row"
    other_options = ("--seed", "2")


class ResumedLinks(ResumedCoefficients):
    """The same where distant groups exchange light as one."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([str(BIN / "kinelux-coefficients"), str(cls.made / "whole"), "--groups", "always"],
                       capture_output=True, check=True, timeout=500)

    def stop_after(self, saves, sign, *arguments):
        return super().stop_after(saves, sign, "--groups", "always", *arguments)

    def run_ok(self, program, *arguments, code=0):
        links = ("--groups", "always") if program == self.program else ()
        return super().run_ok(program, *arguments, *links, code=code)

    def test_kinelux_run_goes_on_where_the_stage_was_killed(self):
        self.skipTest("kinelux run leaves the choice of links to the stage")


if __name__ == "__main__":
    unittest.main()
