# SPDX-License-Identifier: GPL-3.0-or-later
"""Physics of the accumulation core, on small maps: amounts, places, time."""

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import DOWN, simulation, snow_on, volume
from snow_meshes import box, chart_of_box, grid, rotated, sphere, wind

# Amounts


@pytest.mark.parametrize("tilt", [0, 30, 60])
@pytest.mark.parametrize("pixel_size", [0.002, 0.016, 0.16])
def test_a_tilted_plane_gathers_depth_times_its_area_seen_from_above(tilt, pixel_size):
    positions, triangles, uv = grid()
    height, area, statistics = snow_on(
        (rotated(positions, "x", tilt), triangles, uv), steps=48, depth=0.48, pixel_size=pixel_size
    )
    assert volume(height, area) == pytest.approx(0.48 * np.cos(np.radians(tilt)), rel=1e-5)
    total = statistics["total"]
    assert total["visible_area"] == pytest.approx(48 * np.cos(np.radians(tilt)), rel=1e-5)
    assert total["deposited_volume"] == pytest.approx(0.01 * total["visible_area"], rel=1e-5)
    assert total["held_volume"] == pytest.approx(volume(height, area), rel=1e-5)


@pytest.mark.parametrize("steps, flutter", [(1, 0.0), (8, np.radians(3.0))])
@pytest.mark.parametrize("texels_a_pixel", [0.3, 1.0, 2.0, 10.0])
@pytest.mark.parametrize("tilt, wind_angle", [(0, 0), (30, 0), (60, 0), (0, 45), (0, 80), (0, 89), (20, 80)])
def test_an_open_plane_is_covered_evenly(tilt, wind_angle, texels_a_pixel, steps, flutter):
    positions, triangles, uv = grid(cells=3)
    height, _, _ = snow_on(
        (rotated(positions, "x", tilt), triangles, uv),
        steps=steps,
        depth=0.01,
        resolution=128,
        pixel_size=texels_a_pixel / (0.96 * 128),
        flutter=flutter,
        direction=wind(wind_angle, 30.0),
    )
    lain = height[height > 0.0]
    assert len(lain) > 15000
    assert lain.std() / lain.mean() <= 1e-5


def test_a_smooth_ball_is_covered_by_the_cosine_of_its_faces():
    positions, triangles, uv = sphere()
    height, _, _ = snow_on((positions, triangles, uv), steps=1, depth=0.01, resolution=256, pixel_size=0.008)
    table = native.texel_table(triangles, uv, 256)
    corners = positions[triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = (normals[:, 2] / np.linalg.norm(normals, axis=1)).clip(0.0)
    # Texels that lie in one triangle as a whole.
    whole = np.diff(table["fragment_begin"]) == 1
    expected = 0.01 * up[table["triangle"]]
    found = height.ravel()[table["texel"]]
    assert abs(found - expected)[whole].max() < 1e-5 * 0.01


@pytest.mark.parametrize("resolution", [64, 256])
def test_a_sphere_gathers_depth_times_its_disc(resolution):
    height, area, _ = snow_on(sphere(), steps=16, depth=0.16, resolution=resolution, pixel_size=0.01)
    assert area.sum() == pytest.approx(np.pi, rel=0.01)
    disc = 24.0 * np.sin(2.0 * np.pi / 48.0) * 0.25  # the outline is a 48-gon
    assert volume(height, area) == pytest.approx(0.16 * disc, rel=0.01)


@pytest.mark.parametrize("angle, pixel_size", [(45, 0.01), (80, 0.002), (89, 0.0005)])
def test_level_ground_gets_the_depth_whatever_the_wind(angle, pixel_size):
    height, area, _ = snow_on(
        grid(cells=2), steps=24, depth=0.12, direction=wind(angle, 30.0), pixel_size=pixel_size
    )
    assert volume(height, area) == pytest.approx(0.12, rel=0.01)
    inner = height[8:-8, 8:-8]
    assert np.percentile(inner, 5) > 0.85 * 0.12
    assert np.percentile(inner, 95) < 1.15 * 0.12


def test_a_strip_one_and_a_half_texels_wide_loses_nothing():
    positions, triangles, _ = grid(size_x=0.2)
    corners = (positions[:, :2] + (0.1, 0.5)) / (0.2, 1.0) * (1.5 / 64.0, 0.9) + (10.3 / 64.0, 0.05)
    uv = corners[triangles].astype(np.float32)
    height, area, _ = snow_on((positions, triangles, uv), steps=16, depth=0.16, pixel_size=0.01)
    assert area.sum() == pytest.approx(0.2, rel=1e-5)
    assert volume(height, area) == pytest.approx(0.16 * 0.2, rel=0.01)


@pytest.mark.parametrize("stretch", [(1.0, 1.0), (0.3, 0.9), (0.9, 0.1)])
def test_stretched_and_rotated_uvs_gather_the_same(stretch):
    positions, triangles, uv = grid(cells=3)
    turn = np.radians(27.0)
    turned = (uv - 0.5) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    uv = (turned * np.array(stretch) * 0.65 + 0.5).astype(np.float32)
    height, area, _ = snow_on((positions, triangles, uv), steps=16, depth=0.16)
    assert volume(height, area) == pytest.approx(0.16, rel=0.01)


def test_noise_keeps_the_mean():
    height, area, statistics = snow_on(grid(), steps=24, depth=0.24, pixel_size=0.005, noise_density=0.2)
    assert volume(height, area) == pytest.approx(0.24, rel=0.02)
    assert statistics["total"]["deposited_volume"] == pytest.approx(volume(height, area), rel=1e-5)
    assert height[2:-2, 2:-2].std() > 0.01


def test_twigs_a_third_of_a_pixel_wide_gather_the_right_volume_on_average():
    twig = grid(size_x=0.01, size_y=1.0)
    height, area, _ = snow_on(twig, steps=96, depth=0.96, pixel_size=0.03)
    assert volume(height, area) == pytest.approx(0.96 * 0.01, rel=0.1)


def test_a_texel_that_goes_half_around_a_twig_holds_snow_by_its_upper_parts():
    """Eight sides in two texels: whichever side a texel's sample point lies on, the twig's back holds snow."""
    angle = 2 * np.pi * np.arange(9) / 8
    ring = np.stack([np.zeros(9), 0.01 * np.sin(angle), 0.01 * np.cos(angle)], axis=1)
    positions = np.concatenate([ring + (end, 0, 0) for end in (-0.5, 0.5)]).astype(np.float32)
    around = np.stack([(10 + 2 * np.arange(9) / 8) / 64, np.full(9, 0.05)], axis=1)
    corner = np.concatenate([around, around + (0, 0.9)])
    side = np.arange(8)
    triangles = np.concatenate(
        [np.stack([side, side + 9, side + 10], 1), np.stack([side, side + 10, side + 1], 1)]
    )
    uv = corner[triangles].astype(np.float32)
    height, area, statistics = snow_on(
        (positions, triangles.astype(np.int32), uv), steps=24, depth=0.02, pixel_size=0.005, max_depth=1e6
    )
    total = statistics["total"]
    assert total["slid_volume"] < 0.01 * total["deposited_volume"]
    assert volume(height, area) == pytest.approx(0.02 * 0.02, rel=0.1)


def test_a_twig_a_fortieth_of_a_pixel_wide_is_covered_like_open_ground():
    twig = grid(size_x=0.00075, size_y=1.0, cells=64)
    height, area, _ = snow_on(twig, steps=96, depth=0.096, pixel_size=0.03)
    assert volume(height, area) == pytest.approx(0.096 * 0.00075, rel=1e-5)
    assert height.max() == pytest.approx(0.096, rel=1e-4)


def test_far_from_the_origin_nothing_changes():
    positions, triangles, uv = grid()
    height, area, _ = snow_on((positions + np.float32(4096.0), triangles, uv), pixel_size=0.01)
    assert volume(height, area) == pytest.approx(0.08, rel=0.01)


# Places


def test_an_upright_wall_gathers_nothing_without_wind_and_tangent_times_depth_in_it():
    still, _, _ = snow_on(box(), steps=16, depth=0.16, resolution=128, pixel_size=0.01)
    for face in range(5):
        assert chart_of_box(still, face).max() == 0.0, f"face {face}"
    assert chart_of_box(still, 5).mean() == pytest.approx(0.16, rel=0.01)

    blown, _, _ = snow_on(
        box(), steps=16, depth=0.16, resolution=128, pixel_size=0.01, direction=wind(45.0), dt=0.0
    )  # towards +y: hits the face at -y
    assert chart_of_box(blown, 2).mean() == pytest.approx(0.16, rel=0.03)
    assert chart_of_box(blown, 3).max() == 0.0
    assert chart_of_box(blown, 0).max() == 0.0


def test_nothing_appears_below_a_thin_plate():
    positions, triangles, uv = box(1.0, 0.002)
    height, _, _ = snow_on((positions, triangles, uv), steps=8, resolution=128, pixel_size=0.02)
    assert chart_of_box(height, 4).max() == 0.0
    assert chart_of_box(height, 5).min() > 0.0


@pytest.mark.parametrize("angle, pixel_size", [(0, 0.004), (80, 0.002), (89, 0.0005)])
def test_a_shadow_is_sharp_and_clean(angle, pixel_size):
    ground = grid(size_x=2.0, size_y=2.0)
    wall = box(0.2, 0.01)
    top = {0: 0.3, 80: 0.1, 89: 0.01}[angle]
    with simulation(pixel_size=pixel_size) as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=256)
        sim.add_object("wall", wall[1], wall[2], receive=False)
        lifted = wall[0] + np.float32((0.0, -0.5, top))
        for _ in range(12):
            sim.step({"ground": ground[0], "wall": lifted}, 0.01, wind(angle))
        height = sim.height("ground")
    # The plate's shadow on the ground, by ray casting against its box.
    steps = (np.arange(256) + 0.5) / 256.0
    spot = (steps - 0.02) / 0.96 * 2.0 - 1.0
    x, y = np.meshgrid(spot, spot)
    tangent = np.tan(np.radians(angle))
    near, far = -0.6 + top * tangent, -0.4 + (top + 0.01) * tangent
    half_pixel = 0.5 * pixel_size / np.cos(np.radians(angle)) + 2.0 / 256.0
    inside = (abs(x) < 0.1 - 0.015) & (y > near + half_pixel) & (y < far - half_pixel)
    outside = (abs(x) > 0.1 + 0.015) | (y < near - half_pixel) | (y > far + half_pixel)
    surface = (abs(x) < 0.98) & (abs(y) < 0.98)
    assert inside.sum() > 100
    assert height[inside & surface].max() == 0.0
    assert height[outside & surface].min() > 0.5 * 0.12


def test_back_faces_occlude_receive_nothing_and_are_reported():
    positions, triangles, uv = grid()
    height, _, statistics = snow_on(
        (positions, triangles[:, ::-1].copy(), uv[:, ::-1].copy()), sides="POSITIVE"
    )
    assert height.max() == 0.0
    assert statistics["back_face_share"] == 1.0


# Persistence


def test_an_occluder_that_leaves_leaves_a_step():
    ground, plate = grid(), grid(size_x=0.5, size_y=2.0)
    with simulation(pixel_size=0.01) as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=64)
        sim.add_object("plate", plate[1], plate[2], receive=False)
        sim.step({"ground": ground[0], "plate": plate[0] + np.float32((0.25, 0.0, 1.0))}, 0.0)
        for _ in range(12):
            sim.step({}, 0.01)
        for _ in range(12):
            sim.step({"plate": plate[0] + np.float32((5.0, 0.0, 1.0))}, 0.01)
        height = sim.height("ground")
    assert height[4:-4, 4:28].mean() == pytest.approx(0.24, rel=0.02)
    assert height[4:-4, 36:-4].mean() == pytest.approx(0.12, rel=0.02)


def test_a_plate_turned_over_keeps_and_then_sheds():
    positions, triangles, uv = grid()
    with simulation(max_depth=1.0, slide_half_life=1.0) as sim:
        sim.add_object("plate", triangles, uv, resolution=64)
        for _ in range(10):
            sim.step({"plate": positions}, 0.01)
        before = sim.statistics()["held_volume"]
        assert before == pytest.approx(0.1, rel=0.01)
        sim.step({"plate": rotated(positions, "x", 180.0)}, 0.0, DOWN, 0.01)
        assert 0.85 * before < sim.statistics()["held_volume"] < before
        for _ in range(10):
            sim.step({}, 0.0, DOWN, 1.0)
        statistics = sim.statistics()
    assert statistics["held_volume"] == 0.0
    total = statistics["total"]
    assert total["slid_volume"] == pytest.approx(total["deposited_volume"], rel=1e-5)


def test_a_moving_object_keeps_its_snow_and_a_stretched_one_its_thickness():
    positions, triangles, uv = grid()
    with simulation() as sim:
        sim.add_object("cart", triangles, uv, resolution=64)
        sim.step({"cart": positions}, 0.1)
        before = sim.height("cart")
        sim.step({"cart": positions * np.float32(2.0) + np.float32(3.0)}, 0.0)
        assert np.array_equal(sim.height("cart"), before)
        statistics = sim.statistics()
    assert statistics["total"]["stretched_volume"] == pytest.approx(0.3, rel=0.01)


def test_a_wind_that_turns_leaves_both_layers():
    with simulation(pixel_size=0.01) as sim:
        positions, triangles, uv = box()
        sim.add_object("box", triangles, uv, resolution=128)
        for bearing in (0.0, 180.0):
            for _ in range(4):
                sim.step({"box": positions}, 0.01, wind(45.0, bearing), 0.0)
        height = sim.height("box")
    assert chart_of_box(height, 2).mean() == pytest.approx(0.04, rel=0.05)
    assert chart_of_box(height, 3).mean() == pytest.approx(0.04, rel=0.05)
    assert chart_of_box(height, 5).mean() == pytest.approx(0.08, rel=0.02)


# Stability


def test_level_ground_holds_max_depth_and_a_slope_less():
    for tilt in (0, 60):
        positions, triangles, uv = grid()
        height, _, _ = snow_on(
            (rotated(positions, "x", tilt), triangles, uv),
            steps=60,
            depth=0.5,
            max_depth=0.2,
            slide_half_life=0.01,
            dt=1.0,
        )
        assert np.median(height) == pytest.approx(0.2 * np.cos(np.radians(tilt)), rel=0.01)


def test_what_is_too_much_halves_in_the_half_life():
    positions, triangles, uv = grid()
    with simulation(max_depth=0.1, slide_half_life=2.0) as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        sim.step({"it": positions}, 0.3, DOWN, 0.0)
        full = np.median(sim.height("it"))
        sim.step({}, 0.0, DOWN, 2.0)
        assert np.median(sim.height("it")) - 0.1 == pytest.approx(0.5 * (full - 0.1), rel=1e-3)


@pytest.mark.parametrize("max_depth", [100.0, 0.05])
def test_the_frame_rate_does_not_matter(max_depth):
    depths = [
        np.median(
            snow_on(
                grid(),
                steps=rate,
                depth=0.1,
                dt=1.0 / rate,
                max_depth=max_depth,
                slide_half_life=0.5,
                pixel_size=0.005,
            )[0][8:-8, 8:-8]
        )
        for rate in (24, 30, 60, 240)
    ]
    assert max(depths) / min(depths) < 1.01


def test_a_rotating_ball_sheds_what_comes_to_its_underside():
    positions, triangles, uv = sphere()
    with simulation(max_depth=0.3, slide_half_life=0.1) as sim:
        sim.add_object("ball", triangles, uv, resolution=128)
        for _ in range(12):
            sim.step({"ball": positions}, 0.01)
        loaded = sim.height("ball")
        assert loaded[96:].max() > 0.1 and loaded[:60].max() == 0.0
        for frame in range(24):
            sim.step({"ball": rotated(positions, "x", 7.5 * (frame + 1))}, 0.0)
        for _ in range(48):
            sim.step({}, 0.0)
        turned = sim.height("ball")
    assert turned[96:].max() < 0.01


def test_scale_does_not_matter():
    pictures = []
    for scale in (0.01, 1.0, 100.0):
        positions, triangles, uv = sphere()
        height, _, _ = snow_on(
            (positions * np.float32(scale), triangles, uv),
            depth=0.08 * scale,
            pixel_size=0.01 * scale,
            max_depth=0.05 * scale,
        )
        pictures.append(height / scale)
    for picture in (pictures[0], pictures[2]):
        assert abs(picture - pictures[1]).mean() < 1e-3 * pictures[1].mean()
