# SPDX-License-Identifier: GPL-3.0-or-later
"""Places and amounts of snow, compared with ray casting, on several layouts and shapes."""

import numpy as np
import pytest
import snowbough_native as native
from snow_fall import new_simulation
from snow_meshes import STAYS, box, grid, rotated, sphere, wind
from snow_rays import first_hits, lit_shares, near_any, outline_area, sees_the_fall, texel_points

DOWN = (0.0, 0.0, -1.0)
RESOLUTION = 256


def snow_under(meshes, receiver, direction, pixel_size, steps=12):
    with new_simulation(repose=STAYS, pixel_size=pixel_size, max_depth=1e6) as sim:
        for name, (_, triangles, uv) in meshes.items():
            sim.add_object(name, triangles, uv, resolution=RESOLUTION, receive=name == receiver)
        for step in range(steps):
            sim.step(
                {name: mesh[0] for name, mesh in meshes.items()} if step == 0 else {}, 0.01, direction, 0.0
            )
        return sim.height(receiver).ravel(), sim.texel_area(receiver).ravel()


def test_rays_know_a_shadow_and_an_outline():
    ground, plate = grid(4.0, 4.0), grid(1.0, 1.0)
    lifted = (plate[0] + np.float32((0.0, 0.0, 1.0)))[plate[1]]
    points = np.array([(0.0, 0.0, 0.0), (0.49, -0.49, 0.0), (0.51, 0.0, 0.0), (9.0, 9.0, 0.0)])
    depth = first_hits(points, np.concatenate([ground[0][ground[1]], lifted]), DOWN, margin=1e-3)
    assert depth == pytest.approx([-1.0, -1.0, np.inf, np.inf])
    assert outline_area(lifted, DOWN, 300) == pytest.approx(1.0, rel=1e-6)
    assert outline_area(rotated(plate[0], "x", 60.0)[plate[1]], DOWN, 300) == pytest.approx(0.5, rel=1e-2)


@pytest.mark.parametrize("angle", [0, 60])
@pytest.mark.parametrize("receiver", ["ground", "box"])
def test_snow_lies_where_rays_arrive(receiver, angle):
    plate = grid(0.8, 0.8)
    meshes = {
        "box": box(1.0, 0.8),
        "ground": grid(4.0, 4.0),
        "plate": (rotated(plate[0], "y", 20.0) + np.float32((0.3, 0.4, 1.4)), *plate[1:]),
    }
    pixel_size = {"ground": 0.01, "box": 0.004}[receiver]
    direction = wind(angle, 20.0)
    height, area = snow_under(meshes, receiver, direction, pixel_size)
    points, normals, texel, _ = texel_points(native, *meshes[receiver], RESOLUTION)
    scene = np.concatenate([mesh[0][mesh[1]] for mesh in meshes.values()])
    lit = sees_the_fall(points, normals, scene, direction, 0.25 * pixel_size)
    snowed, weight = height[texel] > 0.0, area[texel]
    assert lit.sum() > 1000
    # At 256 a border holds four times the share of the texels that it holds at 1024.
    assert weight[snowed & lit].sum() > (0.97 if receiver == "ground" else 0.95) * weight[snowed | lit].sum()
    assert weight[lit & ~snowed].sum() < 0.002 * weight.sum()


def test_no_snow_lies_far_from_where_rays_arrive():
    ball = sphere()
    pixel_size, direction = 0.01, wind(30.0)
    height, area = snow_under({"ball": ball}, "ball", direction, pixel_size)
    points, normals, texel, _ = texel_points(native, *ball, RESOLUTION)
    lit = sees_the_fall(points, normals, ball[0][ball[1]], direction, 0.25 * pixel_size)
    far = ~near_any(points, points[lit], 2.0 * pixel_size + np.sqrt(area.max()))
    assert far.sum() > 10_000
    assert height[texel[far]].max() == 0.0


def folded_strip(resolution=64, edge=20.3):
    """A level strip, 1 m along Y and 20.3 mm wide, that folds at x = 0 and goes back below itself: one chart
    of texels 1 mm wide, of which the twenty-first has its centre behind the fold."""
    x, z = np.array([-edge, 0.0, -edge]) * 1e-3, np.array([0.0, 0.0, -2.0 * edge]) * 1e-3
    positions = np.array([(x[k], y, z[k]) for y in (-0.5, 0.5) for k in range(3)], np.float32)
    u = np.array([0.0, edge, edge * (1.0 + 5.0**0.5)]) / resolution
    uv = np.array([(u[k], v) for v in (0.1, 0.9) for k in range(3)], np.float32)
    triangles = np.array([(k, k + 1, k + 4) for k in (0, 1)] + [(k, k + 4, k + 3) for k in (0, 1)], np.int32)
    return positions, triangles, np.minimum(uv[triangles], 1.0)


def test_a_texel_round_an_edge_takes_snow_by_the_part_that_faces_the_fall():
    mesh = folded_strip()
    with new_simulation(repose=STAYS, pixel_size=0.003, max_depth=1e6) as sim:
        sim.add_object("it", mesh[1], mesh[2], resolution=64)
        for step in range(8):
            sim.step({"it": mesh[0]} if step == 0 else {}, 0.01)
        height = sim.height("it")[10:54]
    table = native.texel_table(mesh[1], mesh[2], 64)
    share, _ = lit_shares(table, mesh, 64, np.arange(len(table["texel"])), mesh[0][mesh[1]], DOWN, 1e-5, 10)
    at_edge = share[np.isin(table["texel"], np.arange(10, 54) * 64 + 20)]
    assert at_edge == pytest.approx(0.3, abs=0.01)
    assert height[:, 20].min() > 0.0
    assert height[:, 20].mean() < 0.5 * height[:, 19].mean()
    assert height[:, 21:].max() == 0.0


def test_a_texel_round_an_edge_lies_on_the_back_where_that_is_outside():
    positions, triangles, uv = folded_strip()
    maps = []
    for faces, corners in ((triangles, uv), (triangles[:, ::-1].copy(), uv[:, ::-1].copy())):
        with new_simulation(pixel_size=0.003, max_depth=1e6, repose=STAYS) as sim:
            sim.add_object("it", faces, corners, resolution=64)
            for step in range(8):
                sim.step({"it": positions} if step == 0 else {}, 0.01)
            maps.append(sim.height("it"))
    assert abs(maps[0] + maps[1]).max() < 1e-6
    assert maps[1][10:54, 20].max() < 0.0


@pytest.mark.parametrize("tilt", [0, 40])
def test_nothing_lies_close_beneath_a_plate_of_the_same_mesh(tilt):
    pixel_size = 0.01
    ground, plate = grid(1.0, 1.0), grid(0.4, 0.4)
    lifted = plate[0] + np.float32((0.0, 0.0, 0.5 * pixel_size))
    positions = rotated(np.concatenate([ground[0], lifted]), "x", tilt)
    uv = np.concatenate([ground[2] * (0.5, 1.0), plate[2] * (0.5, 1.0) + (0.5, 0.0)]).astype(np.float32)
    mesh = positions, np.concatenate([ground[1], plate[1] + 4]), uv
    height, _ = snow_under({"it": mesh}, "it", DOWN, pixel_size)
    flat = np.concatenate([ground[0], lifted]), mesh[1], uv
    points, _, texel, _ = texel_points(native, *flat, RESOLUTION)
    on_ground = points[:, 2] < 0.25 * pixel_size
    beneath = on_ground & (abs(points[:, :2]).max(axis=1) < 0.2 - 1.5 * pixel_size)
    beside = on_ground & (abs(points[:, :2]).max(axis=1) > 0.2 + 1.5 * pixel_size)
    assert beneath.sum() > 1000
    assert height[texel[beneath]].max() == 0.0
    assert height[texel[beside]].min() > 0.0


@pytest.mark.parametrize("layout", ["turned", "small", "every triangle cut off"])
def test_a_sphere_gathers_the_same_on_every_layout(layout):
    positions, triangles, uv = sphere(around=24, rings=12)
    if layout == "turned":
        turn = np.radians(27.0)
        uv = (uv - 0.5) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) * 0.7 + 0.5
    elif layout == "small":
        uv = uv * 0.2 + 0.3
    else:
        cell = np.stack(np.divmod(np.arange(len(triangles)), 24), axis=1)[:, None, :] / 24.0
        uv = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]]) / 24.0 + cell
    with new_simulation(repose=STAYS, pixel_size=0.01, max_depth=1e6) as sim:
        sim.add_object("ball", triangles, uv.astype(np.float32), resolution=128)
        for step in range(12):
            sim.step({"ball": positions} if step == 0 else {}, 0.01)
        total = sim.statistics()["total"]
        held = float((sim.height("ball").astype(np.float64) * sim.texel_area("ball")).sum())
    disc = 12.0 * np.sin(2.0 * np.pi / 24.0) * 0.25  # the outline is a 24-gon
    assert held + total["slid_volume"] == pytest.approx(0.12 * disc, rel=0.01)
    assert total["deposited_volume"] == pytest.approx(0.01 * total["visible_area"], rel=1e-3)


def test_a_pixel_of_ten_texels_and_one_of_a_tenth_gather_the_same():
    positions, triangles, uv = sphere()
    volumes = []
    for pixel_size in (0.0028, 0.28):  # a texel of the 128 map is about 28 mm
        with new_simulation(repose=STAYS, pixel_size=pixel_size, max_depth=1e6) as sim:
            sim.add_object("ball", triangles, uv, resolution=128)
            for step in range(48):
                sim.step({"ball": positions} if step == 0 else {}, 0.01)
            volumes.append(sim.statistics()["total"]["deposited_volume"])
    disc = 24.0 * np.sin(2.0 * np.pi / 48.0) * 0.25
    assert volumes == pytest.approx([0.48 * disc] * 2, rel=0.01)
