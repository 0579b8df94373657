# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface over gaps between pieces of one receiver: one blanket with soft furrows."""

import math

import numpy as np
import pytest
import snowbough_native as native
from shown_snow import faces_of, map_of, shown_over
from snow_fall import fall, snow_over
from snow_meshes import bevelled_box, box, lathe, unfolded
from snow_pieces import bevelled_slats
from snow_rays import first_hits

# Metres.
DEPTH = 0.2
STONE = 0.6


def stones(gap, lower=0.0):
    """Four stones around the origin with joints of that width; those at x > 0 lie lower by `lower`."""
    positions, triangles, _ = box(STONE, 0.3)
    faces = []
    for x, y in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
        shift = (x * (STONE + gap) / 2, y * (STONE + gap) / 2, -lower if x > 0 else 0.0)
        for k in range(0, 12, 2):
            faces.append(positions[[*triangles[k], triangles[k + 1][2]]] + shift)
    *mesh, resolution = unfolded(faces, 0.01)
    return mesh, resolution


def tops(mesh, resolution, points, snow=lambda points: DEPTH):
    """Height of what is drawn at points (N, 2), without noise: see shown_over."""
    lying = map_of(mesh, resolution, lambda places, up: np.where(up > 0.7, snow(places) * up, 0.0))
    return shown_over(mesh, lying, DEPTH, np.array(points, np.float64))[0]


@pytest.mark.parametrize("gap", [0.015, 0.04])
def test_furrows_over_joints_are_soft(gap):
    along = np.linspace(0.05, 0.4, 36)
    mesh, resolution = stones(gap)
    furrow = tops(mesh, resolution, np.stack([np.zeros_like(along), along], axis=1)) - 0.3
    inland = tops(mesh, resolution, np.stack([np.full_like(along, 0.3), along], axis=1)) - 0.3
    assert furrow.min() > 0.8 * inland.mean()
    assert furrow.mean() > 0.85 * inland.mean()


def test_where_four_joints_meet_there_is_no_hole():
    mesh, resolution = stones(0.015)
    around = np.stack(np.meshgrid(*[np.linspace(-0.03, 0.03, 13)] * 2), axis=2).reshape(-1, 2)
    assert (tops(mesh, resolution, around) - 0.3).min() > 0.7 * DEPTH


def test_both_sides_of_a_joint_meet_at_one_height():
    mesh, resolution = stones(0.015, lower=0.03)
    along = np.linspace(0.1, 0.4, 31)
    at = [
        tops(mesh, resolution, np.stack([np.full_like(along, x), along], axis=1)) for x in (-0.01, 0.0, 0.01)
    ]
    assert max(abs(at[0] - at[1]).max(), abs(at[1] - at[2]).max()) < 0.015


def test_snow_does_not_bridge_to_a_bare_stone():
    mesh, resolution = stones(0.015)
    along = np.linspace(0.1, 0.4, 31)
    on_bare = np.stack([np.full_like(along, 0.1), along], axis=1)
    left = tops(mesh, resolution, on_bare, lambda points: np.where(points[:, 0] < 0, DEPTH, 0.0))
    assert left == pytest.approx(np.full(31, 0.3), abs=0.005)


def step(height):
    """Two level faces of 0.8 m that meet at x = 0, the left one higher by `height`."""
    x, y, z = 0.8, 0.5, height
    faces = [
        [(-x, -y, z), (0, -y, z), (0, y, z), (-x, y, z)],
        [(0, -y, z), (0, -y, 0), (0, y, 0), (0, y, z)],
        [(0, -y, 0), (x, -y, 0), (x, y, 0), (0, y, 0)],
    ]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.01)
    return mesh, resolution


def courses(slope=32.0, length=0.22, lift=0.03, count=8, width=1.6):
    """Courses of tiles down a roof, each with its lower end on top of the next one."""
    a = np.radians(slope)

    def at(down, out, y):
        return (down * np.cos(a) + out * np.sin(a), y, out * np.cos(a) - down * np.sin(a))

    faces, y = [], 0.5 * width
    for k in range(count):
        top, end = k * length, (k + 1) * length
        faces.append([at(top, 0, -y), at(end, lift, -y), at(end, lift, y), at(top, 0, y)])
        faces.append([at(end, lift, -y), at(end, 0, -y), at(end, 0, y), at(end, lift, y)])
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.01)
    return mesh, resolution


def test_snow_runs_over_courses_of_tiles():
    mesh, resolution = courses()
    down, across = np.meshgrid(np.linspace(0.4, 1.1, 141), np.linspace(-0.4, 0.4, 9))
    places = np.stack([down.ravel(), across.ravel()], axis=1)
    drawn = tops(mesh, resolution, places).reshape(down.shape)
    # Above the plane of the roof: snow and, at the lower end of each tile, the tile.
    above = drawn + down * np.tan(np.radians(32.0))
    assert above.mean() > 0.9 * DEPTH
    assert above.std() < 0.15 * DEPTH


def loose_tiles(random, rows=5, columns=5, slope=38.0):
    """Tiles of 22 x 29 x 1.8 cm, as if laid by hand: each rests on those of the course below it."""
    corners, triangles, _ = box()

    def turned(points, angle, a, b):
        points[:, a], points[:, b] = (
            math.cos(angle) * points[:, a] - math.sin(angle) * points[:, b],
            math.sin(angle) * points[:, a] + math.cos(angle) * points[:, b],
        )

    faces, up = [], math.radians(slope)
    for row in range(rows):
        for column in range(columns):
            tile = (corners - (0, 0, 0.5)) * (0.22, 0.29, 0.018)
            turned(tile, up - math.radians(5.2), 1, 2)
            turned(tile, math.radians(random.uniform(-0.8, 0.8)), 0, 1)
            tile += (
                (column + 0.5 * (row % 2)) * 0.225 + random.uniform(-0.003, 0.003),
                row * 0.24 * math.cos(up),
                row * 0.24 * math.sin(up) + random.uniform(-0.003, 0.003),
            )
            faces += [tile[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded(faces, 0.01)
    return mesh, resolution


def fallen(mesh, resolution, depth):
    """The map of a mesh after a fall of that depth."""
    positions, triangles, uv = mesh
    meshes = {"mesh": (positions.astype(np.float32), triangles, uv, resolution)}
    sim = snow_over(meshes, cohesion=0.005)
    fall(sim, meshes, depth)
    return sim.height("mesh").astype(np.float32)


def test_no_tile_is_seen_between_the_courses_of_a_roof():
    """From the ground, with few points."""
    seed, depth = 3, 0.1
    print("seed", seed)
    mesh, resolution = loose_tiles(np.random.default_rng(seed))
    positions, triangles, uv = mesh
    snow = fallen(mesh, resolution, depth)
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, depth, most_points=13000)
    drawn = surface.points(snow, depth)[faces_of(surface)]
    x, y = np.meshgrid(np.linspace(0.3, 0.9, 401), np.linspace(0.15, 0.75, 401))
    places = np.stack([x, y, y * math.tan(math.radians(38.0))], axis=2).reshape(-1, 3)
    for view in ((-0.45, 0.86, -0.22), (0.45, 0.86, -0.22), (0.0, 0.97, -0.2)):
        tiles = first_hits(places, positions[triangles], view)
        assert not (tiles < first_hits(places, drawn, view) - 1e-4).any()


def test_deep_snow_on_loose_tiles_is_one_sheet():
    """The snow of neighbouring tiles meets at one height and with one slope, so that hardly any seam shows."""
    seed, depth = 3, 0.3
    print("seed", seed)
    mesh, resolution = loose_tiles(np.random.default_rng(seed), rows=6, columns=6)
    x, y = np.meshgrid(np.arange(0.35, 1.0, 0.005), np.arange(0.2, 0.8, 0.005))
    places = np.stack([x, y], axis=2).reshape(-1, 2)
    top, _ = shown_over(mesh, fallen(mesh, resolution, depth), depth, places, style={"relief": 0.0})
    for z, most in ((top.reshape(x.shape), 0.06), (top.reshape(x.shape).T, 0.02)):
        bend = np.abs(z[:-4] - 2 * z[2:-2] + z[4:])
        assert (bend > 0.004).mean() < most


def test_snow_does_not_dip_at_the_foot_of_a_low_step():
    """The map has a furrow there."""
    mesh, resolution = step(0.03)

    def furrow(points, up):
        beside = np.clip(abs(points[:, 0]) / 0.07, 0.15, 1.0)
        return np.where(up > 0.7, DEPTH * beside, 0.0)

    down, across = np.meshgrid(np.linspace(-0.2, 0.2, 81), np.linspace(-0.2, 0.2, 9))
    places = np.stack([down.ravel(), across.ravel()], axis=1)
    drawn = shown_over(mesh, map_of(mesh, resolution, furrow), DEPTH, places)[0].reshape(down.shape)
    assert drawn.min() > 0.8 * DEPTH
    # The step of 3 cm shows as a soft one.
    assert abs(np.diff(drawn, axis=1)).max() < 0.02


def plates(gap=0.015, width=0.06, count=5, length=1.0):
    """Slats along y."""
    faces = []
    for i in range(count):
        x = (i - 0.5 * (count - 1)) * (width + gap)
        positions, triangles, _ = box(1.0, 0.025)
        at = positions * (width, length, 1.0) + (x, 0.0, 0.0)
        faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.005)
    return mesh, resolution


def test_slats_carry_one_blanket():
    mesh, resolution = plates()
    snow = map_of(mesh, resolution, lambda points, up: np.where(up > 0.7, DEPTH, 0.0))
    across, along = np.meshgrid(np.linspace(-0.09, 0.09, 91), np.linspace(-0.3, 0.3, 13))
    places = np.stack([across.ravel(), along.ravel()], axis=1)
    plain = {"overhang": 0.0, "hem_variation": 0.0, "bridging": 1.0, "relief": 0.0}
    drawn = shown_over(mesh, snow, DEPTH, places, style=plain)[0].reshape(across.shape) - 0.025
    assert drawn.mean() == pytest.approx(DEPTH, rel=0.15)
    assert drawn.min() > 0.8 * drawn.mean()
    assert drawn.max() < 1.2 * drawn.mean()


def test_snow_ends_in_a_front_at_a_high_step():
    mesh, resolution = step(0.6)
    along = np.linspace(-0.2, 0.2, 21)
    behind, beyond = (
        tops(mesh, resolution, np.stack([np.full_like(along, x), along], axis=1)) for x in (-0.03, 0.2)
    )
    assert behind.min() > 0.6 + 0.6 * DEPTH
    assert beyond.max() < 1.3 * DEPTH


def test_before_the_first_snow_every_point_is_in_its_place():
    (positions, triangles, uv), resolution = stones(0.015)
    snow = np.full((resolution, resolution), DEPTH, np.float32)
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, DEPTH)
    bare = surface.points(0.0 * snow, 0.0)
    assert np.isfinite(bare).all()
    assert np.abs(bare - surface.points(0.0 * snow, 1e-4)).max() < 0.01


def test_snow_on_the_steep_sides_of_a_wide_joint_stays_on_its_side():
    """Two tops whose sides are 68 degrees steep; a blanket lies over both."""
    ends = ((0.5, 0.0), (0.105, 0.0), (0.005, -0.25))
    faces = []
    for (x, z), (nearer, lower) in zip(ends, ends[1:]):
        faces.append(np.array([[-x, -0.5, z], [-nearer, -0.5, lower], [-nearer, 0.5, lower], [-x, 0.5, z]]))
        faces.append(np.array([[nearer, -0.5, lower], [x, -0.5, z], [x, 0.5, z], [nearer, 0.5, lower]]))
    *mesh, resolution = unfolded(faces, 0.01)
    positions, triangles, uv = mesh
    snow = map_of(mesh, resolution, lambda places, up: DEPTH * up)
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, DEPTH)
    carrier, drawn = surface.points(0.0 * snow, 1e-4)[:, 0], surface.points(snow, DEPTH)[:, 0]
    across = np.where(np.abs(carrier) < 0.105, -np.sign(carrier) * drawn, 0.0)
    assert across.max() < DEPTH / 2


def test_snow_does_not_lean_over_a_gap_that_stays_open():
    """Posts 10 cm apart, whose tops lie 6 mm below the snowy collars around them."""
    depth, posts = 0.3, (-0.12, 0.0, 0.12)
    faces = []
    for x in posts:
        for width, low, high in ((0.024, 0.0, 0.3), (0.05, 0.28, 0.306)):
            positions, triangles, _ = box(1.0, high - low)
            at = positions * (width, width, 1.0) + (x, 0.0, low)
            faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.004)
    snow = map_of(
        mesh, resolution, lambda points, up: np.where((up > 0.7) & (points[:, 2] > 0.303), 0.02, 0.0)
    )
    positions, triangles, uv = mesh
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, depth)
    drawn = surface.points(snow, depth)
    aside = np.abs(drawn[:, :1] - np.array(posts)).min(axis=1)
    assert aside.max() < 0.025 + 0.02


def test_snow_goes_on_from_a_slab_onto_a_kerb_that_stands_in_its_edge():
    """The kerb of stones with joints of 1 cm is 5 cm higher; both stand on the same ground, and overlap by 5 mm."""
    depth = 0.3
    boxes = [((-1.0, 0.0, 0.0), (1.0, 0.6, 0.07))]
    boxes += [((x, -0.155, 0.0), (x + 0.49, 0.005, 0.12)) for x in (-0.995, -0.495, 0.005, 0.505)]
    faces = []
    for low, high in boxes:
        positions, triangles, _ = box(1.0, 1.0)
        at = (positions + (0.5, 0.5, 0.0)) * (np.array(high) - low) + low
        faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.01)
    # One level top over both.
    snow = map_of(mesh, resolution, lambda points, up: np.where(up > 0.7, 0.37 - points[:, 2], 0.0))
    across, along = np.meshgrid(np.linspace(-0.08, 0.2, 57), np.linspace(-0.6, 0.6, 49))
    places = np.stack([along.ravel(), across.ravel()], axis=1)
    plain = {"overhang": 0.0, "hem_variation": 0.0, "bridging": 1.0, "relief": 0.0}
    drawn = shown_over(mesh, snow, depth, places, style=plain)[0].reshape(across.shape)
    assert drawn.min() > 0.8 * 0.37
    assert drawn.max() < 1.1 * 0.37


def test_snow_on_slats_lifts_no_side_of_the_leg_below_them():
    """The leg's top lies within the slats."""
    faces = []
    boxes = [((-0.5, y, 0.7), (0.5, y + 0.095, 0.73)) for y in (-0.165, -0.055, 0.055)]
    for low, high in [*boxes, ((-0.03, -0.03, 0.0), (0.03, 0.03, 0.71))]:
        positions, triangles, _ = box(1.0, 1.0)
        at = (positions + (0.5, 0.5, 0.0)) * (np.array(high) - low) + low
        faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.01)
    snow = map_of(
        mesh, resolution, lambda points, up: np.where((up > 0.7) & (points[:, 2] > 0.72), 0.25, 0.0)
    )
    positions, triangles, uv = mesh
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, 0.3)
    drawn = surface.points(snow, 0.3)[faces_of(surface)]
    aside, z = np.meshgrid(np.linspace(-0.02, 0.02, 5), np.linspace(0.1, 0.66, 57))
    for axis in (0, 1):
        inside = np.zeros((aside.size, 3))
        inside[:, 1 - axis], inside[:, 2] = aside.ravel(), z.ravel()
        for side in (-1.0, 1.0):
            direction = np.zeros(3)
            direction[axis] = side
            assert first_hits(inside, drawn, direction).min() > -0.05


def test_the_front_of_a_slat_is_as_high_everywhere():
    """The snow is deeper, the farther it is from the front."""
    *mesh, resolution = bevelled_slats([0.07], 2, width=0.14, length=1.5, height=0.03)
    snow = map_of(mesh, resolution, lambda points, up: np.where(up > 0.7, 0.03 + 2.1 * points[:, 1], 0.0))
    along = np.linspace(-0.5, 0.5, 401)
    plain = {"overhang": 0.0, "hem_variation": 0.0, "bridging": 1.0, "relief": 0.0}
    places = np.stack([along, np.full_like(along, 0.012)], axis=1)
    assert shown_over(mesh, snow, 0.3, places, style=plain)[0].std() < 0.0035


def test_the_flank_of_a_heap_on_slats_has_no_teeth():
    """It is 65 degrees steep; bars below the joints carry snow, too."""
    faces = []
    boxes = [((-0.5, y - 0.0475, 0.7), (0.5, y + 0.0475, 0.73)) for y in np.arange(-2, 3) * 0.11]
    boxes += [((-0.45, y - 0.02, 0.65), (0.45, y + 0.02, 0.7)) for y in (-0.18, 0.18)]
    for low, high in boxes:
        positions, triangles, _ = box(1.0, 1.0)
        at = (positions + (0.5, 0.5, 0.0)) * (np.array(high) - low) + low
        faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.005)
    across, along = np.meshgrid(np.linspace(0.1, 0.26, 41), np.linspace(-0.3, 0.3, 151))
    places = np.stack([along.ravel(), across.ravel()], axis=1)
    plain = {"overhang": 0.0, "hem_variation": 0.0, "bridging": 1.0, "relief": 0.0}
    drawn = shown_over(mesh, fallen(mesh, resolution, 0.3), 0.3, places, style=plain)[0]
    assert drawn.reshape(across.shape).std(axis=0).max() < 0.014


def test_a_ledge_in_shelter_has_the_snow_of_its_own_shelter():
    """The block beside it, across a joint, is higher; its snow in the open lies 50 cm away."""
    faces = []
    boxes = [((-0.15, 0.0, 0.0), (0.15, 0.4, 0.5)), ((-1.0, 0.0, 0.0), (-0.174, 0.4, 0.6))]
    for low, high in [*boxes, ((-0.65, 0.03, 0.7), (0.3, 0.4, 1.2))]:
        positions, triangles, _ = box(1.0, 1.0)
        at = (positions + (0.5, 0.5, 0.0)) * (np.array(high) - low) + low
        faces += [at[[*triangles[k], triangles[k + 1][2]]] for k in range(0, 12, 2)]
    *mesh, resolution = unfolded([np.array(face, np.float64) for face in faces], 0.01)

    def lying(points, up):
        x, y, z = points.T
        is_open = (z > 0.7) | (y < 0.05) | (x < -0.65)
        return np.where((up > 0.7) & is_open, np.where((z < 0.7) & (x > -0.16), 0.01, 0.2), 0.0)

    snow = map_of(mesh, resolution, lying)
    positions, triangles, uv = mesh
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, 0.3)
    carrier, drawn = surface.points(0.0 * snow, 1e-4), surface.points(snow, 0.3)
    on_ledge = (abs(carrier[:, 0]) < 0.16) & (abs(carrier[:, 2] - 0.5) < 0.01) & (carrier[:, 1] < 0.1)
    assert on_ledge.any()
    assert drawn[on_ledge, 2].max() < 0.5 + 0.02


def test_the_middle_of_a_slat_is_as_smooth_as_its_sides():
    """The snow slopes down to the outer edges of the outer slats."""
    mesh, resolution = plates(gap=0.031, width=0.096, count=3, length=1.4)

    def sloping(points, up):
        aside = np.abs(points[:, 0])
        snow = np.where(aside < 0.05, 0.28, np.clip((0.175 - aside) * 2.0, 0.0, 0.2))
        return np.where(up > 0.7, snow, 0.0)

    across, along = np.meshgrid(np.linspace(-0.04, 0.04, 17), np.linspace(-0.5, 0.5, 101))
    places = np.stack([across.ravel(), along.ravel()], axis=1)
    plain = {"overhang": 0.0, "hem_variation": 0.0, "bridging": 1.0, "relief": 0.0}
    drawn = shown_over(mesh, map_of(mesh, resolution, sloping), 0.3, places, style=plain)[0].reshape(
        across.shape
    )
    assert np.abs(np.diff(drawn, axis=0)).max() < 0.025


def test_snow_is_smooth_around_a_vase_on_a_pillar():
    """The middle of the pillar's top has no snow, nor has the vase's waist."""
    corners, triangles, _ = box(0.54, 0.1)
    faces = [corners[[*triangles[k], triangles[k + 1][2]]].astype(np.float64) for k in range(0, 12, 2)]
    faces += lathe([(0.1, 0.095), (0.07, 0.145), (0.13, 0.215), (0.16, 0.295), (0.001, 0.455)])
    *mesh, resolution = unfolded(faces, 0.01)
    depth = 0.3

    def snow(points, up):
        to_rim = 0.27 - abs(points[:, :2]).max(axis=1)
        lies = (up > 0.7) & (abs(points[:, 2] - 0.1) < 1e-3) & (np.hypot(*points[:, :2].T) > 0.1)
        return np.where(lies, np.minimum(0.15, 0.03 + 1.2 * to_rim), 0.0)

    along = np.linspace(-0.12, 0.12, 25)
    for out in (0.18, 0.2, 0.22, 0.24):
        places = np.stack([np.full_like(along, out), along], axis=1)
        drawn = shown_over(mesh, map_of(mesh, resolution, snow), depth, places)[0] - 0.1
        assert drawn.min() > 0.5 * 0.03
        assert abs(np.diff(drawn)).max() < 0.01


def stair(width=1.0, tread=0.34, rise=0.16, count=4):
    """Blocks, each 6 cm under the next one: the back edges of the treads lie within the next blocks."""
    faces = []
    for k in range(count):
        corners, triangles, _ = box()
        at = corners * (width, tread + 0.06, rise) + (0.0, k * tread, k * rise)
        faces += [at[[*triangles[i], triangles[i + 1][2]]] for i in range(0, 12, 2)]
    return unfolded(faces, 0.01)


def test_snow_on_a_stair_has_no_slit_before_the_risers():
    *mesh, resolution = stair()
    depth, along = 0.3, np.linspace(0.2, 0.9, 141)
    snow = fallen(mesh, resolution, depth)
    places = np.stack(np.meshgrid(np.linspace(-0.2, 0.2, 9), along), axis=2).reshape(-1, 2)
    drawn = shown_over(mesh, snow, depth, places)[0].reshape(141, 9)
    # Over the line through the edges of the treads.
    above = drawn - (0.16 + (along[:, None] + 0.2) * 0.16 / 0.34)
    assert above.min() > 0.5 * depth
    assert abs(np.diff(drawn, axis=0)).max() < 0.03


def uneven_stones(seed, most=0.0025):
    """Five stones in a row with bevels of two segments, whose corners are moved by up to so many metres: their faces
    are twisted."""
    print(f"seed {seed}")
    moves = np.random.default_rng(seed)
    positions, triangles, _, _ = bevelled_box(0.02, 2, STONE / 2, 0.2)
    faces = []
    for x in range(-2, 3):
        shift = (x * (STONE / 2 + 0.015), 0.0, moves.uniform(-0.01, 0.01))
        faces += [positions[triangle] + shift for triangle in triangles]
    *mesh, resolution = unfolded(faces, 0.005)
    mesh[0] = mesh[0] + moves.uniform(-most, most, mesh[0].shape).astype(np.float32)
    return mesh, resolution


@pytest.mark.parametrize("seed", range(4))
def test_snow_over_the_joints_of_uneven_stones_has_no_tufts_and_no_holes(seed):
    mesh, resolution = uneven_stones(seed)
    along = np.linspace(-0.6, 0.6, 241)
    for y in (-0.08, 0.0, 0.08):
        top = tops(mesh, resolution, np.stack([along, np.full_like(along, y)], axis=1))
        usual = np.median(np.lib.stride_tricks.sliding_window_view(top, 41), axis=1)
        assert abs(top[20:-20] - usual).max() < 0.06


@pytest.mark.parametrize("seed", [8, 9])
def test_no_snow_shows_on_twisted_faces_below_the_hem(seed):
    (positions, triangles, uv), resolution = mesh, _ = uneven_stones(seed, most=0.006)
    snow = map_of(mesh, resolution, lambda places, up: np.where(up > 0.7, DEPTH * up, 0.0))
    surface = native.SnowSurface(triangles, uv, positions, snow, snow, DEPTH)
    x, z = np.meshgrid(np.linspace(-0.7, 0.7, 281), np.linspace(0.01, 0.08, 15))
    behind = np.stack([x.ravel(), np.full(x.size, 9.0), z.ravel()], axis=1)
    stone = first_hits(behind, positions[triangles], (0.0, 1.0, 0.0))
    drawn = first_hits(behind, surface.points(snow, DEPTH)[faces_of(surface)], (0.0, 1.0, 0.0))
    assert (drawn > stone)[stone < -9.0].all()


def test_where_two_sheets_go_on_within_each_other_points_are_at_a_joint():
    """Two boxes that share a slice of 2 cm: their sides there are at the joint, far sides are not."""
    corners, triangles, _ = box()
    points = np.concatenate([corners, corners + (0.98, 0.01, 0.01)]).astype(np.float32)
    faces = np.concatenate([triangles, triangles + len(corners)]).reshape(-1, 3).astype(np.int32)
    near = native.nearness_to_joints(points, faces, 0.5)
    left, right = points[:, 0].min(), points[:, 0].max()
    assert near[(points[:, 0] > left + 0.9) & (points[:, 0] < right - 0.9)].max() == 1.0
    assert (near[(points[:, 0] == left) | (points[:, 0] == right)] == 0.0).all()
    assert (native.nearness_to_joints(corners.astype(np.float32), faces[: len(faces) // 2], 0.5) == 0.0).all()
