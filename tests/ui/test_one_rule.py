# SPDX-License-Identifier: GPL-3.0-or-later
"""One rule for how snow looks: Workbench with the Mesh Cache object, the live preview's draw handler and Snowbough
Realtime draw one scene, and their pictures are compared pixel by pixel."""

import sys
from pathlib import Path

import numpy as np
import pytest
import snow_shot

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import golden  # noqa: E402

SIZE = 256

# A box and a ball under 12 cm of snow, frame 4 of 4, surfaces baked.
SCENE = """
import math, sys
import numpy as np
from mathutils import Matrix, Vector
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-0.75, 0.0, 0.5))
box = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(0.75, 0.0, 0.5), segments=48, ring_count=24)
bpy.ops.object.shade_smooth()
ball = bpy.context.object
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 4
scene.snowbough.end_depth = 0.12
box.select_set(True)
bpy.ops.snowbough.add_receivers()
for entry in scene.snowbough.receivers:
    entry.resolution = 512
bpy.ops.snowbough.setup_displacement(mode="SHELL")
bpy.ops.wm.save_as_mainfile(filepath={path!r})
result = [entry.object.name for entry in scene.snowbough.receivers]
"""

# What the three ways have in common, and each of them: the depths of a picture, 0 near and 1 far, row 0 at the bottom.
WAYS = """
import gpu
module = lambda name: sys.modules[f"{{addon}}.{{name}}"]
SIZE, NEAR, FAR = {size}, 1.0, 20.0
eye = Vector((-1.5, -3.2, 1.9))
view = ((Vector((0.0, 0.0, 0.55)) - eye).to_track_quat("-Z", "Y").to_matrix().to_4x4())
view = (Matrix.Translation(eye) @ view).inverted()
scale = 1.0 / math.tan(0.5 * 0.6)
projection = Matrix(((scale, 0, 0, 0), (0, scale, 0, 0),
                     (0, 0, (FAR + NEAR) / (NEAR - FAR), 2 * FAR * NEAR / (NEAR - FAR)), (0, 0, -1, 0)))
window, area = view3d()
space = area.spaces.active
region = next(region for region in area.regions if region.type == "WINDOW")
space.overlay.show_overlays = False
space.shading.type = "SOLID"

def by_workbench(draw=lambda: None):
    offscreen = gpu.types.GPUOffScreen(SIZE, SIZE)
    bpy.context.view_layer.update()
    offscreen.draw_view3d(scene, bpy.context.view_layer, space, region, view, projection)
    with offscreen.bind():
        gpu.matrix.load_matrix(view)
        gpu.matrix.load_projection_matrix(projection)
        draw()
        depth = gpu.state.active_framebuffer_get().read_depth(0, 0, SIZE, SIZE)
    color = offscreen.texture_color.read()
    color.dimensions = SIZE * SIZE * 4
    np.save({folder!r} + "/color.npy", np.array(color, np.uint8).reshape(SIZE, SIZE, 4))
    depth = np.array(depth.to_list(), np.float32).reshape(SIZE, SIZE)
    offscreen.free()
    return depth

def by_realtime(live):
    native = module("base.native").load()
    reader = module("realtime.reader").Reader(native, shows_live=live)
    renderer = native.Renderer()
    keeper = module("realtime.sync").Sync(renderer)
    keeper.update(reader.read(bpy.context.evaluated_depsgraph_get()))
    rows = lambda matrix: tuple(tuple(row) for row in matrix)
    camera = native.Camera(view=rows(view), projection=rows(projection), width=SIZE, height=SIZE)
    depth = renderer.render_depth(camera, native.RenderSettings(cull_back_faces=False))
    renderer.close()
    return depth

def save(name, depth):
    np.save({folder!r} + "/" + name + ".npy", depth)
result = True
"""

BAKED = """
surfaces = [obj for obj in scene.objects if obj.snowbough.is_shell]
save("workbench", by_workbench())
__import__("os").replace({folder!r} + "/color.npy", {folder!r} + "/workbench_color.npy")
save("realtime", by_realtime(False))
for obj in surfaces:
    obj.hide_viewport = True
save("bare", by_workbench())
for obj in surfaces:
    obj.hide_viewport = False
result = sorted(obj.name for obj in surfaces)
"""

LIVE = """
bpy.ops.snowbough.toggle_preview()
preview = module("base.session").preview
save("preview", by_workbench(lambda: preview.drawn.draw(False)))
save("live", by_realtime(True))
scene.snowbough.surface_overhang = 0.0
preview.watch(scene, bpy.context.evaluated_depsgraph_get(), 1e9)
save("other", by_workbench(lambda: preview.drawn.draw(False)))
bpy.ops.snowbough.toggle_preview()
result = True
"""


def metres(depth):
    """Distances along the view from a depth buffer; infinite for the background."""
    near, far = 1.0, 20.0
    away = near * far / (far - depth.astype(np.float64) * (far - near))
    return np.where(depth >= 1.0, np.inf, away)


@pytest.fixture(scope="module")
def pictures(blender, tmp_path_factory):
    """{way: metres, (SIZE, SIZE)} of the scene under its snow, and without it as "bare"."""
    folder = tmp_path_factory.mktemp("one_rule")
    blender.restart_if_ended()
    blender.run("bpy.ops.wm.read_homefile(app_template='')\nresult = True", timeout=300)
    assert blender.run(SCENE.format(path=str(folder / "shot.blend"))) == ["Cube", "Sphere"]
    blender.run(snow_shot.START)
    blender.wait_for_bake()
    blender.run("scene.frame_set(4)\nresult = True")
    blender.run(WAYS.format(size=SIZE, folder=str(folder)))
    assert blender.run(BAKED.format(folder=str(folder)), timeout=120) == ["Cube Snow", "Sphere Snow"]
    blender.run(LIVE, timeout=120)
    colors = np.load(folder / "workbench_color.npy")
    shown = {path.stem: metres(np.load(path)) for path in folder.glob("*.npy") if "color" not in path.stem}
    return {**shown, "workbench_color": colors}


def snow_of(pictures, way):
    """Where a picture shows snow: nearer than the bare scene by more than the points' own accuracy."""
    return pictures[way] < pictures["bare"] - 0.004


def agreement(pictures, one, other):
    """Of two ways to draw the scene: IoU of all that is drawn and of the snow, and the differences in depth where both
    show snow, sorted, in metres."""
    drawn = [np.isfinite(pictures[way]) for way in (one, other)]
    snow = [snow_of(pictures, way) for way in (one, other)]
    both = snow[0] & snow[1]
    apart = np.sort(abs(pictures[one][both] - pictures[other][both]))
    return *((a & b).sum() / (a | b).sum() for a, b in (drawn, snow)), apart


def test_each_way_shows_the_scene_and_its_snow(pictures):
    for way in ("workbench", "realtime", "preview", "live"):
        assert np.isfinite(pictures[way]).mean() > 0.3
        assert 0.05 < snow_of(pictures, way).mean() < 0.3


@pytest.mark.parametrize("one, other", [("workbench", "realtime"), ("preview", "live")])
def test_realtime_draws_the_same_points_as_blender(pictures, one, other):
    drawn, snow, apart = agreement(pictures, one, other)
    assert drawn > 0.9995 and snow > 0.9995
    assert apart[-1] < 1e-4


def test_the_live_preview_draws_what_a_bake_will_show(pictures):
    """It simulates in coarser maps and with fewer points."""
    drawn, snow, apart = agreement(pictures, "workbench", "preview")
    assert drawn > 0.999 and snow > 0.985
    assert np.median(apart) < 0.0006 and (apart > 0.009).mean() < 0.02


def test_another_shape_is_noticed(pictures):
    """The preview without overhangs, which are 12 mm to 6 cm; away from rims they change nothing."""
    drawn, snow, apart = agreement(pictures, "workbench", "other")
    assert drawn < 0.999 and snow < 0.985 and (apart > 0.009).mean() > 0.03


def test_workbench_draws_what_it_drew_before(pictures):
    drawn = np.isfinite(pictures["workbench"])
    # Workbench draws linear light.
    color = 255.0 * (pictures["workbench_color"][..., :3] / 255.0) ** (1.0 / 2.2)
    picture = np.dstack([color, 255.0 * drawn])
    halved = picture.reshape(SIZE // 2, 2, SIZE // 2, 2, 4).mean(axis=(1, 3))
    golden.assert_looks_like("workbench", halved[::-1].round().astype(np.uint8))
