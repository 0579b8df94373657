# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaders of docs/engines draw an exported tree as the real-time renderer draws it: outlines, depths, colours, and
the area of the snow are compared in pictures of both. Neither has shadows or relief of bark. The HLSL draws what the
GLSL draws."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snowbough.gltf import snow_maps, tree_data, tree_file, triangle_mesh

pytest.importorskip("moderngl", reason="moderngl draws the files (package python3-moderngl)")
pytest.importorskip("PIL.Image", reason="Pillow reads the images (package python3-pil)")
import glb  # noqa: E402
from engine_hlsl import ENTRIES, as_glsl  # noqa: E402
from engine_view import EngineView, source  # noqa: E402
from round_limbs import round_limbs  # noqa: E402

MAPLE = Path(__file__).resolve().parents[1] / "data" / "small_maple.obj"
SIZE, RESOLUTION, DEPTH = 256, 512, 0.1
BARK = (0.24, 0.18, 0.13)
# Y up, as in the file: limbs of 1 to 15 cm, a pixel is 2.6 mm wide.
EYE, TARGET, FIELD_OF_VIEW = np.array((1.2, 2.8, 1.6)), np.array((0.0, 1.9, 0.0)), 0.3
NEAR, FAR = 0.05, 100.0
LIGHT = {"to_sun": (0.45, 0.7, 0.6), "sun": 0.5, "sky": (0.25, 0.27, 0.3), "ground": (0.1, 0.09, 0.08)}


def z_up(place):
    return place[0], -place[2], place[1]


def fallen(vertices, quads, uv_snow):
    """The map of a fall of DEPTH."""
    corners = (0, 1, 2, 0, 2, 3)
    triangles = quads[:, corners].reshape(-1, 3)
    uv = np.ascontiguousarray(uv_snow[:, corners].reshape(-1, 3, 2))
    with native.SnowSimulation(pixel_size=0.01, flutter=0.2, blur_radius=0.02, engine="CPU") as snow:
        snow.add_object("tree", triangles, uv, resolution=RESOLUTION)
        for step in range(6):
            snow.step({"tree": vertices} if step == 0 else {}, DEPTH / 6)
        return snow.output("tree", normal=False)["height"]


class Picture:
    """light: (H, W, 3) display values, 0 to 255; depth: (H, W) metres along the view's axis, NaN beside the tree."""

    def __init__(self, light, depth):
        self.light, self.depth = light, depth
        self.tree = ~np.isnan(depth)
        # Bark is brown, and snow is blue.
        self.snow = self.tree & (light[..., 2] > 0.9 * light[..., 0])


@pytest.fixture(scope="module")
def native_picture():
    """(map of the snow, picture of the real-time renderer)."""
    skeleton = native.read_tree(str(MAPLE))
    base = native.build_tree_mesh(skeleton, snow_resolution=RESOLUTION)
    vertices, quads, (_bark, uv_snow), _radii = round_limbs(base, 2)
    heights = fallen(vertices, quads, uv_snow)
    camera = native.Camera(
        eye=z_up(EYE),
        target=z_up(TARGET),
        field_of_view=FIELD_OF_VIEW,
        width=SIZE,
        height=SIZE,
        near=NEAR,
        far=FAR,
    )
    settings = native.RenderSettings(
        shadow_resolution=0,
        min_pixels=0,
        target_pixels=2,
        antialias=False,
        sun_direction=z_up(LIGHT["to_sun"]),
        sun_color=(LIGHT["sun"],) * 3,
        sky_color=LIGHT["sky"],
        ground_color=LIGHT["ground"],
    )
    with native.Renderer() as renderer:
        renderer.add_tree("tree", base, bark_depth=0.0, bark_dark=BARK, bark_light=BARK)
        renderer.set_snow("tree", heights, DEPTH)
        light = renderer.render_light(camera, settings)[::-1, :, :3]
        depth = renderer.render_depth(camera, settings)[::-1]
    away = np.where(depth < 1, NEAR * FAR / (FAR - depth * (FAR - NEAR)), np.nan)
    return heights, Picture(np.clip(light, 0, 1) ** (1 / 2.2) * 255, away)


def exported(folder, heights, limb_widths=True):
    """(file, its snow data): the finest level has the round limbs of the renderer."""
    base = native.build_tree_mesh(native.read_tree(str(MAPLE)), snow_resolution=RESOLUTION)
    vertices, quads, uvs, _radii = round_limbs(base, 2)
    count = len(vertices)
    follows = triangle_mesh.strongest(np.zeros((count, 1), int), np.ones((count, 1)))
    bark = triangle_mesh.from_quads(
        vertices, quads, uvs, *follows, np.zeros(len(quads)), np.zeros(count, int)
    )
    bark = replace(bark, smooth=np.repeat(np.asarray(base.face_part) < 2, 2 * 4**2))
    samples, scale, offset = snow_maps.quantised(heights)
    native.write_png(str(folder / "heights.png"), samples)
    said = {
        **{
            "frames": [0],
            "columns": 1,
            "rows": 1,
            "tile": RESOLUTION,
            "openDepths": [DEPTH],
            "lastDepth": DEPTH,
        },
        "height": {"uri": "heights.png", "scale": scale, "offset": offset},
    }
    part = tree_data.Part("bark", [bark], [tree_data.Material("bark", color=BARK)])
    joints = [tree_data.Joint("root", -1, np.eye(4))]
    extras = {"snow": {"bark": said}} if limb_widths else {}
    tree_file.build(tree_data.Tree("tree", joints, [part], 1, extras)).write_glb(folder / "tree.glb")
    assert glb.errors(folder / "tree.glb") == []
    return glb.Gltf(folder / "tree.glb"), said


def engine_picture(read, said, folder, sources=None):
    view = EngineView(SIZE, sources)
    view.light(**LIGHT)
    view.clear()
    view.look(EYE, TARGET, field_of_view=FIELD_OF_VIEW, target_pixels=2.0, snow_share=1.0)
    view.snow(said, folder)
    view.draw(read, read.node("bark_LOD0"))
    return Picture(view.picture()[..., :3].astype(float), view.depth())


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def differences(engine, renderer):
    """Differences of two pictures, in units of its tolerance. Measured: outlines of 1.2 %, depths of 0.22 mm in
    the median and of 0.69 mm at nine tenths, a colour of 2.0 of 255, 3.9 % of the snow's area, 7.2 % of its outline."""
    both = engine.tree & renderer.tree
    off = abs(engine.depth - renderer.depth)[both]
    return {
        "outline": (1 - overlap(engine.tree, renderer.tree)) / 0.016,
        "median depth": np.median(off) / 0.0003,
        "depth": np.quantile(off, 0.9) / 0.001,
        "colour": abs(engine.light - renderer.light)[both].mean() / 3.0,
        "snow's area": abs(engine.snow.sum() / renderer.snow.sum() - 1) / 0.06,
        "snow's outline": (1 - overlap(engine.snow, renderer.snow)) / 0.11,
    }


def test_an_exported_tree_looks_as_in_the_renderer(tmp_path, native_picture):
    heights, renderer = native_picture
    assert renderer.tree.mean() > 0.2 and renderer.snow.mean() > 0.03
    found = differences(engine_picture(*exported(tmp_path, heights), tmp_path), renderer)
    assert max(found.values()) < 1, found


@pytest.mark.parametrize(
    "rule, wrong, limb_widths",
    [
        (
            "return height_offset + height_scale * mix",
            "return height_offset + 0.5 * height_scale * mix",
            True,
        ),
        ("min(lip + kept, most_shown(thickness))", "0.5 * thickness", True),
        ("const float kOpaqueDepth = 0.0022;", "const float kOpaqueDepth = 0.01;", True),
        ("", "", False),
    ],
    ids=[
        "half of the map's heights",
        "half of the shown height",
        "translucent snow",
        "limbs of unknown width",
    ],
)
def test_a_wrong_rule_shows_in_the_picture(tmp_path, native_picture, rule, wrong, limb_widths):
    heights, renderer = native_picture
    sources = {stage: source(stage) for stage in ENTRIES}
    assert any(rule in text for text in sources.values())
    sources = {stage: text.replace(rule, wrong) if rule else text for stage, text in sources.items()}
    read, said = exported(tmp_path, heights, limb_widths)
    found = differences(engine_picture(read, said, tmp_path, sources), renderer)
    assert max(found.values()) > 1.5, found


@pytest.mark.skipif(
    not shutil.which("glslangValidator") or not shutil.which("spirv-cross"),
    reason="glslangValidator and spirv-cross translate HLSL (packages glslang-tools, spirv-cross)",
)
def test_the_hlsl_draws_what_the_glsl_draws(tmp_path, native_picture):
    read, said = exported(tmp_path, native_picture[0])
    pictures = [
        engine_picture(read, said, tmp_path, sources)
        for sources in (None, {stage: as_glsl(stage, tmp_path) for stage in ENTRIES})
    ]
    glsl, hlsl = pictures
    # Compilers round differently. Measured: no other outline, 0.04 mm, and 2 of 255.
    assert overlap(glsl.tree, hlsl.tree) > 0.999 and overlap(glsl.snow, hlsl.snow) > 0.999
    both = glsl.tree & hlsl.tree
    assert np.quantile(abs(glsl.depth - hlsl.depth)[both], 0.99) < 2e-4
    assert np.quantile(abs(glsl.light - hlsl.light)[both], 0.99) < 4
