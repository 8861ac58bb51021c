# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes that the tests of the executables are run on, written as OBJ and TOML."""

import pathlib


def box_faces(low, high, inwards):
    """Corners and quadrilaterals of an axis-parallel box."""
    points = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    outwards = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, [tuple(reversed(face)) if inwards else face for face in outwards]


class Obj:
    """An OBJ file that grows by groups."""

    def __init__(self):
        self.lines, self.count = [], 0

    def group(self, name, points, faces):
        self.lines += [f"v {x} {y} {z}" for x, y, z in points] + [f"g {name}"]
        self.lines += ["f " + " ".join(str(i + 1 + self.count) for i in face) for face in faces]
        self.count += len(points)
        return self

    def write(self, file):
        pathlib.Path(file).write_text("\n".join(self.lines) + "\n", encoding="utf-8")


def lamp(low, high, z):
    """A rectangle that faces down."""
    return [(low[0], low[1], z), (low[0], high[1], z), (high[0], high[1], z), (high[0], low[1], z)], [(0, 1, 2, 3)]


def furnished_room(place):
    """A closed room with a table and a screen as one mesh. @param place  maps a point"""
    obj = Obj()
    for name, low, high, inwards in (("room", (0, 0, 0), (4, 5, 2.5), True), ("table", (1, 1, 0.5), (2, 2, 0.75), False),
                                     ("screen", (2.5, 2, 0.25), (2.75, 4, 2), False)):
        points, faces = box_faces(low, high, inwards)
        obj.group(name, [place(*point) for point in points], faces)
    return obj


ROOM = """format = 1
[scene]
title = "test room"
length_unit = "m"
up_axis = "z"
quantity = "{quantity}"
channels = ["red", "blue"]
[accuracy]
target = "{target}"
element_size = 0.5
[time]
start_s = 0.0
end_s = {end_s}
frames = {frames}
[[material]]
name = "wall"
reflectance = [0.7, 0.4]
[[material]]
name = "source"
reflectance = 0.0
[[object]]
name = "room"
mesh = "room.obj"
group = "room"
material = "wall"
[[object]]
name = "block"
mesh = "room.obj"
group = "block"
material = "wall"
{block_motion}
[[object]]
name = "lamp"
mesh = "room.obj"
group = "lamp"
material = "source"
exitance = [10.0, 5.0]
{lamp}
{more}
"""

MOTION = """
[[motion]]
name = "glide"
[[motion.keyframe]]
time_s = 0.0
translation = [0.0, 0.0, 0.0]
[[motion.keyframe]]
time_s = 1.0
translation = [0.3, 0.0, 0.0]
"""


def write_room(folder, moving=False, target="10%", more="", block_motion=None, frames=None, quantity="radiometric",
               lamp_more="", end_s=None):
    """A closed room of 2 m x 2 m x 2 m with a floating block and a lamp below its ceiling. @return  its scene file"""
    folder = pathlib.Path(folder)
    obj = Obj().group("room", *box_faces((0, 0, 0), (2, 2, 2), True))
    obj.group("block", *box_faces((0.5, 0.6, 0.4), (1.0, 1.1, 0.8), False))
    obj.group("lamp", *lamp((0.7, 0.7), (1.3, 1.3), 1.9))
    obj.write(folder / "room.obj")
    if block_motion is None:
        block_motion = 'motion = "glide"' if moving else ""
    end_s = end_s or (1.0 if moving else 0.0)
    text = ROOM.format(target=target, end_s=end_s, frames=frames or (3 if moving else 1), lamp=lamp_more,
                       block_motion=block_motion, quantity=quantity, more=(MOTION if moving else "") + more)
    scene = folder / "room.toml"
    scene.write_text(text, encoding="utf-8")
    return scene


ARM = """format = 1
[scene]
title = "lamp on an arm"
channels = ["grey"]
[accuracy]
target = "3%"
element_size = 0.34
[time]
start_s = {start_s}
end_s = {end_s}
frames = {frames}
[[material]]
name = "wall"
reflectance = 0.5
[[object]]
name = "room"
mesh = "arm.obj"
group = "room"
material = "wall"
[[object]]
name = "shield"
mesh = "arm.obj"
group = "shield"
material = "wall"
motion = "hold"
[[object]]
name = "lamp"
mesh = "arm.obj"
group = "lamp"
material = "wall"
sides = "front"
exitance = 100
motion = "nod"
[[motion]]
name = "nod"
parent = "arm"
pivot = [1.5, 1.0, 1.4]
keyframe = [{{time_s = 0}}, {{time_s = 2, rotation_axis = [0, 1, 0], rotation_deg = 20}}]
[[motion]]
name = "hold"
parent = "arm"
keyframe = [{{time_s = 0, translation = [0, 0, 0.05]}}]
[[motion]]
name = "arm"
pivot = [1.0, 1.0, 0.0]
keyframe = [{{time_s = 0}}, {{time_s = 2, rotation_axis = [0, 0, 1], rotation_deg = 270}}]
[[meter]]
name = "below"
origin = [1.45, 0.95, 0.9]
edge_u = [0.1, 0, 0]
edge_v = [0, 0.1, 0]
motion = "arm"
"""


def write_arm(folder, frames, start_s=0.0, name="arm"):
    """A lamp that faces down, nods and is carried round by an arm, with a shield over it that the arm holds, in a closed
    room; a meter hangs below. Three quarters of a turn from 0 s to 2 s. @return  its scene file"""
    folder = pathlib.Path(folder)
    obj = Obj().group("room", *box_faces((0, 0, 0), (2, 2, 2), True))
    obj.group("shield", *box_faces((1.3, 0.8, 1.45), (1.7, 1.2, 1.5), False))
    obj.group("lamp", *lamp((1.4, 0.9), (1.6, 1.1), 1.4))
    obj.write(folder / "arm.obj")
    scene = folder / f"{name}.toml"
    scene.write_text(ARM.format(start_s=start_s, end_s=2.0 if frames > 1 else start_s, frames=frames), encoding="utf-8")
    return scene
