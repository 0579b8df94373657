# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides of a surface take snow: heights are negative on the back."""

import numpy as np
import pytest
from checkpoints import restore, save
from snow_fall import new_simulation
from snow_meshes import STAYS, box, grid, rotated, smooth, sphere, turned_over, wind

DOWN = (0.0, 0.0, -1.0)


def snow_on(mesh, depth=0.1, direction=DOWN, resolution=64, **options):
    positions, triangles, uv = mesh
    with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=100.0) as sim:
        sim.add_object("it", triangles, uv, resolution=resolution, **options)
        sim.step({"it": positions}, depth, direction, 0.0)
        return sim.height("it"), sim.texel_area("it"), sim.statistics()


def lying(height):
    return height[abs(height) > 0.0]


@pytest.mark.parametrize("tilt", [0, 30, 60])
def test_a_card_that_faces_down_gets_on_its_back_what_falls_on_it(tilt):
    positions, triangles, uv = grid()
    mesh = rotated(positions, "x", tilt), triangles, uv
    positive, area, _ = snow_on(mesh)
    back, _, statistics = snow_on(turned_over(mesh))
    assert (back == -positive).all()
    assert abs(lying(back) + 0.1 * np.cos(np.radians(tilt))).max() < 1e-6
    assert float((back * area).sum()) == pytest.approx(-0.1 * np.cos(np.radians(tilt)), rel=1e-5)
    assert statistics["held_volume"] == pytest.approx(0.1 * np.cos(np.radians(tilt)), rel=1e-5)
    assert statistics["back_face_share"] == 0.0


def test_the_sides_that_are_asked_for_take_snow():
    down = turned_over(grid())
    for sides, least, back_share in (("AUTO", -0.1, 0.0), ("BOTH", -0.1, 0.0), ("POSITIVE", 0.0, 1.0)):
        height, _, statistics = snow_on(down, sides=sides)
        assert height.min() == pytest.approx(least) and height.max() == 0.0
        assert statistics["back_face_share"] == back_share
    # An inside-out box shows its backs.
    assert snow_on(turned_over(box()), sides="BOTH")[0].min() == pytest.approx(-0.1)
    assert snow_on(turned_over(box()))[2]["held_volume"] < 0.02 * 0.1
    with pytest.raises(ValueError, match="'it'.*AUTO, POSITIVE, BOTH, not 'LEFT'"):
        snow_on(down, sides="LEFT")


def test_a_closed_box_and_a_ball_with_a_seam_have_no_inside_to_snow_on():
    for mesh in (box(), sphere(0.5, 24, 12)):
        positive = snow_on(mesh, sides="POSITIVE", direction=wind(30.0))[0]
        assert (snow_on(mesh, sides="AUTO", direction=wind(30.0))[0] == positive).all()
        both, area, _ = snow_on(mesh, sides="BOTH", direction=wind(30.0))
        assert -float((both * area).clip(max=0.0).sum()) < 0.02 * float((positive * area).sum())


def tube(radius=0.05, length=1.0, around=8):
    """Along x, open at the end of the lower x, closed at the other by a tip."""
    turn = np.arange(around) * 2.0 * np.pi / around
    ring = np.stack([np.zeros(around), radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    positions = np.concatenate([ring, ring + (length, 0, 0), [(length + radius, 0, 0)]]).astype(np.float32)
    triangles, uv = [], []
    for i in range(around):
        j = (i + 1) % around
        triangles += [(i, i + around, j + around), (i, j + around, j), (i + around, 2 * around, j + around)]
        low, high = 0.02 + 0.96 * i / around, 0.02 + 0.96 * (i + 0.9) / around
        uv += [
            [(0.02, low), (0.8, low), (0.8, high)],
            [(0.02, low), (0.8, high), (0.02, high)],
            [(0.8, low), (0.98, 0.5 * (low + high)), (0.8, high)],
        ]
    return positions, np.array(triangles, np.int32)[:, ::-1].copy(), np.array(uv, np.float32)[:, ::-1].copy()


@pytest.mark.parametrize("radius", [0.05, 0.002])
def test_a_limb_with_an_open_end_gathers_on_its_outside_alone(radius):
    mesh = tube(radius)
    height, area, _ = snow_on(mesh, resolution=128)
    assert height.min() >= 0.0
    assert float((height * area).sum()) == pytest.approx(0.1 * 2.0 * radius * (1.0 + 0.5 * radius), rel=0.02)


def test_no_snow_lies_inside_an_open_tube_under_its_upper_half():
    height, area, _ = snow_on(tube(), resolution=128, sides="BOTH")
    inside = -float((height * area).clip(max=0.0).sum())
    assert inside < 0.03 * float((height * area).clip(min=0.0).sum())


def test_a_bowl_takes_snow_within():
    positions, triangles, uv = sphere(0.5, 24, 12)
    lower = (positions[triangles][..., 2] < 1e-4).all(axis=1)
    height, area, _ = snow_on((positions, triangles[lower], uv[lower]), resolution=128)
    assert height.max() == 0.0
    disc = 12.0 * np.sin(2.0 * np.pi / 24.0) * 0.25
    assert float((height * area).sum()) == pytest.approx(-0.1 * disc, rel=0.02)


def test_two_cards_back_to_back_are_closed():
    top = grid()
    down = turned_over(top)
    positions = np.concatenate([top[0], down[0]])
    triangles = np.concatenate([top[1], down[1] + len(top[0])])
    uv = np.concatenate([top[2] * (0.5, 1.0), down[2] * (0.5, 1.0) + (0.5, 0.0)]).astype(np.float32)
    height, _, statistics = snow_on((positions, triangles, uv))
    assert abs(lying(height) - 0.1).max() < 1e-6
    assert statistics["held_volume"] == pytest.approx(0.1, rel=1e-4)
    assert height[:, 32:].max() == 0.0


# Sheets that turn


def balanced(statistics):
    total = statistics["total"]
    return total["held_volume"] + total["slid_volume"] == pytest.approx(
        total["deposited_volume"] + total["stretched_volume"], rel=1e-6, abs=1e-9
    )


def test_what_lies_on_a_flag_slides_off_when_it_turns_over():
    positions, triangles, uv = grid()
    with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=0.5, slide_half_life=0.1) as sim:
        sim.add_object("flag", triangles, uv, resolution=64)
        sim.step({"flag": positions}, 0.1)
        assert lying(sim.height("flag")).min() == pytest.approx(0.1)
        sim.step({"flag": rotated(positions, "x", 180.0)}, 0.0, dt=2.0)
        statistics = sim.statistics()
        assert abs(sim.height("flag")).max() == 0.0
        assert statistics["slid_volume"] == pytest.approx(0.1, rel=1e-5)
        sim.step({}, 0.02)
        assert lying(sim.height("flag")).max() == pytest.approx(-0.02)
        assert balanced(sim.statistics())


def test_new_snow_on_the_upper_side_throws_off_at_once_what_hangs_below():
    positions, triangles, uv = grid()
    with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=0.5, slide_half_life=100.0) as sim:
        sim.add_object("flag", triangles, uv, resolution=64)
        sim.step({"flag": positions}, 0.1)
        sim.step({"flag": rotated(positions, "x", 180.0)}, 0.02, dt=0.01)
        assert lying(sim.height("flag")).max() == pytest.approx(-0.02)
        statistics = sim.statistics()
        assert statistics["deposited_volume"] == pytest.approx(0.02, rel=1e-4)
        assert statistics["slid_volume"] == pytest.approx(0.1, rel=1e-4)
        assert statistics["held_volume"] == pytest.approx(0.02, rel=1e-4)
        assert balanced(statistics)


def test_wind_from_below_takes_nothing_from_the_upper_side():
    positions, triangles, uv = grid()
    card = rotated(positions, "x", 60.0)  # its positive side looks up and to -y
    with new_simulation(pixel_size=0.01, repose=STAYS, max_depth=0.5, slide_half_life=2.0) as sim:
        sim.add_object("card", triangles, uv, resolution=64)
        sim.step({"card": card}, 0.02, DOWN, 0.0)
        before = sim.height("card")
        sim.step({}, 0.02, wind(80.0, 180.0), 0.0)
        assert (sim.height("card") == before).all()
        statistics = sim.statistics()
        assert statistics["deposited_volume"] > 0.01
        assert statistics["slid_volume"] == pytest.approx(statistics["deposited_volume"], rel=1e-5)
        assert balanced(statistics)


def test_snow_finds_its_repose_below_as_above():
    positions, triangles, uv = grid(0.5, 0.5, cells=4)
    maps = []
    for mesh in ((positions, triangles, uv), turned_over((positions, triangles, uv))):
        with new_simulation(pixel_size=0.01, max_depth=1.0) as sim:
            sim.add_object("card", mesh[1], mesh[2], resolution=64)
            for step in range(12):
                sim.step({"card": mesh[0]} if step == 0 else {}, 0.01, dt=0.2)
            maps.append(sim.height("card"))
            assert balanced(sim.statistics())
            assert sim.statistics()["total"]["slid_volume"] > 0.01 * 0.12 * 0.25
    assert abs(maps[0] + maps[1]).max() < 1e-4
    assert maps[1].max() <= 0.0


def test_a_card_shelters_what_is_below_whichever_way_it_faces():
    ground = grid(2.0, 2.0)
    for leaf in (grid(), turned_over(grid())):
        with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=100.0) as sim:
            sim.add_object("ground", ground[1], ground[2], resolution=64)
            sim.add_object("leaf", leaf[1], leaf[2], resolution=64)
            sim.step({"ground": ground[0], "leaf": leaf[0] + np.float32((0, 0, 0.5))}, 0.1, DOWN, 0.0)
            assert abs(sim.height("ground")[20:44, 20:44]).max() == 0.0
            assert sim.statistics()["held_volume"] == pytest.approx(0.4, rel=0.01)


def test_a_leaf_that_faces_down_carries_what_its_alpha_leaves():
    positions, triangles, uv = turned_over(grid())
    corners = (positions[triangles][..., :2] + 0.5).astype(np.float32)
    alpha = {
        "uv": corners,
        "image": np.zeros(2, np.int32),
        "images": [np.array([[255, 0]], np.uint8)],
        "extensions": ["EXTEND"],
    }
    height, area, _ = snow_on((positions, triangles, uv), alpha=alpha)
    assert height.max() == 0.0
    assert float((height * area).sum()) == pytest.approx(-0.05, rel=0.03)


def wavy_sheet():
    """A steep sheet, of which some parts hold snow on the positive side and others on the back."""
    positions, triangles, uv = grid(cells=24)
    positions = positions.copy()
    positions[:, 2] = 0.1 * np.sin(positions[:, 0] * 9.0)
    return rotated(positions, "y", 75.0), triangles, uv


def test_a_wavy_smooth_sheet_keeps_its_volume_on_both_sides():
    mesh = wavy_sheet()
    flat, area, _ = snow_on(mesh, resolution=128)
    smoothed, _, _ = snow_on(mesh, resolution=128, shading=smooth(*mesh[:2]))
    assert flat.min() < 0.0 < flat.max()
    volume = float((abs(flat) * area).sum())
    assert float((abs(smoothed) * area).sum()) == pytest.approx(volume, rel=0.03)


# Output


def test_smoothing_normals_and_seams_work_below_as_above():
    positions, triangles, uv = grid(cells=8)
    mesh = positions + 0.0, triangles, uv
    shelter = grid(0.5, 0.5)
    outputs = []
    for leaf in (mesh, (mesh[0], mesh[1][:, ::-1].copy(), mesh[2][:, ::-1].copy())):
        with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=100.0, blur_radius=0.03) as sim:
            sim.add_object("leaf", leaf[1], leaf[2], resolution=64)
            sim.add_object("shelter", shelter[1], shelter[2], receive=False)
            sim.step({"leaf": leaf[0], "shelter": shelter[0] + np.float32((0.2, 0, 0.5))}, 0.1, DOWN, 0.0)
            outputs.append(sim.output("leaf"))
    above, below = outputs
    assert abs(above["height"] + below["height"]).max() < 1e-6
    assert above["height"].max() > 0.09 and below["height"].max() < 1e-6
    # Of opposite heights the slopes are opposite.
    assert abs(above["normal"][..., :2] + below["normal"][..., :2]).max() < 1e-4


def test_seams_are_level_below_as_above():
    mesh = sphere(0.5, 24, 12)
    lower = (mesh[0][mesh[1]][..., 2] < 1e-4).all(axis=1)
    bowl = mesh[0], mesh[1][lower], mesh[2][lower]
    outputs = []
    for positions, triangles, uv in (turned_over(bowl), bowl):
        with new_simulation(pixel_size=0.02, repose=STAYS, max_depth=100.0, blur_radius=0.02) as sim:
            sim.add_object("bowl", triangles, uv, resolution=64)
            sim.step({"bowl": positions}, 0.1, DOWN, 0.0)
            outputs.append(sim.output("bowl", normal=False)["height"])
    assert abs(outputs[0] + outputs[1]).max() < 1e-5
    assert outputs[0].max() > 0.09


def test_a_checkpoint_keeps_what_lies_on_the_back(tmp_path):
    positions, triangles, uv = turned_over(grid())
    path = str(tmp_path / "state")
    with new_simulation(pixel_size=0.02, repose=STAYS) as sim:
        sim.add_object("card", triangles, uv, resolution=64)
        sim.step({"card": positions}, 0.1)
        save(sim, path)
        sim.step({}, 0.1)
        whole = sim.height("card")
    with new_simulation(pixel_size=0.02, repose=STAYS) as sim:
        sim.add_object("card", triangles, uv, resolution=64)
        sim.step({"card": positions}, 0.0)
        restore(sim, path)
        sim.step({}, 0.1)
        assert (sim.height("card") == whole).all()


def test_tiles_change_nothing_on_either_side():
    positions, triangles, uv = wavy_sheet()
    maps = []
    for tile_size in (64, 2048):
        with new_simulation(
            pixel_size=0.005, repose=STAYS, max_depth=1.0, flutter=np.radians(3.0), tile_size=tile_size
        ) as sim:
            sim.add_object("it", triangles, uv, resolution=128, shading=smooth(positions, triangles))
            for _ in range(3):
                sim.step({"it": positions}, 0.02)
            maps.append(sim.height("it"))
    assert (maps[0] == maps[1]).all() and maps[0].min() < 0.0 < maps[0].max()
