# SPDX-License-Identifier: GPL-3.0-or-later
"""An animated shot of a swaying maple, a cart that drives off and a flapping flag, in snow whose wind turns half-way.
Inside Blender in the background:

    blender -b --factory-startup --python-exit-code 1 -P blend_samples/windy_shot.py -- TREE.obj FOLDER [RESOLUTION]

RESOLUTION (512) is that of the maps; the ground's is twice as fine. Uses the demo's stage and tree. Writes to FOLDER:
shot.blend, the cache, frame_NNNN.png, and shot.json for windy_sheet.py.
"""

import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))
import demo  # noqa: E402
import demo_scene  # noqa: E402
import snowbough  # noqa: E402  (demo.py says where it is)
from snowbough.base import compat  # noqa: E402

RENDERED_FRAMES = (1, 8, 15, 22, 29, 36, 42, 48)
START_DEPTH, END_DEPTH = 0.0, 0.045
# First frame with snow.
SNOW_FROM = 4
# (frame, fall angle in degrees, bearing in degrees): wind from the left, calm, from the right.
WIND = (
    (1, 35.0, 75.0),
    (18, 35.0, 75.0),
    (24, 0.0, 75.0),
    (25, 0.0, 285.0),
    (31, 45.0, 285.0),
    (48, 45.0, 285.0),
)
# The cloth hangs nearly upright: snow sticks for a moment, collects in its folds and slides off.
POLE_FOOT, POLE_LENGTH, POLE_LEAN = Vector((-1.35, -2.9, 0.0)), 2.3, math.radians(35.0)
FLAG_LENGTH, FLAG_HEIGHT, FLAG_SLANT = 1.15, 0.75, math.radians(84.0)
FLAKES, FLAKE_SIZE, FLAKE_SPEED = 3200, 0.015, 1.6
FLAKE_BOX = Vector((11.0, 11.0, 7.0))


def wind(frame):
    """(radians from the vertical, bearing in radians) at a frame, as keyed."""
    frames, angles, bearings = zip(*WIND)
    bearing = bearings[0] if frame < 24.5 else bearings[-1]
    return math.radians(float(np.interp(frame, frames, angles))), math.radians(bearing)


def key_wind(settings):
    for frame in range(1, demo_scene.FRAMES + 1):
        settings.fall_angle, settings.bearing = wind(frame)
        settings.keyframe_insert("fall_angle", frame=frame)
        settings.keyframe_insert("bearing", frame=frame)


def make_flag():
    """A pole in the ground and a cloth on it, which a Wave modifier moves, more the further from the pole."""
    wood = demo_scene.make_material("pole", (0.16, 0.10, 0.06), 0.8, mottle=0.3, scale=8.0)
    bpy.ops.mesh.primitive_cylinder_add(radius=0.028, depth=POLE_LENGTH, vertices=16)
    pole = bpy.context.object
    pole.name = "pole"
    pole.data.materials.append(wood)
    turn = Matrix.Rotation(-POLE_LEAN, 4, "X")
    foot = POLE_FOOT + Vector((0.0, 0.0, float(demo_scene.knoll(*POLE_FOOT.xy))))
    pole.matrix_world = Matrix.Translation(foot) @ turn @ Matrix.Translation((0.0, 0.0, 0.5 * POLE_LENGTH))

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=46, y_subdivisions=30, size=1.0)
    flag = bpy.context.object
    flag.name = "flag"
    size = Matrix.Diagonal((FLAG_LENGTH, FLAG_HEIGHT, 1.0, 1.0))
    flag.data.transform(size @ Matrix.Translation((0.5, -0.5, 0.0)))
    for polygon in flag.data.polygons:
        polygon.use_smooth = True
    cloth = demo_scene.make_material("red cloth", (0.42, 0.035, 0.03), 0.85, mottle=0.12, scale=30.0)
    flag.data.materials.append(cloth)
    free = flag.vertex_groups.new(name="free")
    for vertex in flag.data.vertices:
        free.add([vertex.index], min(1.0, 1.2 * vertex.co.x / FLAG_LENGTH), "REPLACE")
    wave = flag.modifiers.new("wind", "WAVE")
    wave.use_x, wave.use_y, wave.use_normal = True, False, False
    wave.start_position_x, wave.time_offset = -2.0, -400.0
    wave.height, wave.width, wave.narrowness, wave.speed = 0.10, 0.62, 1.6, 0.045
    wave.vertex_group = "free"
    top = foot + turn.to_3x3() @ Vector((0.0, 0.0, POLE_LENGTH - 0.04))
    flag.matrix_world = Matrix.Translation(top) @ Matrix.Rotation(FLAG_SLANT, 4, "X")
    return flag, pole


def prepare_snowfall(receivers, scenery, resolution):
    bpy.ops.object.select_all(action="DESELECT")
    for receiver in receivers:
        receiver.select_set(True)
    bpy.context.view_layer.objects.active = receivers[0]
    bpy.ops.snowbough.add_receivers()
    settings = bpy.context.scene.snowbough
    for entry in settings.receivers:
        entry.resolution = 2 * resolution if entry.object.name == "ground" else resolution
    for each in scenery:
        each.snowbough.occlude = False
    settings.start_depth, settings.end_depth = START_DEPTH, END_DEPTH
    settings.pixel_size, settings.seed = 9.2 / resolution, 3
    for frame in (1, SNOW_FROM):
        settings.rate = float(frame >= SNOW_FROM)
        settings.keyframe_insert("rate", frame=frame)
    for curve in compat.curves_of(bpy.context.scene):
        if curve.data_path == "snowbough.rate":
            for key in curve.keyframe_points:
                key.interpolation = "CONSTANT"
    # Two seconds represent an hour of snowfall: excess snow slides off within a few frames.
    settings.max_depth, settings.slide_half_life = 0.06, 0.08
    # Wet snow in a storm sticks to everything that it hits, walls included.
    settings.repose = np.radians(90.0)
    key_wind(settings)


class Flakes:
    """Falling flakes as short streaks, for the picture only: made after the bake, moved for each frame."""

    def __init__(self):
        rng = np.random.default_rng(11)
        self.start = rng.uniform(0.0, 1.0, (FLAKES, 3)) * np.array(FLAKE_BOX)
        self.size = FLAKE_SIZE * rng.uniform(0.5, 1.2, FLAKES)
        mesh = bpy.data.meshes.new("flakes")
        corners = np.arange(6 * FLAKES).reshape(-1, 6)
        octahedron = ((0, 2, 4), (0, 4, 3), (0, 3, 5), (0, 5, 2), (1, 4, 2), (1, 3, 4), (1, 5, 3), (1, 2, 5))
        faces = np.concatenate([corners[:, sides] for sides in octahedron])
        mesh.from_pydata(np.zeros((6 * FLAKES, 3)).tolist(), [], faces.tolist())
        white = demo_scene.make_material("flake", (0.9, 0.92, 0.95), 1.0)
        mesh.materials.append(white)
        self.mesh = mesh
        self.object = bpy.data.objects.new("flakes", mesh)
        bpy.context.scene.collection.objects.link(self.object)

    def place(self, frame):
        """Flakes have drifted with the wind of every frame so far; those that leave the box come in again."""
        way = np.zeros(3)
        for past in range(1, frame + 1):
            angle, bearing = wind(past)
            direction = np.array(
                [math.sin(angle) * math.sin(bearing), math.sin(angle) * math.cos(bearing), -math.cos(angle)]
            )
            way += direction * FLAKE_SPEED / bpy.context.scene.render.fps
        box = np.array(FLAKE_BOX)
        at = (self.start + way) % box - np.array([0.5 * box[0], 0.62 * box[1], 0.3])
        streak = direction[None] * self.size[:, None] * 2.6
        across = np.cross(direction, (0.0, 1.0, 0.0))
        across /= np.linalg.norm(across)
        beside = np.cross(direction, across)
        arms = [streak, -streak] + [
            sign * axis[None] * self.size[:, None] for axis in (across, beside) for sign in (1.0, -1.0)
        ]
        self.mesh.vertices.foreach_set(
            "co", np.stack([at + arm for arm in arms], axis=1).astype(np.float32).reshape(-1)
        )
        self.mesh.update()


def main(tree, folder, resolution):
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    stage = demo_scene.build_stage()
    _armature, meshes, _ = demo.import_tree(tree)
    bark = next(mesh for mesh in meshes if mesh.name.endswith("_bark"))
    flag, pole = make_flag()
    prepare_snowfall([bark, stage.ground, stage.bench, stage.cart, flag, pole], stage.backdrop, resolution)
    demo_scene.set_render(scene, 640, 400, 16)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"), compress=True)
    demo.say(f"baking {demo_scene.FRAMES} frames")
    if bpy.ops.snowbough.bake() != {"FINISHED"}:
        raise RuntimeError("the bake did not finish")
    demo.simplify_snow()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"), compress=True)

    flakes = Flakes()
    for frame in RENDERED_FRAMES:
        scene.frame_set(frame)
        flakes.place(frame)
        flakes.object.hide_render = frame < SNOW_FROM
        scene.render.filepath = str(folder / f"frame_{frame:04d}.png")
        bpy.ops.render.render(write_still=True)
        demo.say(f"rendered frame {frame}")
    snowing = demo_scene.FRAMES - SNOW_FROM + 1
    (folder / "shot.json").write_text(
        json.dumps(
            [
                {
                    "frame": frame,
                    "depth": START_DEPTH
                    + (END_DEPTH - START_DEPTH) * max(0, frame - SNOW_FROM + 1) / snowing,
                    "angle": math.degrees(wind(frame)[0]),
                    "bearing": math.degrees(wind(frame)[1]),
                }
                for frame in RENDERED_FRAMES
            ]
        )
    )


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(given[0]).resolve(), Path(given[1]).resolve(), int(given[2]) if len(given) > 2 else 512)
