# SPDX-License-Identifier: GPL-3.0-or-later
"""SnowSimulation with alpha images: snow falls through their holes and lies on the rest."""

import numpy as np
import pytest
from snow_fall import new_simulation
from snow_meshes import STAYS, grid


def card(z, size=1.0):
    """A level square whose UVs fill 0.02 to 0.98 of the map."""
    positions, triangles, uv = grid(size, size)
    return positions + np.array([0, 0, z], np.float32), triangles, uv


def filling(positions, triangles):
    """UVs that put a whole image on a square."""
    corners = positions[triangles][..., :2]
    return ((corners - corners.min((0, 1))) / np.ptp(corners, axis=(0, 1))).astype(np.float32)


def alpha_of(mesh, image, extension="REPEAT"):
    positions, triangles, _ = mesh
    return {
        "uv": filling(positions, triangles),
        "image": np.zeros(len(triangles), np.int32),
        "images": [np.asarray(image, np.uint8)],
        "extensions": [extension],
    }


# 4 x 4 texels: the middle four are a hole.
RING = np.pad(np.zeros((2, 2)), 1, constant_values=255)


def snow(leaf_alpha, leaf_receives=False, steps=4, **settings):
    """Maps of the ground and, where it has one, of the leaf 0.5 m above it; and the statistics."""
    ground, leaf = card(0.0, 2.0), card(0.5)
    with new_simulation(repose=STAYS, pixel_size=0.01, max_depth=100.0, **settings) as sim:
        sim.add_object("ground", ground[1], ground[2], resolution=128)
        sim.add_object("leaf", leaf[1], leaf[2], resolution=128, receive=leaf_receives, alpha=leaf_alpha)
        for _ in range(steps):
            sim.step({"ground": ground[0], "leaf": leaf[0]}, 0.01)
        maps = {name: sim.height(name) for name in ("ground", *(["leaf"] if leaf_receives else []))}
        return maps, sim.statistics()


@pytest.mark.parametrize("mapping", ["COMPUTE", "GEOMETRY"])
def test_the_ground_below_a_hole_gets_snow_and_below_the_rest_none(mapping):
    maps, _ = snow(alpha_of(card(0.5), RING), mapping=mapping)
    ground = maps["ground"]
    assert ground[56:72, 56:72].mean() == pytest.approx(0.04, rel=0.02)
    # Half-way between the hole's edge and the leaf's, on all four sides.
    for row, column in ((64, 41), (64, 87), (41, 64), (87, 64)):
        assert ground[row - 3 : row + 3, column - 3 : column + 3].max() == 0


def test_a_receiver_gathers_snow_only_where_it_is_there():
    maps, _ = snow(alpha_of(card(0.5), RING), leaf_receives=True)
    leaf = maps["leaf"]
    assert leaf[40:88, 40:88].max() == 0
    assert leaf[8:24, 8:120].mean() == pytest.approx(0.04, rel=0.02)


def test_what_falls_through_the_hole_lies_below_and_nothing_is_lost():
    _, statistics = snow(alpha_of(card(0.5), RING), leaf_receives=True, steps=16)
    for name, area in (("leaf", 0.75), ("ground", 3.25)):
        total = statistics["objects"][name]["total"]
        assert total["visible_area"] == pytest.approx(16 * area, rel=0.005)
        assert total["deposited_volume"] == pytest.approx(0.01 * total["visible_area"], rel=1e-3)


def test_half_alpha_is_there():
    opaque, _ = snow(None)
    half, _ = snow(alpha_of(card(0.5), np.full((4, 4), 128)))
    less, _ = snow(alpha_of(card(0.5), np.full((4, 4), 127)))
    assert np.array_equal(half["ground"], opaque["ground"])
    assert less["ground"][64, 64] > 0 and opaque["ground"][64, 64] == 0


def test_two_runs_and_other_tiles_end_with_the_same_bits():
    alpha = alpha_of(card(0.5), np.random.default_rng(7).integers(0, 256, (33, 57)))
    first, _ = snow(alpha, True, noise_density=0.5, flutter=np.radians(5.0))
    again, _ = snow(alpha, True, noise_density=0.5, flutter=np.radians(5.0))
    tiled, _ = snow(alpha, True, noise_density=0.5, flutter=np.radians(5.0), tile_size=64)
    for name in first:
        assert np.array_equal(first[name], again[name]) and np.array_equal(first[name], tiled[name])


def test_memory_counts_an_image_that_many_objects_show_once():
    mesh = card(0.0)
    image = np.zeros((1024, 1024), np.uint8)

    def taken(alphas):
        with new_simulation(repose=STAYS) as sim:
            for number, alpha in enumerate(alphas):
                sim.add_object(f"leaf{number}", mesh[1], mesh[2], receive=False, alpha=alpha)
            return sim.memory_estimate()["total"]

    plain = taken([None] * 8)
    assert taken([alpha_of(mesh, image) for _ in range(8)]) - plain < 2**17 + 2**12
    assert (
        taken([alpha_of(mesh, image + np.uint8(200) * (number == 0)) for number in range(8)]) - plain > 2**18
    )


@pytest.mark.parametrize(
    "change, message",
    [
        ({"uv": np.zeros((2, 2, 2), np.float32)}, r"uv must have shape \(T, 3, 2\), T = 2"),
        ({"image": np.zeros(3, np.int32)}, r"image must have shape \(T,\), T = 2"),
        ({"image": np.array([0, 1], np.int32)}, "refers to image 1 of 1"),
        ({"images": [np.zeros((0, 4), np.uint8)]}, "4 x 0 texels"),
        ({"images": [np.zeros(4, np.uint8)]}, r"must have shape \(H, W\)"),
        ({"extensions": ["WRAP"]}, "REPEAT, MIRROR, EXTEND or CLIP, not WRAP"),
        ({"extensions": []}, "one of extensions for each of images"),
        ({"uv": np.full((2, 3, 2), np.nan, np.float32)}, "not a finite number"),
    ],
)
def test_what_does_not_fit_is_named(change, message):
    mesh = card(0.0)
    with (
        new_simulation(repose=STAYS) as sim,
        pytest.raises(ValueError, match=f"object 'leaf': .*{message}"),
    ):
        sim.add_object("leaf", mesh[1], mesh[2], alpha={**alpha_of(mesh, RING), **change})


def test_alpha_must_be_whole():
    mesh = card(0.0)
    alpha = alpha_of(mesh, RING)
    del alpha["images"]
    with (
        new_simulation(repose=STAYS) as sim,
        pytest.raises(ValueError, match="must have an entry 'images'"),
    ):
        sim.add_object("leaf", mesh[1], mesh[2], alpha=alpha)
