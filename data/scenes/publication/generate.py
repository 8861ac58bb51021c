#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes publication.obj: the bodies of simple.toml, rotation.toml and billiard.toml.

Scenes in the kind of those of Biri, Michelin, Arques (WSCG 2003), whose data are lost: two panels that move before a
lamp, a lamp that turns, a billiard table under a lamp that moves. (The fourth, the cathedral, has a folder of its own.)
Metres, z up; faces are counter-clockwise seen from the air; groups are named <scene>_<body>. Needs nothing but Python;
the same options give the same bytes.
"""

import argparse
import math
import pathlib

BOX_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box(low, high, inwards=False):
    """The six faces of a box, seen from outside or, as a room, from inside."""
    corners = [tuple((low, high)[(k >> axis) & 1][axis] for axis in range(3)) for k in range(8)]
    faces = [[corners[k] for k in face] for face in BOX_FACES]
    return [face[::-1] for face in faces] if inwards else faces


def panel(corner, u, v):
    """A parallelogram; its front is where u x v points."""
    return [[corner, tuple(map(sum, zip(corner, u))), tuple(map(sum, zip(corner, u, v))),
             tuple(map(sum, zip(corner, v)))]]


def ball(centre, radius, rings):
    """A sphere of `rings` rings with twice as many faces each."""
    def point(ring, turn):
        polar, angle = math.pi * ring / rings, math.pi * turn / rings
        return (centre[0] + radius * math.sin(polar) * math.cos(angle),
                centre[1] + radius * math.sin(polar) * math.sin(angle), centre[2] + radius * math.cos(polar))

    faces = []
    for ring in range(rings):
        for turn in range(2 * rings):
            after = (turn + 1) % (2 * rings)
            face = [point(ring, turn), point(ring + 1, turn), point(ring + 1, after), point(ring, after)]
            if ring == 0:
                face = [point(0, 0), *face[1:3]]
            elif ring == rings - 1:
                face = [face[0], point(rings, 0), face[3]]
            faces.append(face)
    return faces


def simple():
    yield "simple_room", box((0, 0, 0), (4, 4, 3), inwards=True)
    yield "simple_plinth", box((2.9, 2.8, 0), (3.6, 3.5, 1.2))
    yield "simple_step", box((0.4, 0.3, 0), (1.4, 1.5, 0.4))
    yield "simple_lamp", panel((1.6, 1.6, 2.97), (0, 0.8, 0), (0.8, 0, 0))
    yield "simple_blue", panel((0.1, 1.5, 2.7), (1.2, 0, 0), (0, 1.0, 0))
    yield "simple_white", panel((2.0, 0.4, 0.6), (0, 1.2, 0), (0, 0, 1.4))


def rotation():
    yield "rotation_room", box((0, 0, 0), (5, 4, 3), inwards=True)
    for k, (x, y) in enumerate(((1.0, 0.9), (3.7, 0.9), (1.0, 2.8), (3.7, 2.8))):
        yield f"rotation_pillar{k + 1}", box((x, y, 0), (x + 0.3, y + 0.3, 2.2))
    yield "rotation_lamp", panel((2.5, 1.6, 1.3), (0, 0.8, 0), (0, 0, 0.8))


def billiard(rings):
    yield "billiard_room", box((0, 0, 0), (6, 5, 3), inwards=True)
    yield "billiard_bed", box((1.7, 1.85, 0.75), (4.3, 3.15, 0.8))
    for k, (low, high) in enumerate((((1.7, 1.75, 0.72), (4.3, 1.85, 0.85)), ((1.7, 3.15, 0.72), (4.3, 3.25, 0.85)),
                                     ((1.6, 1.75, 0.72), (1.7, 3.25, 0.85)), ((4.3, 1.75, 0.72), (4.4, 3.25, 0.85)))):
        yield f"billiard_rail{k + 1}", box(low, high)
    for k, (x, y) in enumerate(((1.7, 1.85), (4.1, 1.85), (1.7, 2.95), (4.1, 2.95))):
        yield f"billiard_leg{k + 1}", box((x, y, 0), (x + 0.2, y + 0.2, 0.75))
    for name, x, y in (("white", 2.2, 2.3), ("yellow", 3.1, 2.75), ("red", 3.7, 2.2)):
        yield f"billiard_{name}", ball((x, y, 0.91), 0.1, rings)
    yield "billiard_lamp", panel((1.9, 2.3, 1.9), (0, 0.4, 0), (0.8, 0, 0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rings", type=int, default=16, help="of faces on a billiard ball (default 16)")
    parser.add_argument("-o", "--output", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parent / "publication.obj")
    arguments = parser.parse_args()
    lines, index = [], {}
    for name, faces in (*simple(), *rotation(), *billiard(arguments.rings)):
        lines.append(f"g {name}")
        for face in faces:
            for point in face:
                if (name, point) not in index:
                    index[name, point] = len(index) + 1
                    lines.append("v {:.9g} {:.9g} {:.9g}".format(*point))
            lines.append("f " + " ".join(str(index[name, point]) for point in face))
    arguments.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
