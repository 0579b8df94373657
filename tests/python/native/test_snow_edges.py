# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow at the edges of real geometry: it joins what lies a step lower, and closes narrow gaps."""

import numpy as np
import pytest
from snow_fall import DOWN, FRAME, fall, sheet, snow_over
from snow_meshes import bevelled_box, cylinder, sphere, wind
from snow_pieces import bevelled_slats, paving, pieces, slab, slats, tile_courses, top_chart


def snow_on(meshes, depth=0.2, steps=32, shade=()):
    sim = snow_over(meshes, shade, cohesion=0.005)
    fall(sim, meshes, depth, steps)
    return sim


def held(sim, name):
    return float((np.abs(sim.height(name)) * sim.texel_area(name)).sum())


def test_tile_courses_hold_as_much_as_one_slab():
    tiled = snow_on({"roof": pieces(tile_courses())})
    whole = snow_on({"roof": pieces(slab())})
    assert held(tiled, "roof") == pytest.approx(held(whole, "roof"), rel=0.06)


def test_snow_closes_the_joints_of_paving():
    stones = pieces(paving())
    sim = snow_on({"bed": sheet(2.0, -0.04), "stones": stones})
    middle = top_chart(stones, 4, sim.height("stones"))
    # The outer end of the bed is 25 cm away.
    assert middle.mean() > 0.99 * 0.2
    assert middle.min() > 0.95 * 0.2


GAP = 0.015
PLACES = [(i - 2) * (0.06 + GAP) for i in range(5)]


def on_the_middle_slat(places, depth=0.2, steps=32):
    mesh = pieces(slats(places))
    sim = snow_on({"ground": sheet(), "slats": mesh}, depth, steps)
    return top_chart(mesh, places.index(0.0), sim.height("slats"))[:, 30:70]


def test_snow_closes_the_gaps_between_slats():
    assert on_the_middle_slat(PLACES).mean() > 0.75 * 0.2
    assert on_the_middle_slat([0.0]).mean() < 0.25 * 0.2


@pytest.mark.parametrize("steps", [16, 64])
def test_deep_snow_lies_over_slats_as_on_one_board(steps):
    """However many steps it takes to get deep."""
    places = [(i - 2.5) * (0.06 + GAP) for i in range(6)]
    width = places[-1] - places[0] + 0.06
    on_slats = snow_on({"seat": pieces(slats(places))}, 0.3, steps)
    on_board = snow_on({"seat": pieces([((0.0, 0.0, 0.4875), (1.0, width, 0.025), 0.0)])}, 0.3, steps)
    # The gaps have no map.
    share = len(places) * 0.06 / width
    assert held(on_slats, "seat") == pytest.approx(share * held(on_board, "seat"), rel=0.06)


def test_thin_snow_falls_through_a_gap():
    wide = [-0.12, 0.0, 0.12]
    assert np.array_equal(on_the_middle_slat(wide, 0.02), on_the_middle_slat([0.0], 0.02))


@pytest.mark.parametrize("segments", [1, 2, 3])
def test_walls_in_the_chart_of_the_top_close_gaps_too(segments):
    """Unwrapping by angle joins the lower faces of a bevel with the wall below them."""
    sharp, bevelled = pieces(slats(PLACES)), bevelled_slats(PLACES, segments)
    on_sharp, on_bevelled = snow_on({"seat": sharp}), snow_on({"seat": bevelled})
    assert held(on_bevelled, "seat") > 0.8 * held(on_sharp, "seat")


@pytest.mark.parametrize("with_walls", [1, 2, 3])
def test_bevels_in_the_chart_of_the_walls_close_gaps_too(with_walls):
    """They carry no snow themselves."""
    sharp, bevelled = pieces(slats(PLACES)), bevelled_slats(PLACES, 3, with_walls=with_walls)
    assert held(snow_on({"seat": bevelled}), "seat") > 0.8 * held(snow_on({"seat": sharp}), "seat")


@pytest.mark.parametrize("with_walls", [None, 2])
@pytest.mark.parametrize("texel", [0.0055, 0.007])
def test_snow_on_texels_that_are_partly_wall_closes_gaps(texel, with_walls):
    """It is as high as it stands on the other part."""
    sharp = held(snow_on({"seat": pieces(slats(PLACES))}, steps=16), "seat")
    bevelled = bevelled_slats(PLACES, 2, texel=texel, with_walls=with_walls)
    assert held(snow_on({"seat": bevelled}, steps=16), "seat") > 0.95 * sharp


@pytest.mark.parametrize("texel", [0.0025, 0.005, 0.01])
@pytest.mark.parametrize("segments", [1, 2, 3])
def test_snow_falls_over_walls_in_the_chart_of_the_top(segments, texel):
    """Wherever texels lie that are partly wall."""
    broad = snow_on({"seat": bevelled_slats([0.0], segments, texel=texel)})
    narrow = snow_on({"seat": bevelled_slats([0.0], segments, bevel=0.001, texel=texel)})
    assert held(broad, "seat") == pytest.approx(held(narrow, "seat"), rel=0.2)
    assert held(broad, "seat") < 1.1 * held(snow_on({"seat": pieces(slats([0.0]))}), "seat")


@pytest.mark.parametrize("bevel, segments", [(0.02, 1), (0.02, 3), (0.06, 8)])
@pytest.mark.parametrize("steps", [16, 64])
def test_a_box_with_low_bevels_or_roundings_holds_as_much_as_a_sharp_one(bevel, segments, steps):
    rounded = snow_on({"box": bevelled_box(bevel, segments, 0.8, 0.5)}, steps=steps)
    sharp = snow_on({"box": pieces([((0.0, 0.0, 0.25), (0.8, 0.8, 0.5), 0.0)])}, steps=steps)
    assert held(rounded, "box") == pytest.approx(held(sharp, "box"), rel=0.03)


@pytest.mark.parametrize("mesh", [sphere(0.1), cylinder(0.1, 1.0, axis="x")], ids=["ball", "log"])
def test_nothing_level_goes_on_inland_of_a_ball_or_a_log(mesh):
    """The slopes of repose that touch their sides meet 2.37 radii over the middle."""
    heights = snow_on({"round": (*mesh, 256)}, 0.3).height("round")
    assert 0.09 < heights.max() < 0.137


def across_a_joint(lift, height, depth=0.2, gap=GAP):
    """Thickness on the last 3 cm of a stone, and on the first 3 cm of one whose top is higher by `lift`."""
    middle = 0.3 + gap / 2
    boxes = [((-middle, 0.0, -0.05), (0.6, 0.6, 0.1)), ((middle, 0.0, lift - height / 2), (0.6, 0.6, height))]
    stones = pieces([(*box, 0.0) for box in boxes])
    heights = snow_on({"stones": stones}, depth).height("stones")
    return top_chart(stones, 0, heights)[20:-20, -3:], top_chart(stones, 1, heights)[20:-20, :3]


def beside_a_joint(lift, height):
    return across_a_joint(lift, height)[0]


@pytest.mark.parametrize("lift", [0.0, 0.02, 0.03])
def test_stones_that_lie_unevenly_close_their_joints(lift):
    assert beside_a_joint(lift, 0.1).mean() > 0.9 * 0.2


@pytest.mark.parametrize("lift", [0.07, 0.15])
@pytest.mark.parametrize("depth", [0.2, 0.3])
def test_a_joint_below_a_step_holds_as_much_as_none(lift, depth):
    lower, upper = across_a_joint(lift, 0.5, depth)
    lower_closed, upper_closed = across_a_joint(lift, 0.5, depth, gap=0.0005)
    assert upper.mean() == pytest.approx(upper_closed.mean(), abs=GAP + 0.01)
    assert lower.mean() == pytest.approx(lower_closed.mean(), abs=GAP + 0.01)


def test_a_ledge_within_a_joint_leaves_it_closed():
    stones = [((side * 0.33, 0.0, -0.25), (0.6, 0.6, 0.5), 0.0) for side in (-1, 1)]
    ledge = ((0.01, 0.0, -0.35), (0.04, 0.6, 0.4), 0.0)
    beside = {
        name: top_chart(mesh := pieces(boxes), 0, snow_on({"s": mesh}).height("s"))[20:-20, -3:].mean()
        for name, boxes in (("plain", stones), ("ledge", [*stones, ledge]))
    }
    assert beside["ledge"] == pytest.approx(beside["plain"], abs=0.01)
    assert beside["plain"] > 0.12


def test_snow_leans_against_a_wall_beyond_a_joint():
    assert beside_a_joint(2.0, 2.1).mean() > 0.9 * 0.2


def test_snow_beside_a_joint_is_no_higher_than_that_on_the_stone_beyond():
    lower, upper = across_a_joint(0.1, 0.2)
    assert lower.mean() < 0.1 + upper.mean()


def test_a_bare_neighbour_holds_no_snow_up():
    slat, bare = pieces(slats([0.0])), pieces(slats([0.06 + GAP]))
    beside = held(snow_on({"slat": slat, "bare": bare}, shade=("bare",)), "slat")
    assert beside == pytest.approx(held(snow_on({"slat": slat}), "slat"), rel=0.05)


def test_a_shot_is_the_same_again_while_its_texels_are_joined():
    """The memory of what lies beyond an outlet must not outlive the squares of texels to which it belongs."""
    *mesh, resolution = pieces(slats(PLACES))
    fine = {"seat": (*mesh, 4 * resolution)}
    first = snow_on(fine, 0.3, 16).height("seat")
    held_back = []
    for size in (1, 10, 100, 1000, 10000, 100000):
        held_back.append(np.zeros(size))  # other addresses
        assert (snow_on(fine, 0.3, 16).height("seat") == first).all()


def test_gaps_between_objects_close_too():
    places = {f"slat {i}": pieces(slats([y])) for i, y in enumerate(PLACES)}
    sim = snow_on({"ground": sheet()} | places)
    assert top_chart(places["slat 2"], 0, sim.height("slat 2"))[:, 30:70].mean() > 0.75 * 0.2


@pytest.mark.parametrize("angle", [0.0, 40.0])
@pytest.mark.parametrize(
    "least, boxes",
    [
        (0.010, [((x, 0.0, 0.45), (0.04, 0.02, 0.9), 0.0) for x in (-0.2, -0.1, 0.0, 0.1, 0.2)]),
        (0.015, [((0.0, 0.0, 0.9), (1.0, 0.03, 0.03), 0.0)]),
    ],
    ids=["pickets", "a rail"],
)
def test_thin_things_hold_snow_in_a_wind_too(least, boxes, angle):
    meshes = {"ground": sheet(), "fence": pieces(boxes)}
    sim = snow_over(meshes, cohesion=0.005)
    fall(sim, meshes, direction=wind(angle))
    tops = [top_chart(meshes["fence"], piece, sim.height("fence")) for piece in range(len(boxes))]
    assert min(top.mean() for top in tops) > least


def test_without_landing_neighbours_make_no_difference():
    def second(meshes, landing):
        sim = snow_over(meshes, cohesion=0.005, landing=landing)
        fall(sim, meshes)
        return sim.height("slat 2")

    meshes = {f"slat {i}": pieces(slats([y])) for i, y in enumerate(PLACES)}
    alone = {"slat 2": meshes["slat 2"]}
    assert second(meshes, False).tobytes() == second(alone, False).tobytes()
    assert np.abs(second(meshes, True) - second(alone, True)).max() > 0.05


def test_snow_falls_when_its_neighbour_moves_away():
    meshes = {f"slat {i}": pieces(slats([y])) for i, y in enumerate(PLACES)}
    meshes["ground"] = sheet()
    sim = snow_on(meshes)
    before = held(sim, "slat 2")
    away = {
        name: meshes[name][0] + np.float32([0.0, side, 0.0])
        for name, side in (("slat 0", -1), ("slat 1", -1), ("slat 3", 1), ("slat 4", 1))
    }
    sim.step(away, 0.0, DOWN, FRAME)
    for _ in range(8):
        sim.step({}, 0.0, DOWN, 1.0)
    assert held(sim, "slat 2") < 0.4 * before


def test_snow_on_the_ground_does_not_flow_into_a_body():
    body = pieces([((0.0, 0.0, 0.5), (0.8, 0.8, 1.0), 0.0)])
    sim = snow_on({"body": body, "ground": sheet()}, shade=["body"])
    heights = sim.height("ground")
    inside = heights[96:160, 96:160]
    assert inside.shape == (64, 64) and inside.max() == 0.0
    # Snow stands against it.
    assert heights[128, 74] > 0.19


def test_snow_flows_under_a_table_as_far_as_there_is_room():
    table = pieces([((0.0, 0.0, 0.75), (0.8, 0.8, 0.04), 0.0)])
    low = pieces([((0.0, 0.0, 0.04), (0.8, 0.8, 0.04), 0.0)])
    high = snow_on({"ground": sheet(), "table": table}, shade=["table"]).height("ground")
    under = snow_on({"ground": sheet(), "table": low}, shade=["table"]).height("ground")
    # The table begins at column 78.4; texels are 8 mm wide.
    assert high[128, 82] > 0.035
    assert 0.015 < under[128, 79:90].max() < 0.03


def test_a_ledge_that_ends_in_a_wall_sheds_nothing_there():
    ledge = pieces([((0.0, 0.0, 0.5), (1.0, 0.2, 0.05), 0.0)])
    wall = pieces([((0.0, 0.25, 1.0), (1.4, 0.4, 2.0), 0.0)])
    joined = snow_on({"ledge": ledge, "wall": wall}, shade=["wall"])
    # The wall's face is at y = 0.05, 15 texels from the ledge's free edge.
    row = top_chart(ledge, 0, joined.height("ledge"))[:, 50]
    assert row[10:14].min() > 0.195
    assert row[14] > 0.18


def test_the_same_fall_gives_the_same_bytes():
    meshes = {"bed": sheet(2.0, -0.04), "stones": pieces(paving())}
    once, again = (snow_on(meshes).height("stones") for _ in range(2))
    assert np.array_equal(once, again)
