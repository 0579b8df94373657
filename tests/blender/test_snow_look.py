# SPDX-License-Identifier: GPL-3.0-or-later
"""What the snow material shows: relief, sparkle, and thin edges that dissolve into grains. Small renders in Cycles."""

import math

import bpy
import numpy as np
import pytest
import snow_scene as s
from surface_scene import bake_surfaces, points_at

SIDE = 96
SUN, SKY = "SUN", "SKY"


@pytest.fixture
def group(addon):
    """A level square of 400 m under snow, and the group node of its material, seen by shot()."""
    made = s.square("Ground", 400.0)
    material = bpy.data.materials.new("Snow")
    made.data.materials.append(material)
    builder = addon("base.node_builder").NodeBuilder
    addon("base.compat").use_material_nodes(material)
    material.node_tree.nodes.clear()
    build = builder(material.node_tree)
    node = build.node("ShaderNodeGroup", node_tree=addon("result.snow_nodes").ensure_group())
    place = build.node("ShaderNodeTexCoord").outputs["Object"]
    normal = build.node("ShaderNodeNewGeometry").outputs["Normal"]
    red = build.node("ShaderNodeEmission")
    build.feed(red, Color=(1.0, 0.0, 0.0, 1.0))
    build.feed(
        node, Height=0.2, Position=place, Normal=normal, Shader=red.outputs[0], Depth=0.2, Subsurface=0.0
    )
    build.feed(build.node("ShaderNodeOutputMaterial"), Surface=node.outputs["Shader"])
    return node


def shot(folder, light, distance=4.0, samples=4):
    """(SIDE, SIDE, 3) linear colours of the ground at that distance, seen at 30 degrees: under a low sun opposite the
    camera, or under an even sky."""
    scene = bpy.context.scene
    for name in ("Camera", "Sun"):
        if name in bpy.data.objects:
            bpy.data.objects.remove(bpy.data.objects[name])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0.0, -distance * math.cos(math.radians(30.0)), distance * 0.5)
    camera.rotation_euler = (math.radians(60.0), 0.0, 0.0)
    camera.data.lens = 150.0
    camera.data.clip_end = 2000.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = scene.world or bpy.data.worlds.new("World")
    scene.world.color = (0.0,) * 3 if light == SUN else (1.0,) * 3
    if light == SUN:
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.rotation_euler = (
            math.radians(-65.0),
            0.0,
            0.0,
        )  # 25 degrees above the horizon, towards the camera
        sun.data.energy, sun.data.angle = 3.0, math.radians(0.5)
        scene.collection.objects.link(sun)
    render = scene.render
    render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", samples, False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    render.resolution_x = render.resolution_y = SIDE
    render.resolution_percentage = 100
    render.filepath = str(folder / "shot.exr")
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    pixels = np.empty(SIDE * SIDE * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(SIDE, SIDE, 4)[..., :3]


def contrast(picture, block=1):
    """Standard deviation of the brightness of blocks of pixels, as a share of the mean of their row and column."""
    light = picture[..., 1].reshape(SIDE // block, block, SIDE // block, block).mean(axis=(1, 3))
    light = light / light.mean(axis=1, keepdims=True)
    return float((light / light.mean(axis=0)).std())


def glints(picture):
    """The number of pixels that are clearly brighter than snow."""
    light = picture[..., 1]
    return int((light > 2.5 * np.median(light)).sum())


# -- relief ---------------------------------------------------------------------------------------------------


@pytest.fixture
def smooth(group):
    """The same without grains and crystals."""
    group.inputs["Grain"].default_value = group.inputs["Sparkle"].default_value = 0.0
    return group


def test_bumps_of_centimetres_grow_with_the_depth(smooth, tmp_path):
    contrasts = []
    for height in (0.005, 0.02, 0.2):
        smooth.inputs["Height"].default_value = height
        contrasts.append(contrast(shot(tmp_path, SUN, 4.0)))
    assert contrasts[0] * 1.5 < contrasts[1] and contrasts[1] * 1.5 < contrasts[2]
    assert contrasts[2] > 0.1


def test_relief_scales_them(smooth, tmp_path):
    fresh = contrast(shot(tmp_path, SUN, 4.0))
    smooth.inputs["Relief"].default_value = 0.0
    assert contrast(shot(tmp_path, SUN, 4.0)) < 0.01 < 0.1 * fresh


def test_an_even_sky_shows_them(smooth, tmp_path):
    assert contrast(shot(tmp_path, SKY, 4.0, 32), 4) > 0.02
    smooth.inputs["Relief"].default_value = 0.0
    assert contrast(shot(tmp_path, SKY, 4.0, 32), 4) < 0.01


def test_open_ground_has_drifts_in_proportion_to_the_depth(smooth, tmp_path):
    """Blocks of 2.4 m average smaller waves away; thin places between deep snow have no drifts."""
    open_ground = contrast(shot(tmp_path, SUN, 120.0), 8)
    smooth.inputs["Height"].default_value = 0.07
    assert contrast(shot(tmp_path, SUN, 120.0), 8) < 0.5 * open_ground
    smooth.inputs["Height"].default_value, smooth.inputs["Depth"].default_value = 0.2, 0.02
    assert contrast(shot(tmp_path, SUN, 120.0), 8) < 0.5 * open_ground


def test_crowns_have_slow_waves(smooth, tmp_path):
    """Half as deep as open ground: waves of 1.4 and 0.7 m, of which blocks of 30 cm show more than of shorter ones."""
    smooth.inputs["Height"].default_value = 0.07
    slow = contrast(shot(tmp_path, SUN, 30.0), 4)
    smooth.inputs["Depth"].default_value = 0.01
    assert contrast(shot(tmp_path, SUN, 30.0), 4) < 0.5 * slow


def test_ripples_lie_across_the_wind(smooth, tmp_path):
    calm = shot(tmp_path, SUN, 4.0)[..., 1]

    def along(wind):
        """Changes from row to row of what the wind changes, per change from column to column."""
        smooth.inputs["Wind"].default_value = wind
        ripples = shot(tmp_path, SUN, 4.0)[..., 1] - calm
        assert ripples.std() > 0.02 * calm.mean()
        return np.abs(np.diff(ripples, axis=0)).mean() / np.abs(np.diff(ripples, axis=1)).mean()

    assert along((0.0, 1.0, 0.0)) > 1.5 * along((1.0, 0.0, 0.0))


def test_a_bump_evaluates_few_nodes(group):
    """Each of them three times: with 51 nodes and six noises, EEVEE compiled for minutes."""
    tree = group.node_tree
    bump = next(node for node in tree.nodes if node.type == "BUMP")
    found, waiting = set(), [link.from_node for link in bump.inputs["Height"].links]
    while waiting:
        node = waiting.pop()
        if node not in found:
            found.add(node)
            waiting += [link.from_node for socket in node.inputs for link in socket.links]
    assert len(found) <= 36
    assert sum(node.type == "TEX_NOISE" for node in found) == 3


# -- sparkle --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("distance", [1.0, 10.0, 80.0])
def test_snow_glitters_under_the_sun_at_every_distance(group, tmp_path, distance):
    assert glints(shot(tmp_path, SUN, distance, 16)) >= 8


def test_without_sparkle_nothing_glitters(group, tmp_path):
    group.inputs["Sparkle"].default_value = 0.0
    assert glints(shot(tmp_path, SUN, 10.0, 16)) == 0


def test_an_even_sky_makes_no_glints(group, tmp_path):
    assert glints(shot(tmp_path, SKY, 10.0, 16)) == 0


def test_crystals_stay_in_place_while_the_light_is_the_same(group, tmp_path):
    group.inputs["Relief"].default_value = 0.0
    assert np.array_equal(shot(tmp_path, SUN, 10.0), shot(tmp_path, SUN, 10.0))


# -- edges ----------------------------------------------------------------------------------------------------


def red_share(picture):
    """The share of pixels in which the object under the snow is seen."""
    return float((picture[..., 0] > 3.0 * picture[..., 1]).mean())


def test_low_snow_shows_the_object_between_its_grains(group, tmp_path):
    shares = []
    for cover in (0.0, 0.002, 0.006):
        group.inputs["Cover"].default_value = cover
        shares.append(red_share(shot(tmp_path, SKY, 0.15, 16)))
    assert shares[0] > 0.95 and shares[2] == 0.0
    assert 0.05 < shares[1] < 0.95


def bare_points(surface):
    values = np.empty(3 * len(surface.data.vertices), np.float32)
    surface.data.attributes["snow_bare"].data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def test_a_surface_knows_its_points_without_snow(tmp_path):
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"))
    assert np.array_equal(bare_points(surface), points_at(surface, 0).astype(np.float32))
    assert sorted(a.name for a in surface.data.attributes if a.name.startswith("snow_")) == [
        "snow_bare",
        "snow_joint",
        "snow_position",
    ]


def test_light_enters_no_snow_at_joints(addon, tmp_path):
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"))
    (node,) = addon("result.look").group_nodes(surface.data.materials[0])
    assert node.inputs["Joint"].links[0].from_node.attribute_name == "snow_joint"
    near = np.empty(len(surface.data.vertices), np.float32)
    surface.data.attributes["snow_joint"].data.foreach_get("value", near)
    assert (near == 0.0).all()


def is_dithered(material):
    if hasattr(material, "surface_render_method"):  # from 4.2 on
        return material.surface_render_method == "DITHERED"
    return (material.blend_method, material.shadow_method) == ("HASHED", "HASHED")


def test_eevee_shows_gaps_between_grains(tmp_path):
    """Blended materials would be sorted by their distance as a whole."""
    (surface,) = bake_surfaces(tmp_path, s.square("Ground"))
    assert is_dithered(surface.data.materials[0])


def test_a_surface_of_a_receiver_that_bends_is_opaque(addon, tmp_path):
    strip = s.strip("Flag", 4)
    s.bend(strip, 4, (1, 0.0), (4, -1.0))
    (surface,) = bake_surfaces(tmp_path, strip)
    assert "snow_bare" not in surface.data.attributes
    (node,) = addon("result.look").group_nodes(surface.data.materials[0])
    assert not node.inputs["Cover"].is_linked and node.inputs["Cover"].default_value == 1000.0


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, 3.0, 0.5)])
def test_applied_snow_has_the_same_heights(addon, tmp_path, scale):
    """The material takes the difference of two places, times the scale of the receiver."""
    ground = s.square("Ground")
    ground.scale, ground.location, ground.rotation_euler = scale, (3.0, 1.0, 0.5), (0.0, 0.0, 0.7)
    (surface,) = bake_surfaces(tmp_path, ground)
    bpy.context.scene.frame_set(4)
    bpy.ops.snowbough.apply_snow()
    plain = bpy.data.objects["Ground Snow 0004"]
    points = np.array([vertex.co for vertex in plain.data.vertices])
    heights = np.linalg.norm((points - bare_points(plain)) * scale, axis=1)
    world = points_at(surface, 4) - points_at(surface, 0)
    assert heights == pytest.approx(np.linalg.norm(world, axis=1), abs=1e-4)


# -- what a bake tells the material ---------------------------------------------------------------------------


def test_the_material_knows_depth_and_wind_of_the_bake(addon, tmp_path):
    """Wind along world Y, on a square that is turned by 90 degrees: its own X axis."""
    ground = s.square("Ground", 8.0)
    ground.rotation_euler.z = math.radians(90.0)
    (surface,) = bake_surfaces(tmp_path, ground, fall_angle=math.radians(30.0), bearing=0.0)
    (node,) = addon("result.look").group_nodes(surface.data.materials[0])
    assert node.inputs["Depth"].default_value == pytest.approx(0.1)
    assert tuple(node.inputs["Wind"].default_value) == pytest.approx((1.0, 0.0, 0.0), abs=1e-4)


def test_a_narrow_receiver_has_no_ripples(addon, tmp_path):
    (surface,) = bake_surfaces(tmp_path, s.square("Sill", 0.4), fall_angle=math.radians(30.0))
    (node,) = addon("result.look").group_nodes(surface.data.materials[0])
    assert tuple(node.inputs["Wind"].default_value) == (0.0, 0.0, 0.0)


def test_grains_are_as_large_on_a_scaled_receiver(addon, tmp_path):
    ground = s.square("Ground")
    ground.scale = (2.0, 3.0, 0.5)
    (surface,) = bake_surfaces(tmp_path, ground)
    (node,) = addon("result.look").group_nodes(surface.data.materials[0])
    (link,) = node.inputs["Position"].links
    assert tuple(link.from_node.inputs[1].default_value) == pytest.approx((2.0, 3.0, 0.5))


def test_soaked_snow_is_darker_and_mirrors_the_sun(smooth, tmp_path):
    """Soaked snow loses an eighth of its light under an even sky; against a low sun it has highlights."""
    sky, sun = [], []
    for wet in (0.0, 1.0):
        smooth.inputs["Wet"].default_value = wet
        sky.append(float(np.median(shot(tmp_path, SKY, 4.0)[..., 1])))
        sun.append(float(np.quantile(shot(tmp_path, SUN, 4.0)[..., 1], 0.99)))
    assert 0.75 * sky[0] < sky[1] < 0.97 * sky[0]
    assert sun[1] > 1.2 * sun[0]


@pytest.mark.parametrize("cover, wet, light", [(0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1000.0, 1.0, 0.47)])
def test_water_darkens_bare_ground_once(group, tmp_path, cover, wet, light):
    """In gaps of a snow surface the ground is dark already. In the ground's own material it loses half of its light,
    and 6 % of the rest to the film of water, which mirrors the white sun as much at 60 degrees."""
    for name, value in (("Height", 0.0), ("Cover", cover), ("Wet", wet)):
        group.inputs[name].default_value = value
    picture = shot(tmp_path, SUN, 0.15, 16)
    assert float(np.median(picture[..., 0] - picture[..., 1])) == pytest.approx(light, rel=0.02)
