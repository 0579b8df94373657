# SPDX-License-Identifier: GPL-3.0-or-later
"""What Snowbough Realtime reads from a scene besides meshes: images of bark, the live preview's snow, flakes."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
import snow_scene
from realtime_shot import WORLD, camera_at, material, pixel, rendered, set_up

SIDES, HEIGHT = 6, 4
MAPLE = Path(__file__).resolve().parent.parent / "data" / "small_maple.obj"

scene = pytest.fixture(set_up)


def write_tree(folder):
    """A trunk of four storeys, each one turn of an image that is red below and green above; the upper two storeys are
    of another material, a plain blue. Y up."""
    image = bpy.data.images.new("bark", 4, 4)
    rows = np.zeros((4, 4, 4), np.float32)
    rows[..., 3] = 1.0
    rows[:2, :, 0] = rows[2:, :, 1] = 0.8
    image.pixels.foreach_set(rows.reshape(-1))
    image.filepath_raw, image.file_format = str(folder / "bark.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    lines = ["mtllib trunk.mtl", "g trunk1"]
    for ring in range(HEIGHT + 1):
        for k in range(SIDES):
            turn = 2 * math.pi * k / SIDES
            lines.append(f"v {0.3 * math.cos(turn)} {ring} {-0.3 * math.sin(turn)}")
        lines += [f"vt {2 * k / SIDES} {ring}" for k in range(SIDES + 1)]
    for ring in range(HEIGHT):
        lines.append("usemtl striped" if ring < 2 else "usemtl blue")
        for k in range(SIDES):
            corners = ((ring, k), (ring, k + 1), (ring + 1, k + 1), (ring + 1, k))
            named = (f"{r * SIDES + c % SIDES + 1}/{r * (SIDES + 1) + c + 1}" for r, c in corners)
            lines.append("f " + " ".join(named))
    (folder / "trunk.obj").write_text("\n".join(lines) + "\n")
    (folder / "trunk.mtl").write_text(
        "newmtl striped\nKd 1 1 1\nmap_Kd bark.png\nnewmtl blue\nKd 0.05 0.05 0.8\n"
    )
    return folder / "trunk.obj"


def color_at(picture, scene, z):
    """The channel that is brightest where the trunk faces the camera at a height."""
    return int(np.argmax(pixel(picture, scene, (0, -0.3, z))[:3] / WORLD))


@pytest.mark.parametrize("detail", ["STANDARD", "chain"])
def test_bark_shows_its_images_where_the_export_has_them(scene, tmp_path, detail):
    options = {"lod_chain": True} if detail == "chain" else {}
    bpy.ops.import_scene.xfrog_tree(filepath=str(write_tree(tmp_path)), **options)
    assert bpy.data.armatures["trunk"].snowbough_bark
    camera_at((0, -7, 2), (0, 0, 2))
    bpy.data.objects["Sun"].rotation_euler = (math.radians(70), 0, 0)
    picture = rendered(scene)
    found = [color_at(picture, scene, z) for z in (0.25, 0.75, 1.25, 1.75, 2.5, 3.5)]
    assert found == [0, 1, 0, 1, 2, 2]


def test_a_tree_without_images_keeps_none(scene):
    bpy.ops.import_scene.xfrog_tree(filepath=str(MAPLE))
    assert bpy.data.armatures["small_maple"].snowbough_bark == ""


@pytest.fixture
def drawn(addon):
    """drawn(reader): the picture of the scene's current frame from above, as in a 3D view."""
    sync = addon("realtime.sync")
    native = addon("base.native").load()
    renderer = native.Renderer()
    keeper = sync.Sync(renderer)

    def draw(reader):
        keeper.update(reader.read(bpy.context.evaluated_depsgraph_get()))
        camera = native.Camera(eye=(0, -0.01, 8), target=(0, 0, 0), width=64, height=64, field_of_view=0.5)
        settings = native.RenderSettings(sky_color=(0.5, 0.5, 0.5), sun_color=(0, 0, 0), shadow_resolution=0)
        return renderer.render(camera, settings)[..., :3].astype(int)

    yield draw
    renderer.close()


def test_a_view_shows_the_live_previews_snow_as_the_timeline_plays(scene, addon, drawn):
    ground = snow_scene.square("Ground", 4.0)
    ground.data.materials.append(material("black", (0.0, 0.0, 0.0)))
    scene.frame_start, scene.frame_end = 1, 10
    scene.snowbough.receivers.add().object = ground
    scene.frame_set(0)
    live = addon("preview.live")
    view = addon("realtime.reader").Reader(addon("base.native").load(), shows_live=True)
    final = addon("realtime.reader").Reader(addon("base.native").load())
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert drawn(view)[32, 32].max() == 0
    try:
        live.start(scene, depsgraph, draws=False)
        assert view.is_outdated(depsgraph)
        assert drawn(view)[32, 32].max() == 0  # nothing has fallen yet
        for frame in range(1, 6):
            scene.frame_set(frame)
        assert view.is_outdated(depsgraph)
        assert drawn(view)[32, 32].min() > 100
        assert not view.is_outdated(depsgraph)
        assert drawn(final)[32, 32].max() == 0  # renders show what is baked
    finally:
        live.stop()
    assert view.is_outdated(depsgraph)
    assert drawn(view)[32, 32].max() == 0


def test_flakes_fall_where_they_are_asked_for(scene):
    camera_at((0, -8, 1), (0, 0, 1))
    snow_scene.square("Square", 0.1)
    clear = rendered(scene)
    options = scene.snowbough_realtime
    options.show_flakes, options.flake_rate, options.flake_size = True, 0.5, 0.02
    falling = rendered(scene)
    changed = (abs(falling - clear)[..., :3].max(axis=2) > 0.01).mean()
    assert 0.02 < changed < 0.9
    assert np.array_equal(rendered(scene), falling)
    scene.frame_set(2)
    assert not np.array_equal(rendered(scene), falling)
    scene.snowbough.rate = 0.0
    assert np.array_equal(rendered(scene), clear)


def test_flakes_are_as_large_in_scenes_of_other_units(scene, addon):
    flakes_of = addon("realtime.flakes").flakes_of
    options = scene.snowbough_realtime
    options.show_flakes = True
    scene.snowbough.fall_angle = math.radians(30)
    scene.snowbough.flutter = math.pi  # the flakes sway by at most 45 degrees
    scene.unit_settings.scale_length = 0.01
    flakes = flakes_of(bpy.context.evaluated_depsgraph_get().scene_eval)
    assert flakes.metre == pytest.approx(100.0)
    assert flakes.rate == pytest.approx(0.015 / 3600)
    assert flakes.direction[2] == pytest.approx(-math.cos(math.radians(30)))
    assert flakes.flutter == pytest.approx(math.pi / 4)
    addon("base.native").load().Snowfall(**vars(flakes))
