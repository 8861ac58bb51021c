# SPDX-License-Identifier: GPL-3.0-or-later
"""What `cmake --install` puts into a folder works from there: programs, manual pages, completions, and the library in a
project of its own."""

import os
import pathlib
import subprocess
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["KINELUX_BUILD"])
ROOT = pathlib.Path(os.environ["KINELUX_ROOT"])


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.prefix = pathlib.Path(cls.folder.name) / "prefix"
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_programs_find_each_other(self):
        case = pathlib.Path(self.folder.name) / "cornell.case"
        run(self.prefix / "bin/kinelux", "clean", ROOT / "data/scenes/cornell/cornell.toml", "-o", case)
        run(self.prefix / "bin/kinelux", "fit", case)
        self.assertTrue((case / "patches.h5").exists())
        self.assertIn("usage: kinelux-study", run(self.prefix / "bin/kinelux", "study", "--help"))
        scene = ROOT / "data/scenes/cornell/cornell-static.toml"
        run(self.prefix / "bin/kinelux", "study", scene, "-o", case.parent / "study", "--accuracies", "30", "--points",
            "10", "--reference-time", "1")
        run(self.prefix / "bin/kinelux", "report", case, "--no-pictures")
        self.assertIn("There is no plan yet", (case / "report.html").read_text(encoding="utf-8"))

    def test_every_program_has_a_manual_page_that_man_accepts(self):
        for program in (self.prefix / "bin").glob("kinelux*"):
            if program.name in ("kinelux-study", "kinelux-report"):  # Python, with --help of their own
                continue
            page = self.prefix / "share/man/man1" / f"{program.name}.1"
            shown = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, check=True,
                                   env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "100", "LC_ALL": "C.UTF-8"})
            self.assertEqual("", shown.stderr, page)
            self.assertIn("NAME", shown.stdout)
        fit = (self.prefix / "share/man/man1/kinelux-fit.1").read_text(encoding="utf-8")
        self.assertIn(r"\-\-round\-face\-turn", fit)

    def test_bash_completes_commands_and_options(self):
        def completed(*words):
            script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _kinelux; '
                      'printf "%s\\n" "${COMPREPLY[@]}"')
            return run("bash", "-c", script, "bash", self.prefix / "share/bash-completion/completions/kinelux",
                       *words).split()

        kinelux = self.prefix / "bin/kinelux"
        self.assertEqual(["clean", "cluster", "coefficients"], sorted(completed(kinelux, "c")))
        self.assertIn("form-factors", completed(kinelux, "fo"))
        self.assertEqual(["--round-face-turn"], completed(kinelux, "fit", "--rou"))
        self.assertEqual(["--round-face-turn"], completed(self.prefix / "bin/kinelux-fit", "--rou"))

    def test_a_project_that_finds_the_package_builds_and_runs(self):
        build = pathlib.Path(self.folder.name) / "consumer"
        run("cmake", "-S", ROOT / "tests/install/consumer", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", build)
        case = pathlib.Path(self.folder.name) / "consumer.case"
        run(self.prefix / "bin/kinelux-clean", ROOT / "data/scenes/cornell/cornell.toml", "-o", case)
        self.assertRegex(run(build / "consumer", case), r"^\d+ patches\n$")


if __name__ == "__main__":
    unittest.main()
