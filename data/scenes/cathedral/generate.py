#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes cathedral.obj and cathedral.mtl: the inside of a church as one closed surface.

A nave under a barrel vault with transverse ribs, between two rows of round columns that carry semicircular arches; an
aisle under its own barrel vault on either side; recessed windows, closed by their panes. Metres, z up, y along the
nave. All faces are counter-clockwise seen from the air inside, neighbours share their vertices, and no vertex lies
inside an edge of another face: the program checks both before it writes. A lamp hangs in the nave as a group of its
own. Needs nothing but Python; the same options give the same bytes.
"""

import argparse
import math
import pathlib


def subtract(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def mean(points):
    return tuple(sum(p[axis] for p in points) / len(points) for axis in range(3))


def spread(start, end, count):
    """count + 1 numbers from start to end."""
    return [start + (end - start) * i / count for i in range(count + 1)]


class Surface:
    """Triangles by group, with vertices shared by position."""

    def __init__(self):
        self.points = []
        self.index = {}
        self.groups = {}

    def vertex(self, point):
        key = tuple(round(x * 1e7) for x in point)
        if key not in self.index:
            self.index[key] = len(self.points)
            self.points.append(point)
        return self.index[key]

    def triangle(self, group, a, b, c, towards):
        """towards: a direction into the air that the front must not turn away from. No area: nothing is added."""
        corners = [self.vertex(p) for p in (a, b, c)]
        if len(set(corners)) < 3:
            return
        normal = cross(subtract(b, a), subtract(c, a))
        if dot(normal, towards) < 0:
            corners.reverse()
        self.groups.setdefault(group, []).append(tuple(corners))

    def quad(self, group, a, b, c, d, towards):
        self.triangle(group, a, b, c, towards)
        self.triangle(group, a, c, d, towards)

    def grid(self, group, rows, towards, shifted=None, mask=None, shifted_group=None):
        """Quads between rows of points; towards(centre) gives the direction into the air.

        Cells with mask(i, j) use the points of `shifted` instead, joined to their neighbours by side walls.
        """
        height, width = len(rows) - 1, len(rows[0]) - 1

        def masked(i, j):
            return mask is not None and 0 <= i < height and 0 <= j < width and mask(i, j)

        for i in range(height):
            for j in range(width):
                here = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
                base = [rows[k][m] for k, m in here]
                if not masked(i, j):
                    self.quad(group, *base, towards(mean(base)))
                    continue
                top = [shifted[k][m] for k, m in here]
                self.quad(shifted_group, *top, towards(mean(top)))
                outward = dot(subtract(mean(top), mean(base)), towards(mean(base))) > 0  # a rib, not a recess
                for side, (di, dj) in enumerate([(-1, 0), (0, 1), (1, 0), (0, -1)]):
                    if masked(i + di, j + dj):
                        continue
                    following = (side + 1) % 4
                    wall = [base[side], base[following], top[following], top[side]]
                    inward = subtract(mean(base + top), mean(wall))
                    self.quad(group if not outward else shifted_group, *wall,
                              tuple(-x for x in inward) if outward else inward)

    def check(self):
        """Every edge belongs to two faces that run along it in opposite directions: closed and oriented alike."""
        edges = {}
        for faces in self.groups.values():
            for face in faces:
                for a, b in zip(face, face[1:] + face[:1]):
                    edges[a, b] = edges.get((a, b), 0) + 1
        faulty = [edge for edge, count in edges.items() if count != 1 or edges.get(edge[::-1]) != 1]
        if faulty:
            places = ", ".join(str(mean([self.points[a], self.points[b]])) for a, b in faulty[:5])
            raise SystemExit(f"{len(faulty)} edges are not shared by exactly two faces, e.g. at {places}")

    def air_volume(self):
        """Volume in front of the faces [m3]: negative where the surface is seen from outside."""
        total = 0.0
        for faces in self.groups.values():
            for a, b, c in faces:
                total -= dot(self.points[a], cross(self.points[b], self.points[c])) / 6
        return total


class Church:
    """The measures that follow from the options [m]."""

    def __init__(self, options):
        self.bays = options.bays
        self.arch_segments = options.arch_segments
        self.sides = options.column_sides
        self.pier = options.pier
        self.cells = self.sides // 4            # of a pier's side: as many as columns have corners on it
        self.nave = options.nave_width / 2      # from the axis to the arcade wall
        self.aisle_inner = self.nave + self.pier
        self.outer = self.aisle_inner + options.aisle_width
        self.arch_radius = (options.bay_length - self.pier) / 2
        self.capital_top = options.column_height
        self.cornice = self.capital_top + self.arch_radius + 0.5    # where the aisle vaults spring
        self.springing = self.cornice + options.clerestory_height   # where the nave vault springs
        self.aisle_radius = options.aisle_width / 2
        self.nave_cells = options.nave_cells
        self.aisle_cells = options.aisle_cells
        self.length = self.bays * options.bay_length    # half a pier stands at either end
        self.columns_y = [bay * options.bay_length for bay in range(1, self.bays)]
        self.stations()

    def stations(self):
        """y of every column of vertices, with the height of the arch there and which pier or bay follows."""
        half = self.pier / 2
        bay_length = 2 * (self.arch_radius + half)
        self.y, self.z_low, self.kind = [0.0], [0.0], []

        def append(y, z, kind):
            self.y.append(y)
            self.z_low.append(z)
            self.kind.append(kind)

        def pier(start, end, number):
            for y in spread(start, end, self.cells if number not in (0, self.bays) else self.cells // 2)[1:]:
                append(y, self.capital_top, ("pier", number))

        pier(0.0, half, 0)
        for bay in range(self.bays):
            centre = (bay + 0.5) * bay_length
            for k in range(1, self.arch_segments + 1):
                angle = math.pi * k / self.arch_segments
                rise = self.arch_radius * math.sin(angle) if k < self.arch_segments else 0.0
                append(centre - self.arch_radius * math.cos(angle), self.capital_top + rise, ("arch", bay))
            end = (bay + 1) * bay_length
            pier(end - half, end + (half if bay + 1 < self.bays else 0.0), bay + 1)
        self.z_low[0] = self.capital_top


def arc(radius, count, centre_x, z):
    """Half a circle from x = centre - radius to centre + radius, upwards."""
    points = []
    for k in range(count + 1):
        angle = math.pi * (1 - k / count)
        rise = radius * math.sin(angle) if 0 < k < count else 0.0
        points.append((centre_x + radius * math.cos(angle), z + rise))
    return points


LOW_ROWS, ARCH_ROWS, CLERESTORY_ROWS = 4, 2, 3  # of the walls: floor - capital - cornice - springing


def build_arcade(surface, church, side):
    """One arcade wall with its arches, end piers and clerestory; side = -1 or 1."""
    inner, outer = side * church.nave, side * church.aisle_inner
    last = len(church.y) - 1

    def wall(x, direction, rows_above):
        above = []
        for j, y in enumerate(church.y):
            above.append([(x, y, z) for z in spread(church.z_low[j], church.cornice, ARCH_ROWS)] +
                         [(x, y, z) for z in rows_above])
        rows = [list(row) for row in zip(*above)]
        return rows, lambda _: (direction, 0, 0)

    clerestory = spread(church.cornice, church.springing, CLERESTORY_ROWS)[1:]
    rows, towards = wall(inner, -side, clerestory)
    recess = [[add(p, (side * 0.4, 0, 0)) for p in row] for row in rows]
    quarter = church.arch_segments // 4

    def is_window(i, j):
        if i != ARCH_ROWS + 1 or church.kind[j][0] != "arch":
            return False
        first = church.kind.index(church.kind[j])
        return quarter <= j - first < church.arch_segments - quarter

    surface.grid("walls", rows, towards, recess, is_window, "windows")
    rows, towards = wall(outer, side, [])
    surface.grid("walls", rows, towards)

    # Soffits of the arches, and end piers from the floor to the capital height.
    across = spread(inner, outer, church.cells)
    for j, kind in enumerate(church.kind):
        if kind[0] == "arch":
            rows = [[(x, church.y[k], church.z_low[k]) for x in across] for k in (j, j + 1)]
            centre = (mean([p for row in rows for p in row])[0], (kind[1] + 0.5) * church.length / church.bays,
                      church.capital_top)
            surface.grid("arches", rows, lambda c, centre=centre: subtract(centre, c))
    low = spread(0.0, church.capital_top, LOW_ROWS)
    for number, inwards in ((0, 1), (church.bays, -1)):
        stations = sorted({k for j, kind in enumerate(church.kind) if kind == ("pier", number) for k in (j, j + 1)})
        face = stations[-1] if number == 0 else stations[0]
        for x, direction in ((inner, -side), (outer, side)):
            surface.grid("walls", [[(x, church.y[k], z) for k in stations] for z in low],
                         lambda _, d=direction: (d, 0, 0))
        surface.grid("walls", [[(x, church.y[face], z) for x in across] for z in low],
                     lambda _, d=inwards: (0, d, 0))
    assert last == len(church.kind)


def build_vaults(surface, church):
    profile = arc(church.nave, church.nave_cells, 0.0, church.springing)
    rows = [[(x, y, z) for y in church.y] for x, z in profile]
    ribs = []
    for x, z in profile:
        scale = (church.nave - 0.25) / church.nave
        ribs.append([(x * scale, y, church.springing + (z - church.springing) * scale) for y in church.y])
    inside = {("pier", number) for number in range(1, church.bays)}
    surface.grid("vaults", rows, lambda c: (-c[0], 0, church.springing - c[2]), ribs,
                 lambda i, j: church.kind[j] in inside, "ribs")
    for side in (-1, 1):
        centre = side * (church.aisle_inner + church.aisle_radius)
        rows = [[(x, y, z) for y in church.y]
                for x, z in arc(church.aisle_radius, church.aisle_cells, centre, church.cornice)]
        surface.grid("vaults", rows, lambda c, centre=centre: (centre - c[0], 0, church.cornice - c[2]))


def low_heights(church):
    return spread(0.0, church.capital_top, LOW_ROWS)


def build_outer_walls(surface, church):
    """Long walls with a window in each bay, and both end walls with their half discs under the vaults."""
    z_arch = spread(church.capital_top, church.cornice, ARCH_ROWS)[1:]
    heights = low_heights(church) + z_arch
    quarter = church.arch_segments // 4

    def is_window(i, j):
        if i not in (LOW_ROWS - 2, LOW_ROWS - 1, LOW_ROWS) or church.kind[j][0] != "arch":
            return False
        first = church.kind.index(church.kind[j])
        return quarter <= j - first < church.arch_segments - quarter

    for side in (-1, 1):
        rows = [[(side * church.outer, y, z) for y in church.y] for z in heights]
        recess = [[add(p, (side * 0.4, 0, 0)) for p in row] for row in rows]
        surface.grid("walls", rows, lambda _, side=side: (-side, 0, 0), recess, is_window, "windows")

    clerestory = spread(church.cornice, church.springing, CLERESTORY_ROWS)[1:]
    parts = [(-church.nave, church.nave, church.nave_cells, heights + clerestory)]
    for side in (-1, 1):
        ends = sorted((side * church.aisle_inner, side * church.outer))
        parts.append((*ends, church.aisle_cells, heights))
    for y, inwards in ((0.0, 1), (church.length, -1)):
        for left, right, cells, levels in parts:
            xs = spread(left, right, cells)
            rows = [[(x, y, z) for x in xs] for z in levels]
            half_disc = arc((right - left) / 2, cells, (left + right) / 2, levels[-1])
            surface.grid("walls", rows + [[(x, y, z) for x, z in half_disc]], lambda _, d=inwards: (0, d, 0))


def build_floor(surface, church):
    """One grid over the whole ground plan; where plinths and end piers stand it has holes."""
    strips = [(-church.outer, -church.aisle_inner, church.aisle_cells, False),
              (-church.aisle_inner, -church.nave, church.cells, True),
              (-church.nave, church.nave, church.nave_cells, False),
              (church.nave, church.aisle_inner, church.cells, True),
              (church.aisle_inner, church.outer, church.aisle_cells, False)]
    for left, right, cells, arcade in strips:
        xs = spread(left, right, cells)
        for j, kind in enumerate(church.kind):
            if arcade and kind[0] == "pier":
                continue
            surface.grid("floor", [[(x, church.y[k], 0.0) for x in xs] for k in (j, j + 1)], lambda _: (0, 0, 1))


def build_column(surface, church, x, y):
    """Plinth, round base, shaft and capital, abacus; the arcade wall stands on the abacus."""
    half, cells, count = church.pier / 2, church.cells, church.sides
    side = spread(-half, half, cells)
    square = ([(half, s) for s in side[:-1]] + [(-s, half) for s in side[:-1]] +
              [(-half, -s) for s in side[:-1]] + [(s, -half) for s in side[:-1]])
    start = -math.pi / 4  # the circle's corner k lies towards the square's corner k
    circle = [(math.cos(start + 2 * math.pi * k / count), math.sin(start + 2 * math.pi * k / count))
              for k in range(count)]

    def ring(outline, radius, z):
        closed = outline + outline[:1]
        return [(x + radius * px, y + radius * py, z) for px, py in closed]

    def radially(c):
        return (c[0] - x, c[1] - y, 0)

    top = church.capital_top
    plinth, abacus = 0.35, top - 0.3
    shaft = half * 0.62
    base = [(0.93 * half, plinth), (0.97 * half, plinth + 0.09), (0.9 * half, plinth + 0.2),
            (1.12 * shaft, plinth + 0.26), (shaft, plinth + 0.4)]
    neck = [(0.93 * shaft, abacus - 0.75), (1.08 * shaft, abacus - 0.68), (0.97 * shaft, abacus - 0.6),
            (1.1 * shaft, abacus - 0.35), (0.93 * half, abacus)]
    shaft_rings = [(shaft * (1 - 0.035 * k), plinth + 0.4 + (abacus - 1.15 - plinth) * k / 2) for k in (1,)]
    surface.grid("columns", [ring(square, 1, 0.0), ring(square, 1, plinth)], radially)
    surface.grid("columns", [ring(square, 1, plinth), ring(circle, base[0][0], plinth)], lambda _: (0, 0, 1))
    surface.grid("columns", [ring(circle, r, z) for r, z in base + shaft_rings + neck], radially)
    surface.grid("columns", [ring(circle, neck[-1][0], abacus), ring(square, 1, abacus)], lambda _: (0, 0, -1))
    surface.grid("columns", [ring(square, 1, abacus), ring(square, 1, top)], radially)


def lamp(centre, size):
    """A closed box, its faces outwards."""
    surface = Surface()
    half = [s / 2 for s in size]
    for axis in range(3):
        for sign in (-1, 1):
            corners = []
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = list(centre)
                corner[axis] += sign * half[axis]
                corner[(axis + 1) % 3] += u * half[(axis + 1) % 3]
                corner[(axis + 2) % 3] += v * half[(axis + 2) % 3]
                corners.append(tuple(corner))
            surface.quad("lamp", *corners, subtract(mean(corners), centre))
    return surface


MATERIALS = [  # name, colour for viewers; the scene file states the reflectances
    ("floor", 0.45, 0.42, 0.38), ("walls", 0.68, 0.64, 0.56), ("arches", 0.72, 0.67, 0.57),
    ("columns", 0.62, 0.57, 0.49), ("vaults", 0.75, 0.72, 0.66), ("ribs", 0.66, 0.60, 0.50),
    ("windows", 0.12, 0.14, 0.20), ("lamp", 0.80, 0.80, 0.80)]


def write(folder, surfaces):
    lines = ["# Written by generate.py. Metres, z up, y along the nave.", "mtllib cathedral.mtl"]
    first = 1
    for surface in surfaces:
        lines += ["v {:.9g} {:.9g} {:.9g}".format(*(x + 0.0 for x in point)) for point in surface.points]
        for group, faces in surface.groups.items():
            lines += [f"g {group}", f"usemtl {group}"]
            lines += ["f {} {} {}".format(*(first + corner for corner in face)) for face in faces]
        first += len(surface.points)
    materials = ["# Written by generate.py. Colours for viewers; cathedral.toml states the reflectances."]
    for name, *colour in MATERIALS:
        materials += [f"newmtl {name}", "Kd {} {} {}".format(*colour)]
    (folder / "cathedral.mtl").write_text("\n".join(materials) + "\n", encoding="ascii")
    (folder / "cathedral.obj").write_text("\n".join(lines) + "\n", encoding="ascii")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path(__file__).parent,
                        help="folder for cathedral.obj and cathedral.mtl (default: beside this script)")
    parser.add_argument("--bays", type=int, default=5, help="arches in a row (default 5)")
    parser.add_argument("--bay-length", type=float, default=5.0, help="from column to column [m] (default 5)")
    parser.add_argument("--pier", type=float, default=1.2, help="side of plinth and arcade wall [m] (default 1.2)")
    parser.add_argument("--nave-width", type=float, default=7.8, help="between the arcade walls [m] (default 7.8)")
    parser.add_argument("--aisle-width", type=float, default=3.4, help="of each aisle [m] (default 3.4)")
    parser.add_argument("--column-height", type=float, default=5.0, help="floor to arch springing [m] (default 5)")
    parser.add_argument("--clerestory-height", type=float, default=3.0, help="above the cornice [m] (default 3)")
    parser.add_argument("--column-sides", type=int, default=16, help="a multiple of 8, 16 or more (default 16)")
    parser.add_argument("--arch-segments", type=int, default=8, help="a multiple of 4 (default 8)")
    parser.add_argument("--nave-cells", type=int, default=10, help="segments of the nave vault (default 10)")
    parser.add_argument("--aisle-cells", type=int, default=4, help="segments of an aisle vault (default 4)")
    options = parser.parse_args()
    if options.column_sides < 16 or options.column_sides % 8 or options.arch_segments % 4 or options.bays < 1:
        parser.error("column sides must be a multiple of 8 from 16 on, arch segments a multiple of 4, bays at least 1")
    if options.bay_length <= options.pier or options.column_height < 2.5:
        parser.error("bays must be longer than piers, columns at least 2.5 m high")

    church = Church(options)
    building = Surface()
    build_floor(building, church)
    for side in (-1, 1):
        build_arcade(building, church, side)
    build_vaults(building, church)
    build_outer_walls(building, church)
    for side in (-1, 1):
        for y in church.columns_y:
            build_column(building, church, side * (church.nave + church.pier / 2), y)
    building.check()
    hanging = lamp((0.0, church.length / 10, church.capital_top + 1.5), (0.8, 0.8, 0.16))
    hanging.check()
    write(options.output, [building, hanging])
    triangles = sum(len(faces) for surface in (building, hanging) for faces in surface.groups.values())
    print(f"{options.output / 'cathedral.obj'}: {triangles} triangles, {church.length:g} m long, "
          f"{building.air_volume():.0f} m3 of air")


if __name__ == "__main__":
    main()
