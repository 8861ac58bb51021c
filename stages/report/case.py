# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what the stages left in the folder of a case. What is not there yet is None; what is damaged is an error."""

import csv
import json
import pathlib
import re
import xml.etree.ElementTree as ElementTree

import content

STAGES = ("clean", "fit", "cluster", "plan", "coefficients", "solve", "export")
RECORDS = {stage: "plan-record.json" if stage == "plan" else f"{stage}.json" for stage in STAGES + ("reference",)}
KNOWN_VERSION = 1
INTERRUPTED = {"coefficients-so-far.h5": "coefficients", "solution-so-far.h5": "solve"}


class CaseError(Exception):
    """One line for the user: a file of the case is missing, damaged or too new."""


class Part:
    """A value out of a JSON file of the case, and where it was found: "solve.json:frames/3/unshot"."""

    def __init__(self, value, place):
        self.value, self.place = value, place

    def at(self, path):
        """What lies at this path, or None."""
        value = self.value
        for word in path.split("/"):
            if isinstance(value, list) and word.isdigit() and int(word) < len(value):
                value = value[int(word)]
            elif isinstance(value, dict) and word in value:
                value = value[word]
            else:
                return None
        return Part(value, self.place + ("" if self.place.endswith(":") else "/") + path)

    def get(self, path, default=None):
        part = self.at(path)
        return default if part is None or part.value is None else part.value

    def list(self, path):
        return [self.at(f"{path}/{k}") for k in range(len(self.get(path, [])))]


class Case:
    """The case in `folder`. @throws CaseError"""

    def __init__(self, folder):
        self.folder = folder
        if not folder.exists():
            raise CaseError(f"{folder}: there is no such case; run kinelux-clean on the scene first")
        if not folder.is_dir():
            raise CaseError(f"{folder}: is not a folder; name the folder of a case")
        self.scene = self.headed("scene.json", "kinelux-scene")
        if self.scene is None:
            raise CaseError(f"{folder}: not a case: there is no scene.json in it")
        self.plan = self.headed("plan.json", "kinelux-plan")
        run = self.json("run.json")
        self.records = {stage: self.json(file) or (run and run.at(f"stages/{stage}")) for stage, file in RECORDS.items()}
        self.meters = self.read_meters()
        self.frames = self.read_frames()

    def json(self, name):
        file = self.folder / name
        if not file.is_file():
            return None
        try:
            values = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise CaseError(f"{file}: cannot be read: {error}") from None
        if not isinstance(values, dict):
            raise CaseError(f"{file}: holds no JSON object")
        return Part(values, f"{name}:")

    def headed(self, name, kind):
        part = self.json(name)
        if part is None:
            return None
        if part.get("format") != kind:
            raise CaseError(f"{self.folder / name}: its format is '{part.get('format')}', not '{kind}'")
        if not isinstance(part.get("version"), int) or part.get("version") > KNOWN_VERSION:
            raise CaseError(f"{self.folder / name}: format version {part.get('version')} is newer than this program knows "
                            f"({KNOWN_VERSION})")
        return part

    def read_meters(self):
        """{(quantity, unit): {meter: {channel: [(time [s], frame, value, error)]}}}, in the order of the file"""
        file = self.folder / "meters.csv"
        if not file.is_file():
            return None
        found = {}
        try:
            with file.open(encoding="utf-8", errors="replace", newline="") as lines:
                for row in csv.DictReader(lines):
                    meter = found.setdefault((row["quantity"], row["unit"]), {}).setdefault(row["meter"], {})
                    meter.setdefault(row["channel"], []).append(
                        (float(row["time_s"]), int(row["frame"]), float(row["value"]), float(row["error_estimate"])))
        except (OSError, KeyError, TypeError, ValueError) as error:
            raise CaseError(f"{file}: cannot be read: {type(error).__name__}: {error}") from None
        return found

    def read_frames(self):
        """Numbers and times [s] of the exported frames, in the order of time; none without an export."""
        file = self.folder / "view.pvd"
        if not file.is_file():
            return []
        try:
            sets = ElementTree.parse(file).getroot().iter("DataSet")
            return [(int(re.search(r"frame_(\d+)", entry.get("file")).group(1)), float(entry.get("timestep")))
                    for entry in sets]
        except (OSError, ElementTree.ParseError, AttributeError, TypeError, ValueError) as error:
            raise CaseError(f"{file}: cannot be read: {error}") from None

    def stale(self):
        """Stages that were run on another file than lies there now, each with that file's name; None: cannot be told."""
        if content.XXHASH is None:
            return None
        found, hashes = [], {}
        for stage, record in self.records.items():
            for entry in record.get("inputs", []) if record and stage != "clean" else []:  # a scene is no file of the case
                file = self.folder / pathlib.PurePath(entry["file"]).name
                if not file.is_file():
                    continue
                if file.name not in hashes:
                    hashes[file.name] = content.file_hash(file)
                if hashes[file.name] != entry["hash"]:
                    found.append((stage, file.name))
        return found

    def interrupted(self):
        return [(file, stage) for file, stage in INTERRUPTED.items() if (self.folder / file).exists()]

    def title(self):
        return self.scene.get("title") or self.folder.name

    def target(self):
        """The accuracy asked for."""
        return self.scene.at("accuracy/target")
