# SPDX-License-Identifier: GPL-3.0-or-later
"""The plots of a study, as PNG files. None are drawn without python3-matplotlib."""

import sys

import picture

STAGE_COLOURS = {"clean": "#bbbbbb", "fit": "#999999", "cluster": "#66aa77", "plan": "#ccbb44", "coefficients": "#4477aa",
                 "solve": "#ee6677", "export": "#aa3377"}


def draw(study, folder):
    """@return  {title: file name} of what was drawn, in order"""
    pictures = {}
    scene = picture_of_scene(study, folder)
    if scene:
        pictures["The scene, at the finest setting that was run"] = scene
    try:
        import matplotlib
    except ImportError:
        print("kinelux-study: warning: no plots, python3-matplotlib is not installed", file=sys.stderr)
        return pictures
    matplotlib.use("Agg")
    from matplotlib import pyplot

    def save(figure, name):
        figure.savefig(folder / name, dpi=120)
        pyplot.close(figure)
        return name

    pictures["Error against time"] = save(error_against_time(pyplot, study), "error_against_time.png")
    pictures["Where the time goes"] = save(time_per_stage(pyplot, study), "time_per_stage.png")
    if max(row["frames"] for row in study["rows"]) > 1:
        pictures["Error against frame"] = save(error_against_frame(pyplot, study), "error_against_frame.png")
    return pictures


def name_of(row):
    """Its accuracy, and what else was asked for."""
    return f"{100 * row['accuracy']:g} %" + "".join(f" {row[key]}" for key in ("engine", "degree") if row[key] != "auto")


def groups(study):
    """Rows of one engine and degree each, with a name."""
    found = {}
    for row in study["rows"]:
        found.setdefault((row["engine"], row["degree"]), []).append(row)
    several = len(found) > 1
    return [(f"engine {e}, degree {d}" if several else "measured", rows) for (e, d), rows in found.items()]


def error_against_time(pyplot, study):
    figure, axes = pyplot.subplots(figsize=(7, 4.8), layout="constrained")
    for name, rows in groups(study):
        seconds = [row["seconds"] for row in rows]
        line, = axes.loglog(seconds, [100 * row["measured_error"] for row in rows], "o-", label=name)
        axes.loglog(seconds, [100 * row["estimated_error"] for row in rows], "o:", mfc="none", color=line.get_color(),
                    label="estimated" if name == "measured" else None, linewidth=1)
        for row in rows:
            axes.annotate(f"{100 * row['accuracy']:g} %", (row["seconds"], 100 * row["measured_error"]),
                          textcoords="offset points", xytext=(5, 4), fontsize=8)
    front = sorted((row["seconds"], 100 * row["measured_error"]) for row in study["rows"] if row["pareto"])
    if len(front) > 1:
        axes.step(*zip(*front), where="post", color="#999999", linewidth=1, label="best for the time")
    axes.axhline(100 * study["reference"]["noise"], color="#cccccc", linestyle="--", linewidth=1,
                 label="noise of the path tracing")
    slope = study["slopes"][0]["slope"]
    axes.set_title(study["title"] + (f": time grows like error^{slope:.2f}" if slope is not None else ""))
    axes.set_xlabel("time of all stages [s]")
    axes.set_ylabel("error of irradiance, worst judged frame [%]")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    return figure


def time_per_stage(pyplot, study):
    rows = study["rows"]
    figure, axes = pyplot.subplots(figsize=(7, 0.8 + 0.42 * len(rows)), layout="constrained")
    names = [name_of(row) for row in rows]
    left = [0.0] * len(rows)
    for stage, colour in STAGE_COLOURS.items():
        share = [100 * row["stages"].get(stage, {}).get("seconds", 0.0) / row["seconds"] for row in rows]
        axes.barh(range(len(rows)), share, left=left, color=colour, label=stage)
        left = [a + b for a, b in zip(left, share)]
    axes.set_yticks(range(len(rows)), [f"{name}: {row['seconds']:.2g} s" for name, row in zip(names, rows)])
    axes.invert_yaxis()
    axes.set_xlabel("share of the time [%]")
    axes.legend(fontsize=8, ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure


def error_against_frame(pyplot, study):
    figure, axes = pyplot.subplots(figsize=(7, 4), layout="constrained")
    for row in study["rows"]:
        frames = row["frame_errors"]
        line, = axes.semilogy([f["frame"] for f in frames], [100 * f["estimated"] for f in frames], ":", linewidth=1)
        judged = [f for f in frames if f["measured"] is not None]
        axes.semilogy([f["frame"] for f in judged], [100 * f["measured"] for f in judged], "o-", color=line.get_color(),
                      label=name_of(row))
    axes.set_xlabel("frame")
    axes.set_ylabel("error [%]: dots measured, dotted line estimated")
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    return figure


def picture_of_scene(study, folder):
    """Drawn by pvbatch where there is one; $KINELUX_PVBATCH names another."""
    finest = study["rows"][-1]
    name = f"{finest['engine']}-degree-{finest['degree']}-{100 * finest['accuracy']:g}"
    case = folder / "cases" / f"{name}.case"
    frames = study["reference"]["frames"]
    shown = frames[len(frames) // 2] - frames[0]  # view.py counts from the first one exported
    reason = picture.draw(case, folder / "scene.png", shown, "960x720")
    if reason is None:
        return "scene.png"
    print(f"kinelux-study: warning: no picture of the scene, {reason}", file=sys.stderr)
    return None
