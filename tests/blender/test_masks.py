# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks of receivers: from vertex groups and images to the baked map, the preview and the list of changes."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s


def plane(cells=8, size=2.0):
    """A level square of quads whose UV map fills the whole map."""
    steps = np.linspace(0.0, 1.0, cells + 1)
    points = [((x - 0.5) * size, (y - 0.5) * size, 0.0) for y in steps for x in steps]
    faces, uv = [], []
    for j in range(cells):
        for i in range(cells):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            faces.append([y * (cells + 1) + x for x, y in corners])
            uv += [(x / cells, y / cells) for x, y in corners]
    return s.mesh_object("Ground", points, faces, uv)


def left_half(obj, name="Mask", weight=1.0):
    """A vertex group with a weight where x < 0."""
    group = obj.vertex_groups.new(name=name)
    group.add([v.index for v in obj.data.vertices if v.co.x < 0.01], weight, "REPLACE")
    return group


def entry_of(obj):
    return next(e for e in bpy.context.scene.snowbough.receivers if e.object == obj)


def masked(obj, kind, **values):
    s.receive(obj)
    entry = entry_of(obj)
    entry.mask = kind
    for name, value in values.items():
        setattr(entry, name, value)
    return entry


def image(name, rows):
    """A generated image from rows of grey values, the lowest first."""
    values = np.array(rows, np.float32)
    made = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    pixels = np.ones((*values.shape, 4), np.float32)
    pixels[..., :3] = values[..., None]
    made.pixels.foreach_set(pixels.ravel())
    return made


@pytest.fixture
def map_of(native, tmp_path):
    def bake(frame=2, frames=(1, 2), **settings):
        s.settings(tmp_path, frames, **settings)
        s.bake()
        return s.height(native, tmp_path, "Ground", frame)

    return bake


@pytest.mark.parametrize("inverted", [False, True])
def test_a_vertex_group_masks_the_snow(map_of, inverted):
    ground = plane()
    left_half(ground, weight=0.5)
    masked(ground, "GROUP", mask_group="Mask", mask_inverted=inverted)
    heights = map_of()
    assert s.texel(heights, 0.25, 0.5) == pytest.approx(0.05, rel=1e-3)
    assert s.texel(heights, 0.75, 0.5) == pytest.approx(0.1 if inverted else 0.0, rel=1e-3)


def test_an_image_masks_on_its_own_uv_map(map_of):
    ground = plane()
    turned = ground.data.uv_layers.new(name="turned")
    for corner, snow in zip(turned.data, ground.data.uv_layers["snow"].data):
        corner.uv = (snow.uv[1], snow.uv[0])
    masked(ground, "IMAGE", mask_image=image("Grey", [[0.0] * 8 + [0.5] * 8] * 2), mask_uv_map="turned")
    heights = map_of()
    assert s.texel(heights, 0.5, 0.25) == 0.0
    assert s.texel(heights, 0.5, 0.75) == pytest.approx(0.05, rel=1e-3)


def test_an_image_sequence_masks_frame_by_frame(map_of, tmp_path):
    for number, value in ((1, 1.0), (2, 1.0), (3, 0.0), (4, 1.0)):
        still = image(f"Frame {number}", [[value] * 4] * 4)
        still.filepath_raw, still.file_format = str(tmp_path / f"mask_{number:04d}.exr"), "OPEN_EXR"
        still.save()
    sequence = bpy.data.images.load(str(tmp_path / "mask_0001.exr"))
    sequence.source = "SEQUENCE"
    masked(plane(), "IMAGE", mask_image=sequence)
    heights = map_of(4, (1, 4))
    # All that fell before frame 3 shrank to nothing; a quarter of the depth fell after it.
    assert s.open_ground(heights) == pytest.approx(0.025, rel=1e-2)


def test_weights_that_a_modifier_animates_mask_frame_by_frame(map_of):
    ground = plane()
    left_half(ground)
    modifier = ground.modifiers.new("Fade", "VERTEX_WEIGHT_MIX")
    modifier.vertex_group_a, modifier.mix_set, modifier.mix_mode = "Mask", "A", "SET"
    s.key(modifier, "default_weight_b", (1, 1.0), (4, 0.25))
    masked(ground, "GROUP", mask_group="Mask")
    heights = map_of(4, (1, 4))
    left = s.texel(heights, 0.25, 0.5)
    # What lay shrank with the weight; the last frame's snow came at a quarter.
    assert 0.2 * 0.1 < left < 0.3 * 0.1
    assert s.texel(heights, 0.75, 0.5) == 0.0


def test_a_masked_bake_resumes_byte_for_byte(addon, tmp_path):
    ground = plane()
    left_half(ground)
    modifier = ground.modifiers.new("Fade", "VERTEX_WEIGHT_MIX")
    modifier.vertex_group_a, modifier.mix_set, modifier.mix_mode = "Mask", "A", "SET"
    s.key(modifier, "default_weight_b", (1, 1.0), (8, 0.5))
    masked(ground, "GROUP", mask_group="Mask")
    s.settings(tmp_path / "whole", (1, 8), checkpoint_interval=4, repose=math.radians(60.0))
    s.bake()
    entry_of(ground).folder = entry_of(ground).baked_as = ""
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    s.bake_part(addon, last=4)
    s.bake_part(addon, first=5)
    whole = s.folder_of(tmp_path / "whole", "Ground")
    parts = s.folder_of(tmp_path / "parts", "Ground")
    for frame in range(1, 9):
        name = f"height_{frame:04d}.exr"
        assert (whole / name).read_bytes() == (parts / name).read_bytes(), name


def test_a_changed_mask_is_named(addon, tmp_path):
    ground = plane()
    left_half(ground)
    entry = masked(ground, "GROUP", mask_group="Mask")
    s.settings(tmp_path, (1, 2))
    s.bake()
    changes = addon("bake.changes_since_bake")
    assert changes.settings_changes(bpy.context.scene) == []
    entry.mask_inverted = True
    assert changes.settings_changes(bpy.context.scene) == [
        "Ground: mask vertex group 'Mask', inverted, was vertex group 'Mask'"
    ]


@pytest.mark.parametrize(
    "kind, values, reason",
    [
        ("GROUP", {"mask_group": "Gone"}, "has no vertex group 'Gone'"),
        ("IMAGE", {}, "has no image"),
        ("IMAGE", {"mask_image": "Grey", "mask_uv_map": "lost"}, "has no UV map 'lost'"),
    ],
)
def test_a_missing_mask_is_told(addon, tmp_path, kind, values, reason):
    other = s.square("Other", x=5.0)
    s.receive(other)
    if "mask_image" in values:
        values = {**values, "mask_image": image("Grey", [[0.5] * 4] * 4)}
    masked(plane(), kind, **values)
    s.settings(tmp_path, (1, 2))
    issues = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    assert [issue.object_name for issue in issues if reason in issue.text] == ["Ground"]
    running = s.bake_part(addon)
    assert reason in running.job.refused["Ground"]


def test_painting_changes_the_preview(addon):
    ground = plane()
    group = left_half(ground, weight=0.0)
    masked(ground, "GROUP", mask_group="Mask")
    s.settings("//", (1, 2))
    scene, context = bpy.context.scene, bpy.context
    live = addon("preview.live")
    live.start(scene, context.evaluated_depsgraph_get(), draws=False)
    try:
        preview = addon("base.session").preview
        (key,) = preview.simulated.maps

        def height():
            return float(np.mean(preview.heights(key)[24:40, 8:24]))

        assert height() == 0.0
        group.add(range(len(ground.data.vertices)), 1.0, "REPLACE")
        ground.update_tag(refresh={"DATA"})
        context.view_layer.update()
        preview.watch(scene, context.evaluated_depsgraph_get(), 0.0)
        assert height() > 0.01
    finally:
        live.stop()
