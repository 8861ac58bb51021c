#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes furnished.obj and furnished.mtl: rooms in a row, joined by doorways, with furniture.

Living rooms (dining table with chairs, sofa, low table, shelf, lamp panels) and studies (desk, chair, shelves,
cartons) take turns; each has a window niche closed by its pane. Metres, z up, x along the row. Every piece is a union
of boxes, made on the grid of their corners, so that neighbours share vertices and no vertex lies inside an edge; all
faces are counter-clockwise seen from the air. The program checks that each surface is closed. Pieces stand on the
floor or on boards, or hang free. How many elements Kinelux makes of them follows from its option --element-size.
Needs nothing but Python; the same options give the same bytes.
"""

import argparse
import itertools
import pathlib
import random

HEIGHT, DEPTH = 2.7, 5.0                     # of every room [m]
LIVING, STUDY, WALL = 6.0, 4.0, 0.2          # lengths of the rooms and of the wall between them [m]
DOOR = ((1.0, 1.9), 2.1)                     # y range and height [m]
WINDOW = (1.6, 0.9, 2.2, 0.25)               # width, sill, head, depth of the niche [m]

MATERIALS = [("walls", 0.78, 0.76, 0.70), ("ceiling", 0.82, 0.82, 0.80), ("floor", 0.46, 0.34, 0.22),
             ("wood", 0.52, 0.36, 0.20), ("painted", 0.70, 0.72, 0.72), ("fabric", 0.20, 0.30, 0.42),
             ("carton", 0.55, 0.42, 0.28), ("red", 0.52, 0.14, 0.10), ("green", 0.16, 0.38, 0.20),
             ("pane", 0.10, 0.12, 0.14), ("lamp", 0.80, 0.80, 0.80)]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


class Box:
    """From low to high, of one material."""

    def __init__(self, x, y, z, material):
        self.low, self.high = tuple(zip(x, y, z))
        self.material = material

    def moved(self, place):
        corners = [place(corner) for corner in (self.low, self.high)]
        box = Box((0, 0), (0, 0), (0, 0), self.material)
        box.low = tuple(map(min, *corners))
        box.high = tuple(map(max, *corners))
        return box

    def contains(self, point):
        return all(a < p < b for a, p, b in zip(self.low, point, self.high))


class Surface:
    """Triangles by group, with vertices shared by position."""

    def __init__(self):
        self.points = []
        self.index = {}
        self.groups = {}

    def vertex(self, point):
        key = tuple(round(x * 1e6) for x in point)
        if key not in self.index:
            self.index[key] = len(self.points)
            self.points.append(tuple(k * 1e-6 for k in key))
        return self.index[key]

    def quad(self, group, corners):
        a, b, c, d = (self.vertex(corner) for corner in corners)
        self.groups.setdefault(group, []).extend([(a, b, c), (a, c, d)])

    def check(self, name):
        """Every edge is run along in both directions equally often: closed and oriented alike."""
        edges = {}
        for a, b in self.edges():
            edges[a, b] = edges.get((a, b), 0) + 1
        faulty = [edge for edge, count in edges.items() if edges.get(edge[::-1]) != count]
        if faulty:
            raise SystemExit(f"{name}: {len(faulty)} edges are open, e.g. at {self.points[faulty[0][0]]}")

    def edges(self):
        for faces in self.groups.values():
            for face in faces:
                yield from zip(face, face[1:] + face[:1])

    def volume(self):
        """Behind the faces [m3]: of the pieces, and less than nothing for rooms, whose faces look inwards."""
        total = 0.0
        for faces in self.groups.values():
            for face in faces:
                a, b, c = (self.points[corner] for corner in face)
                total += sum(p * q for p, q in zip(a, cross(b, c))) / 6
        return total


def cuts(boxes, axis):
    return sorted({round(x, 6) for box in boxes for x in (box.low[axis], box.high[axis])})


def union(boxes, facing=1, material_of=None):
    """The surface of a union of boxes; facing = 1 for outwards, -1 for a room seen from inside.

    material_of(box, point, axis, sign) names the material of a face at point with outward normal sign along axis;
    default: that of the first box that holds the cell behind the face.
    """
    grid = [cuts(boxes, axis) for axis in range(3)]
    size = [len(g) - 1 for g in grid]

    def middle(cell):
        return tuple((grid[axis][k] + grid[axis][k + 1]) / 2 for axis, k in enumerate(cell))

    owner = {}
    for cell in itertools.product(*map(range, size)):
        holder = next((box for box in boxes if box.contains(middle(cell))), None)
        if holder is not None:
            owner[cell] = holder

    surface = Surface()
    for cell, box in owner.items():
        for axis, sign in itertools.product(range(3), (-1, 1)):
            if tuple(k + sign * (axis == a) for a, k in enumerate(cell)) in owner:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            point = list(middle(cell))
            point[axis] = grid[axis][cell[axis] + (sign > 0)]
            corners = []
            for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(point)
                corner[u], corner[v] = grid[u][cell[u] + du], grid[v][cell[v] + dv]
                corners.append(corner)
            material = material_of(box, point, axis, sign) if material_of else box.material
            surface.quad(material, corners if sign * facing > 0 else corners[::-1])
    return surface


# ---- pieces: boxes about the origin, front towards -y, standing on z = 0

def table(length, width, height, leg=0.07, material="wood"):
    top, inset = 0.04, 0.04
    x, y = length / 2, width / 2
    boxes = [Box((-x, x), (-y, y), (height - top, height), material)]
    for sx, sy in itertools.product((-1, 1), (-1, 1)):
        ends_x = sorted((sx * (x - inset), sx * (x - inset - leg)))
        ends_y = sorted((sy * (y - inset), sy * (y - inset - leg)))
        boxes.append(Box(ends_x, ends_y, (0, height - top), material))
    for sy in (-1, 1):
        ends_y = sorted((sy * (y - inset), sy * (y - inset - 0.02)))
        boxes.append(Box((-x + inset + leg, x - inset - leg), ends_y, (height - top - 0.1, height - top), material))
    return boxes


def chair(material="wood"):
    side, seat, leg = 0.22, 0.46, 0.04
    boxes = [Box((-side, side), (-side, side), (seat - 0.04, seat), "fabric")]
    for sx in (-1, 1):
        ends_x = sorted((sx * side, sx * (side - leg)))
        boxes.append(Box(ends_x, (-side, -side + leg), (0, seat - 0.04), material))
        boxes.append(Box(ends_x, (side - leg, side), (0, seat - 0.04), material))
        boxes.append(Box(ends_x, (side - leg, side), (seat, 0.95), material))
    for low, high in ((0.62, 0.69), (0.80, 0.93)):
        boxes.append(Box((-side + leg, side - leg), (side - 0.03, side - 0.01), (low, high), material))
    return boxes


def shelf(length, height, boards):
    depth, side, board = 0.34, 0.03, 0.03
    x = length / 2
    boxes = [Box((-x, -x + side), (-depth / 2, depth / 2), (0, height), "painted"),
             Box((x - side, x), (-depth / 2, depth / 2), (0, height), "painted"),
             Box((-x + side, x - side), (depth / 2 - 0.02, depth / 2), (0, height), "painted")]
    pitch = (height - board) / boards
    for level in range(boards + 1):
        boxes.append(Box((-x + side, x - side), (-depth / 2, depth / 2 - 0.02),
                         (level * pitch, level * pitch + board), "painted"))
    return boxes


def shelf_loads(length, height, boards, detail, numbers):
    """What stands on the boards of shelf(): storage boxes one by one (detail 1), or runs of books (detail 2)."""
    loads, pitch = [], (height - 0.03) / boards
    for level in range(boards if detail > 0 else 0):
        x, z, run = 0.07 - length / 2, level * pitch + 0.03, []
        while True:
            width = numbers.uniform(0.2, 0.32) if detail == 1 else numbers.uniform(0.03, 0.07)
            if x + width > length / 2 - 0.07:
                break
            front = -0.17 + numbers.uniform(0.02, 0.08)
            top = z + (pitch - 0.03) * numbers.uniform(0.45, 0.85)
            material = numbers.choice(("carton", "red", "green", "fabric"))
            run.append(Box((x, x + width), (front, 0.10), (z, top), material))
            x += width
            if detail == 1 or numbers.random() < 0.3:
                loads.append(run)
                run = []
                x += numbers.uniform(0.05, 0.2)
        loads += [run] if run else []
    return loads


def sofa():
    boxes = [Box((-0.95, 0.95), (-0.4, 0.42), (0.12, 0.32), "fabric"),
             Box((-0.95, 0.95), (0.22, 0.42), (0.32, 0.85), "fabric")]
    for sign in (-1, 1):
        boxes.append(Box(sorted((sign * 0.95, sign * 0.77)), (-0.4, 0.22), (0.32, 0.6), "fabric"))
        boxes.append(Box(sorted((sign * 0.76, sign * 0.01)), (-0.42, 0.21), (0.32, 0.45), "fabric"))
        for y in (-0.36, 0.32):
            boxes.append(Box(sorted((sign * 0.9, sign * 0.84)), (y, y + 0.06), (0, 0.12), "wood"))
    return boxes


def cartons():
    return [Box((-0.35, 0.15), (-0.2, 0.2), (0, 0.4), "carton"), Box((0.2, 0.55), (-0.25, 0.1), (0, 0.3), "carton"),
            Box((-0.3, 0.05), (-0.15, 0.15), (0.4, 0.65), "carton")]


def cabinet():
    return [Box((-0.6, 0.6), (-0.2, 0.25), (0.08, 0.75), "wood"), Box((-0.55, 0.55), (-0.15, 0.2), (0, 0.08), "wood"),
            Box((-0.4, -0.1), (-0.1, 0.1), (0.75, 1.0), "red"), Box((0.15, 0.35), (-0.12, 0.08), (0.75, 0.9), "green")]


def panel():
    return [Box((-0.3, 0.3), (-0.3, 0.3), (0, 0.08), "lamp")]


# ---- rooms

def place(x, y, z=0.0, quarter_turns=0):
    turns = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter_turns % 4]
    return lambda p: (x + turns[0] * p[0] - turns[1] * p[1], y + turns[1] * p[0] + turns[0] * p[1], z + p[2])


def loaded_shelf(length, height, boards, where, detail, numbers):
    loads = shelf_loads(length, height, boards, detail, numbers)
    return [(shelf(length, height, boards), where)] + [(load, where) for load in loads]


def living_room(x, detail, numbers):
    pieces = [(table(1.8, 0.9, 0.75), place(x + 2.0, 3.2)), (table(1.1, 0.6, 0.42, 0.05), place(x + 4.3, 1.7)),
              (sofa(), place(x + 4.3, 0.65, 0, 2)), (cabinet(), place(x + 0.35, 3.3, 0, 1))]
    pieces += loaded_shelf(2.2, 2.0, 5, place(x + 4.4, 4.78), detail, numbers)
    for k in range(3):
        pieces.append((chair(), place(x + 1.4 + 0.6 * k, 3.85)))
        pieces.append((chair(), place(x + 1.4 + 0.6 * k, 2.55, 0, 2)))
    for lamp_x, lamp_y in ((2.0, 3.2), (4.3, 1.7)):
        pieces.append((panel(), place(x + lamp_x, lamp_y, 2.4)))
    return pieces


def study(x, detail, numbers):
    return [(table(1.6, 0.75, 0.74, 0.06), place(x + 2.3, 0.6)), (chair(), place(x + 2.2, 1.1)),
            (cartons(), place(x + 0.7, 4.4)), (panel(), place(x + 2.0, 2.5, 2.4)),
            *loaded_shelf(1.8, 2.2, 6, place(x + 2.8, 4.78), detail, numbers),
            *loaded_shelf(1.4, 1.2, 3, place(x + 3.78, 2.8, 0, 3), detail, numbers)]


def shell(lengths):
    """The air of all rooms, doorways and window niches, seen from inside."""
    air, x = [], 0.0
    for number, length in enumerate(lengths):
        air.append(Box((x, x + length), (0, DEPTH), (0, HEIGHT), "walls"))
        width, sill, head, depth = WINDOW
        centre = x + 0.68 * length
        air.append(Box((centre - width / 2, centre + width / 2), (-depth, 0), (sill, head), "walls"))
        if number + 1 < len(lengths):
            air.append(Box((x + length, x + length + WALL), *((DOOR[0], (0, DOOR[1]))), "walls"))
        x += length + WALL

    def material_of(_, point, axis, sign):
        if axis == 2 and point[2] in (0, HEIGHT):
            return "floor" if sign < 0 else "ceiling"
        return "pane" if axis == 1 and point[1] == -WINDOW[3] else "walls"

    return union(air, -1, material_of)


def furnished_rooms(rooms, detail):
    lengths = [(LIVING, STUDY)[k % 2] for k in range(rooms)]
    numbers = random.Random(7)
    surfaces, x = [shell(lengths)], 0.0
    for number, length in enumerate(lengths):
        for boxes, where in (living_room, study)[number % 2](x, detail, numbers):
            surfaces.append(union([box.moved(where) for box in boxes]))
        x += length + WALL
    return surfaces


def write(folder, surfaces):
    lines = ["# Written by generate.py. Metres, z up, x along the rooms.", "mtllib furnished.mtl"]
    first = [1]
    for surface in surfaces:
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*(x + 0.0 for x in point)) for point in surface.points]
        first.append(first[-1] + len(surface.points))
    for group, *_ in MATERIALS:
        faces = [tuple(start + corner for corner in face) for start, surface in zip(first, surfaces)
                 for face in surface.groups.get(group, [])]
        lines += [f"g {group}", f"usemtl {group}"] + ["f {} {} {}".format(*face) for face in faces]
    materials = ["# Written by generate.py. Colours for viewers; furnished.toml states the reflectances."]
    for name, *colour in MATERIALS:
        materials += [f"newmtl {name}", "Kd {} {} {}".format(*colour)]
    (folder / "furnished.mtl").write_text("\n".join(materials) + "\n", encoding="ascii")
    (folder / "furnished.obj").write_text("\n".join(lines) + "\n", encoding="ascii")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    here = pathlib.Path(__file__).parent
    parser.add_argument("--output", type=pathlib.Path, default=here,
                        help="folder for furnished.obj and furnished.mtl (default: beside this script)")
    parser.add_argument("--rooms", type=int, default=2, help="living rooms and studies in turn (default 2)")
    parser.add_argument("--detail", type=int, default=1, choices=(0, 1, 2),
                        help="on the shelves: 0 nothing, 1 storage boxes, 2 books (default 1)")
    options = parser.parse_args()
    if options.rooms < 1:
        parser.error("at least one room")

    surfaces = furnished_rooms(options.rooms, options.detail)
    for number, surface in enumerate(surfaces):
        surface.check("the rooms" if number == 0 else f"piece {number}")
        if (surface.volume() < 0) != (number == 0):
            raise SystemExit(f"piece {number} is inside out")
    options.output.mkdir(parents=True, exist_ok=True)
    write(options.output, surfaces)
    triangles = sum(len(faces) for surface in surfaces for faces in surface.groups.values())
    print(f"{options.output / 'furnished.obj'}: {triangles} triangles, {len(surfaces) - 1} pieces, "
          f"{-surfaces[0].volume() - sum(s.volume() for s in surfaces[1:]):.1f} m3 of air")


if __name__ == "__main__":
    main()
