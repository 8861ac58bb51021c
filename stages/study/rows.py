# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of a study: one run of all stages each, with what it took and how far it is from the truth."""

import csv
import hashlib
import json
import math
import pathlib
import subprocess
import sys
import time
import tomllib

ENGINES = ("auto", "exact", "online", "offline", "paper")
DEGREES = ("auto", "0", "1", "2", "3")
STAGES = ("clean", "fit", "cluster", "plan", "coefficients", "solve", "export")
PROGRAMS = pathlib.Path(sys.argv[0]).resolve().parent  # kinelux-study lies beside the others
FIRST_PATHS = 512             # per point, to find how noisy the scene is
MOST_PATHS = 1_000_000        # what kinelux-reference takes
NOISE_SHARE = 0.3             # of the finest accuracy: noise that would not disturb


class StudyError(Exception):
    """One line for the user. @param code  documented exit code"""

    def __init__(self, message, code):
        super().__init__(message)
        self.code = code


def run(options, folder):
    """All rows that the time allows, coarse ones first. @return  what study.json holds"""
    began = time.monotonic()
    folder.mkdir(parents=True, exist_ok=True)
    settings = [(engine, degree, accuracy) for engine in options.engines for degree in options.degrees
                for accuracy in options.accuracies]
    truth, found, left_out, seconds = None, [], [], {}
    for engine, degree, accuracy in settings:
        elapsed = time.monotonic() - began
        expected = expected_seconds(seconds.get((engine, degree), []))
        limit = options.time_limit - elapsed if options.time_limit else math.inf
        name = f"{engine}-degree-{degree}-{100 * accuracy:g}%"
        if expected > limit:
            left_out.append({"row": name, "expected_seconds": expected})
            say(options, f"{name}: left out, would take about {expected:.0f} s")
            continue
        case = folder / "cases" / f"{name.replace('%', '')}.case"
        say(options, f"{name}: runs" + (f", about {expected:.0f} s" if expected else ""))
        if not run_stages(options, case, engine, degree, accuracy, limit):
            left_out.append({"row": name, "expected_seconds": None})
            say(options, f"{name}: stopped at the time limit; the same command goes on there")
            break
        if truth is None:
            truth = Truth(options, folder, case, min(options.accuracies))
        row = measured(case, engine, degree, accuracy, truth)
        seconds.setdefault((engine, degree), []).append(row["seconds"])
        found.append(row)
    if not found:
        raise StudyError(f"no row fits into --time-limit {options.time_limit:g} s; give more time or a coarser accuracy", 5)
    compare_with_finer(found)
    mark_pareto(found)
    target = target_of(options.scene)
    return {"scene": options.scene.name, "title": truth.title, "target": target, "program": version(),
            "threads": options.threads, "reference": truth.summary(),
            "rows": [{key: value for key, value in row.items() if key != "exported"} for row in found],
            "left_out": left_out, "slopes": slopes(found), "advice": advice(found, target)}


def target_of(scene):
    """The accuracy that the scene itself asks for [1]; in the cases it is the rows' own."""
    usual = 0.03
    if scene.suffix != ".toml":
        return usual
    with scene.open("rb") as file:
        target = tomllib.load(file).get("accuracy", {}).get("target", usual)
    return float(target.rstrip("% ")) / 100 if isinstance(target, str) else float(target)


def say(options, text):
    if not options.quiet:
        print(f"kinelux-study: {text}", file=sys.stderr, flush=True)


def version():
    return subprocess.run([PROGRAMS / "kinelux", "--version"], capture_output=True, text=True, check=True).stdout.strip()


def expected_seconds(known):
    """Of the next finer row, from those before it: growth goes on as it was, or by 4 where nothing is known yet."""
    if not known:
        return 0.0
    return known[-1] * (max(known[-1] / known[-2], 1.0) if len(known) > 1 else 4.0)


def run_stages(options, case, engine, degree, accuracy, limit):
    """kinelux run; what is up to date is kept, with the times it took. @return  False: stopped at the limit"""
    command = [PROGRAMS / "kinelux", "run", options.scene, "-o", case, "--accuracy", f"{100 * accuracy:g}%",
               "--threads", str(options.threads), "--quiet"]
    command += ["--engine", engine] if engine != "auto" else []
    command += ["--degree", degree] if degree != "auto" else []
    command += ["--frames", options.frames] if options.frames else []
    command += ["--allow-outside"] if options.allow_outside else []
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        _, errors = process.communicate(timeout=None if math.isinf(limit) else max(limit, 1.0))
    except subprocess.TimeoutExpired:
        process.terminate()
        process.communicate()
        return False
    if process.returncode not in (0, 5):
        line = errors.strip().splitlines()[-1] if errors.strip() else "kinelux run failed"
        raise StudyError(line, process.returncode if process.returncode > 0 else 1)
    return True


def reference(case, frame, points, paths, threads):
    """Runs kinelux-reference on one frame. @return  {(point number, channel): (irradiance, standard error, exported)}"""
    done = subprocess.run([str(PROGRAMS / "kinelux-reference"), str(case), "--frames", f"{frame},{frame}", "--points",
                           str(points), "--paths", str(paths), "--threads", str(threads), "--quiet"],
                          capture_output=True, text=True, check=False)
    if done.returncode not in (0, 5):
        raise StudyError(done.stderr.strip().splitlines()[-1], done.returncode)
    found, point, place = {}, -1, None
    with (case / "reference.csv").open(encoding="utf-8", newline="") as file:
        for line in csv.DictReader(file):
            here = tuple(line[name] for name in ("object", "x", "y", "z", "nx", "ny", "nz"))
            point += here != place
            place = here
            found[here, point, line["channel"]] = (float(line["irradiance"]), float(line["standard_error"]),
                                                   float(line["exported"]) if line["exported"] else None)
    return found


class Truth:
    """Path-traced irradiance at the same points for all rows: traced once, with as many paths as the finest accuracy needs
    or the time allows."""

    def __init__(self, options, folder, case, finest):
        self.options, self.frames = options, judged_frames(case)
        self.title = json.loads((case / "scene.json").read_text(encoding="utf-8")).get("title") or options.scene.stem
        self.values, self.seconds = {}, 0.0
        for frame in self.frames:
            self.values[frame] = self.trace(folder, case, frame, finest)

    def trace(self, folder, case, frame, finest):
        key = hashlib.sha256(json.dumps([file_hash(case / "scene.json", "accuracy"), frame, self.options.points, finest,
                                         self.options.reference_time, version()]).encode()).hexdigest()[:16]
        kept = folder / "reference" / f"frame_{frame:04}_{key}.json"
        if kept.exists():
            stored = json.loads(kept.read_text(encoding="utf-8"))
            self.seconds += stored["seconds"]
            return {(tuple(o), p, c): (i, s) for o, p, c, i, s in stored["values"]}
        began = time.monotonic()
        first = reference(case, frame, self.options.points, FIRST_PATHS, self.options.threads)
        took = max(time.monotonic() - began, 1e-3)
        wanted = FIRST_PATHS * (noise_of(first.values()) / (NOISE_SHARE * finest)) ** 2
        allowed = FIRST_PATHS * self.options.reference_time / len(self.frames) / took
        paths = int(min(max(wanted, FIRST_PATHS), max(allowed, FIRST_PATHS), MOST_PATHS))
        say(self.options, f"path tracing: frame {frame}, {len(first)} values, {paths} paths each, "
                          f"about {took * paths / FIRST_PATHS:.0f} s")
        found = reference(case, frame, self.options.points, paths, self.options.threads)
        took = time.monotonic() - began
        self.seconds += took
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(json.dumps({"seconds": took, "values": [(o, p, c, i, s) for (o, p, c), (i, s, _) in found.items()]}),
                        encoding="utf-8")
        return {place: (irradiance, error) for place, (irradiance, error, _) in found.items()}

    def summary(self):
        values = [value for frame in self.frames for value in self.values[frame].values()]
        return {"frames": self.frames, "points_per_frame": self.options.points, "noise": noise_of(values),
                "seconds": self.seconds}


def file_hash(file, without):
    """Of a JSON file but for one of its parts."""
    content = json.loads(file.read_text(encoding="utf-8"))
    content.pop(without, None)
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def judged_frames(case):
    """First, middle and last of the exported frames."""
    frames = sorted(int(file.stem.split("_")[1]) for file in (case / "frames").glob("frame_*.vtu"))
    return sorted({frames[0], frames[len(frames) // 2], frames[-1]})


def noise_of(values):
    """Standard error of irradiance, RMS over the values, relative to their RMS [1]."""
    values = list(values)
    size = sum(value[0] ** 2 for value in values)
    return math.sqrt(sum(value[1] ** 2 for value in values) / size) if size > 0 else 0.0


def relative_rms(pairs):
    pairs = list(pairs)
    size = sum(b * b for _, b in pairs)
    return math.sqrt(sum((a - b) ** 2 for a, b in pairs) / size) if size > 0 else 0.0


def measured(case, engine, degree, accuracy, truth):
    """One row of the table."""
    record = json.loads((case / "run.json").read_text(encoding="utf-8"))
    stages = {name: {key: part.get(key) for key in ("seconds", "peak_memory_mib")}
              for name, part in record["stages"].items()}
    counts = {name: part.get("counts", {}) for name, part in record["stages"].items()}
    frames = {f["frame"]: f for f in record["stages"]["solve"]["frames"]}
    exported, errors = {}, {}
    for frame in truth.frames:
        few = reference(case, frame, truth.options.points, 4, truth.options.threads)
        here = {place: value for place, (_, _, value) in few.items() if value is not None and place in truth.values[frame]}
        exported.update({(frame, place): value for place, value in here.items()})
        raw = relative_rms((value, truth.values[frame][place][0]) for place, value in here.items())
        noise = noise_of(truth.values[frame][place] for place in here)
        errors[frame] = {"measured": math.sqrt(max(raw * raw - noise * noise, 0.0)), "noise": noise,
                         "estimated": frames[frame]["error_estimate"]}
    worst = max(errors.values(), key=lambda e: e["measured"])
    solve = counts["solve"]
    return {
        "accuracy": accuracy, "engine": engine, "degree": degree, "seconds": record["totals"]["seconds"],
        "peak_memory_mib": record["totals"]["peak_memory_mib"], "frames": solve["frames"],
        "elements": counts["cluster"].get("elements"), "unknowns": counts["coefficients"].get("unknowns"),
        "blocks": counts["coefficients"].get("blocks"), "blocks_recomputed": solve.get("blocks_recomputed"),
        "rays": counts["coefficients"].get("rays"),
        "estimated_error": worst["estimated"], "measured_error": worst["measured"], "reference_noise": worst["noise"],
        "estimate_to_true": worst["estimated"] / worst["measured"] if worst["measured"] > worst["noise"] else None,
        "to_next_finer": None, "keeps_accuracy": worst["measured"] <= accuracy + worst["noise"],
        "pareto": False, "stages": stages,
        "frame_errors": [{"frame": frame, "estimated": f["error_estimate"],
                          "measured": errors[frame]["measured"] if frame in errors else None}
                         for frame, f in sorted(frames.items())],
        "exported": exported}


def compare_with_finer(found):
    """Difference of the irradiance from that of the next finer row of the same engine and degree, at the same points."""
    for row, finer in zip(found, found[1:]):
        if (row["engine"], row["degree"]) == (finer["engine"], finer["degree"]):
            both = [place for place in row["exported"] if place in finer["exported"]]
            row["to_next_finer"] = relative_rms((row["exported"][p], finer["exported"][p]) for p in both)


def mark_pareto(found):
    """Rows than which none is both faster and more accurate."""
    for row in found:
        row["pareto"] = not any(other["seconds"] < row["seconds"] and other["measured_error"] <= row["measured_error"]
                                for other in found)


def slopes(found):
    """Per engine and degree: by what power of the measured error the time grows, least squares in logarithms; and the time
    at 1 % over that at 10 %."""
    result = []
    for engine, degree in dict.fromkeys((row["engine"], row["degree"]) for row in found):
        rows = [row for row in found if (row["engine"], row["degree"]) == (engine, degree)]
        points = [(math.log(row["measured_error"]), math.log(row["seconds"])) for row in rows if row["measured_error"] > 0]
        slope = None
        if len(points) > 1:
            mean = [sum(p[k] for p in points) / len(points) for k in (0, 1)]
            spread = sum((p[0] - mean[0]) ** 2 for p in points)
            slope = sum((p[0] - mean[0]) * (p[1] - mean[1]) for p in points) / spread if spread > 0 else None
        at = {row["accuracy"]: row["seconds"] for row in rows}
        ratio = at[0.01] / at[0.1] if 0.01 in at and 0.1 in at else None
        result.append({"engine": engine, "degree": degree, "slope": slope, "time_1_to_10_percent": ratio})
    return result


def advice(found, target):
    """Which setting to take, in a sentence."""
    def named(row):
        words = [f"--accuracy {100 * row['accuracy']:g}%"]
        words += [f"--engine {row['engine']}"] if row["engine"] != "auto" else []
        words += [f"--degree {row['degree']}"] if row["degree"] != "auto" else []
        return " ".join(words)

    good = [row for row in found if row["measured_error"] <= target]
    if not good:
        best = min(found, key=lambda row: row["measured_error"])
        return (f"No setting reaches the {100 * target:g} % that the scene asks for; the best, {named(best)}, is off by "
                f"{100 * best['measured_error']:.2g} % in {best['seconds']:.2g} s.")
    best = min(good, key=lambda row: row["seconds"])
    text = (f"Take {named(best)}: off by {100 * best['measured_error']:.2g} % (worst judged frame) where the scene asks for "
            f"{100 * target:g} %, in {best['seconds']:.2g} s.")
    finer = [row for row in found if row["measured_error"] < 0.5 * best["measured_error"]]
    if finer:
        next_one = min(finer, key=lambda row: row["seconds"])
        text += (f" {named(next_one)} would bring {100 * next_one['measured_error']:.2g} % for "
                 f"{next_one['seconds'] / best['seconds']:.1f} times the time.")
    if best["measured_error"] < best["reference_noise"]:
        text += f" Errors below {100 * best['reference_noise']:.2g} % are below the noise of the path tracing."
    return text
