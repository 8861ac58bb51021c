#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes round.obj: a room with a column, a ring, a bowl and a ball, each a fine mesh of one round surface.

Metres, z up; faces are counter-clockwise seen from the air; groups are named after the bodies. Needs nothing but Python;
the same options give the same bytes.
"""

import argparse
import math
import pathlib

BOX_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def room(size):
    """The six faces of a box from the origin, seen from inside."""
    corners = [tuple(size[axis] * ((k >> axis) & 1) for axis in range(3)) for k in range(8)]
    return [[corners[k] for k in face][::-1] for face in BOX_FACES]


def panel(corner, u, v):
    """A parallelogram; its front is where u x v points."""
    return [[corner, tuple(map(sum, zip(corner, u))), tuple(map(sum, zip(corner, u, v))),
             tuple(map(sum, zip(corner, v)))]]


def turned(profile, around, foot):
    """The surface of a profile, points (distance from the axis, height) from bottom to top, turned about a vertical axis."""
    def point(i, k):
        distance, height = profile[k]
        angle = 2 * math.pi * (i % around) / around
        return (foot[0] + distance * math.cos(angle), foot[1] + distance * math.sin(angle), foot[2] + height)

    faces = []
    for k in range(len(profile) - 1):
        for i in range(around):
            face = [point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)]
            faces.append([p for n, p in enumerate(face) if p not in face[:n]])
    return faces


def arc(radius, distance, first, last, steps):
    """A profile: a circle of a radius about a point at a distance from the axis, from an angle to another [turns]."""
    angles = [2 * math.pi * (first + (last - first) * k / steps) for k in range(steps + 1)]
    points = [(distance + radius * math.cos(a), radius * math.sin(a)) for a in angles]
    return [(0.0 if abs(d) < 1e-12 else d, h) for d, h in points]


def bodies(steps):
    yield "room", room((4, 3, 2.5))
    yield "column", turned([(0.2, 0), (0.2, 2.5)], steps, (2.2, 2.2, 0))
    yield "ring", turned(arc(0.15, 0.5, 0, 1, steps // 2), steps, (2.8, 1.2, 0.6))
    yield "bowl", turned(arc(0.4, 0, -0.25, 0, steps // 4), steps, (3.2, 2.3, 1.0))
    yield "ball", turned(arc(0.4, 0, -0.25, 0.25, steps // 2), steps, (0.7, 0.7, 0.41))
    yield "lamp", panel((1.5, 1, 2.45), (0, 0.8, 0), (0.8, 0, 0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=48, help="faces around each axis, a multiple of 4 (default 48)")
    parser.add_argument("-o", "--output", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parent / "round.obj")
    arguments = parser.parse_args()
    lines, index = [], {}
    for name, faces in bodies(arguments.steps):
        lines.append(f"g {name}")
        for face in faces:
            corners = []
            for point in face:
                key = name, "{:.9g} {:.9g} {:.9g}".format(*(c + 0.0 for c in point))
                if key not in index:
                    index[key] = len(index) + 1
                    lines.append("v " + key[1])
                corners.append(index[key])
            lines.append("f " + " ".join(map(str, corners)))
    arguments.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
