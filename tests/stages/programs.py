# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the executables share. KINELUX_BIN: where they are; KINELUX_ROOT: the source tree."""

import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["KINELUX_BIN"])
ROOT = pathlib.Path(os.environ["KINELUX_ROOT"])
STAGES = ["clean", "fit", "cluster", "plan", "coefficients", "solve", "export"]
PROGRAMS = ["kinelux"] + [f"kinelux-{stage}" for stage in STAGES + ["reference"]]
COMPARED = ["patches.h5", "clusters.h5", "plan.json", "coefficients.h5", "solution.h5", "meters.csv"]


def hashes(folder):
    """Hash of every file of a folder tree by its path."""
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file()}


class StageTest(unittest.TestCase):
    """A temporary folder, and ways to run programs in it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="kinelux-stages-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, program, *arguments):
        return subprocess.run([str(BIN / program), *map(str, arguments)], cwd=self.folder, capture_output=True,
                              text=True, check=False, timeout=500)

    def run_ok(self, program, *arguments, code=0):
        done = self.call(program, *arguments)
        self.assertEqual(done.returncode, code, f"{program} {arguments}\n{done.stdout}{done.stderr}")
        return done

    def assert_fails(self, code, pattern, program, *arguments):
        """One line on stderr, nothing on stdout, the documented exit code."""
        done = self.call(program, *arguments)
        lines = done.stderr.splitlines()
        lines = [line for line in lines if re.match(r"kinelux[a-z-]*: (error|internal error|interrupted)", line)]
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertRegex(lines[0], pattern)
        self.assertTrue(done.stderr.endswith(lines[0] + "\n"), done.stderr)

    @staticmethod
    def stage_lines(done):
        return [line for line in done.stderr.splitlines() if line.startswith("kinelux")]

    def assert_same_results(self, one, other):
        for name in COMPARED:
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)
