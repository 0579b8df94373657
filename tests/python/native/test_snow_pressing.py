# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects press, plough and clear snow; none is lost."""

import math

import numpy as np
import pytest
import snowbough_native as native
from checkpoints import assert_resumes, restore, save
from child import in_child
from snow_meshes import STAYS, box, grid, rotated, sphere, turned_over

FRAME = 1.0 / 24.0
DOWN = (0.0, 0.0, -1.0)
DEPTH = 0.15

both_engines = pytest.mark.parametrize("engine", ["CPU", "GL"])


def ball(radius=0.25):
    positions, triangles, _ = sphere(radius, 192, 96)
    return positions, triangles


def wheel(radius=0.3, width=0.14, around=128):
    """A closed cylinder about the Y axis."""
    turn = np.arange(around) * 2.0 * math.pi / around
    ring = np.stack([radius * np.cos(turn), np.zeros(around), radius * np.sin(turn)], axis=1)
    side = np.array([0.0, 0.5 * width, 0.0])
    positions = np.concatenate([ring - side, ring + side, [-side, side]])
    triangles = []
    for i in range(around):
        j = (i + 1) % around
        triangles += [(i, i + around, j + around), (i, j + around, j)]
        triangles += [(2 * around, i, j), (2 * around + 1, j + around, i + around)]
    return positions.astype(np.float32), np.array(triangles, np.int32)


def block(size, height, centre=True):
    positions, triangles, _ = box(size, height)
    return positions - np.float32([0.0, 0.0, 0.5 * height if centre else 0.0]), triangles


class World:
    """A level ground under 15 cm of snow, and objects that press it. A place of the map is 6.5 mm wide."""

    def __init__(self, size=1.6, resolution=256, engine="CPU", depth=DEPTH, over=False, **settings):
        self.size, self.resolution = size, resolution
        self.ground = turned_over(grid(size, size)) if over else grid(size, size)
        self.sim = native.SnowSimulation(pixel_size=0.02, engine=engine, **settings)
        self.sim.add_object("ground", *self.ground[1:], resolution=resolution)
        self.depth = depth
        self.started = False

    def add(self, name, mesh, kind="PRESS", **settings):
        """An object that blocks no snow."""
        triangles = mesh[1]
        uv = np.zeros((len(triangles), 3, 2), np.float32)
        self.sim.add_object(name, triangles, uv, receive=False, occlude=False)
        self.sim.set_presser(name, kind, **settings)

    def step(self, positions=None, depth=0.0, dt=FRAME):
        positions = {name: np.ascontiguousarray(p, np.float32) for name, p in (positions or {}).items()}
        if not self.started:
            positions["ground"] = self.ground[0]
        self.started = True
        self.sim.step(positions, depth, DOWN, dt)

    def press(self, poses, name="tool"):
        """Snow, then the poses, one a step, then rest. The first pose is taken without duration."""
        self.step({name: poses[0]}, self.depth)
        for pose in poses[1:]:
            self.step({name: pose})

    def height(self):
        return self.sim.height("ground")

    def at(self, x, y):
        """Height at a point of the ground."""
        u, v = ((c / self.size + 0.5) * 0.96 + 0.02 for c in (x, y))
        return self.height()[int(v * self.resolution), int(u * self.resolution)]

    def balance(self):
        total = self.sim.statistics()["total"]
        volume = (self.height().astype(float) * self.sim.texel_area("ground")).sum()
        came = total["deposited_volume"] + total["landed_volume"]
        lost = came - volume - total["slid_volume"] - total["removed_volume"]
        # The sums of engine GL are of single precision.
        limit = 1e-6 if self.sim.engine["name"] == "CPU" else 3e-6
        assert abs(lost) < limit * total["deposited_volume"]
        return total


def sinking(mesh, lowest, steps=8, above=0.02):
    """Poses of an object whose lowest point goes from over the snow to `lowest`."""
    bottom = float(mesh[0][:, 2].min())
    return [
        mesh[0] + np.float32([0.0, 0.0, z - bottom]) for z in np.linspace(DEPTH + above, lowest, steps + 1)
    ]


@both_engines
def test_a_ball_presses_its_cap_out_of_the_snow(engine):
    world = World(engine=engine)
    world.add("tool", ball(), pushed_aside=0.0)
    world.press(sinking(ball(), 0.05))
    total = world.balance()
    cap = math.pi * 0.1**2 * (3 * 0.25 - 0.1) / 3.0
    assert total["pressed_volume"] == pytest.approx(cap, rel=0.01)
    assert world.at(0.0, 0.0) == pytest.approx(0.05, abs=1e-3)
    assert world.height().max() == pytest.approx(DEPTH, abs=1e-3)


def test_a_part_of_the_snow_is_pushed_into_a_rim():
    world = World()
    world.add("tool", ball(), pushed_aside=0.3)
    world.press(sinking(ball(), 0.05))
    total = world.balance()
    cap = math.pi * 0.1**2 * (3 * 0.25 - 0.1) / 3.0
    # What is pushed aside lies around the ball, and is pressed again as the ball widens.
    assert 0.6 * cap < total["pressed_volume"] < 1.1 * cap
    assert world.at(0.0, 0.0) == pytest.approx(0.05, abs=1e-3)
    heights = world.height()
    assert DEPTH + 0.01 < heights.max() < DEPTH + 0.06
    # The rim is the same on all sides.
    rims = [heights[128, 129:].max(), heights[128, :128].max(), heights[129:, 128].max()]
    assert max(rims) - min(rims) < 0.004


def rolled(mesh, way, turns=True, z=0.36):
    """A wheel at a place along x, rolled without slipping."""
    pose = rotated(mesh[0], "y", math.degrees(way / 0.3)) if turns else mesh[0]
    return pose + np.float32([way, 0.0, z])


def test_snow_on_the_back_is_pushed_as_on_the_other_side():
    maps = []
    for over in (False, True):
        world = World(size=0.8, resolution=64, repose=STAYS, over=over)
        positions, triangles = block(0.2, 0.2)
        world.add("tool", (positions, triangles), pushed_aside=0.5)
        world.press([positions + np.float32([0.0, 0.0, z]) for z in (0.5, 0.18)])
        maps.append(world.height())
    assert maps[0].max() > 1.02 * DEPTH and maps[0][32, 32] < 0.9 * DEPTH
    # Where several ways out are equally long, it may be pushed to another texel.
    assert maps[1].max() <= 0.0
    assert maps[1].min() == pytest.approx(-maps[0].max(), abs=1e-5)
    assert maps[1].sum(dtype=float) == pytest.approx(-maps[0].sum(dtype=float), rel=1e-5)


def test_a_wheel_leaves_an_even_track():
    mesh = wheel()
    world = World(3.2, 512)
    world.add("tool", mesh)
    frames = 48
    poses = [rolled(mesh, -1.5 + 3.0 * i / frames) for i in range(frames + 1)]
    world.press(poses)
    world.balance()
    track = np.array([world.at(x, 0.0) for x in np.linspace(-1.2, 1.2, 200)])
    # The wheel's lowest point is at 0.06.
    assert abs(track - 0.06).max() < 1e-3
    across = np.array([world.at(0.0, y) for y in np.linspace(-0.2, 0.2, 200)])
    width = (across < 0.5 * (DEPTH + 0.06)).mean() * 0.4
    assert width == pytest.approx(0.14, abs=0.02)
    assert across.max() > DEPTH + 0.005


def test_packed_snow_carries():
    mesh = block(0.2, 0.3)
    world = World()
    world.add("tool", mesh, pushed_aside=0.0)
    world.press(sinking(mesh, -0.01))
    world.balance()
    # From 100 to 400 kg/m3.
    assert world.at(0.0, 0.0) == pytest.approx(0.25 * DEPTH, abs=1e-3)


def test_nine_boot_prints_have_clean_walls_and_even_floors():
    sole = block(0.11, 0.3)[0] * np.float32([2.6, 1.0, 1.0]), block(0.11, 0.3)[1]
    world = World(3.2, 768)
    world.add("tool", sole, pushed_aside=0.2)
    places = [(-1.24 + 0.31 * step, 0.13 if step % 2 else -0.13) for step in range(9)]
    poses = [
        sole[0] + np.float32([x, y, z]) for x, y in places for z in (0.5, 0.22, 0.155, 0.22, 0.5)
    ]  # the sole's lowest point is 15 cm lower
    world.press(poses)
    world.balance()
    for x, y in places:
        floor = [world.at(x + dx, y + dy) for dx in (-0.1, 0.0, 0.1) for dy in (-0.035, 0.0, 0.035)]
        assert max(floor) - min(floor) < 1e-3
        assert floor[4] < 0.3 * DEPTH
        for dx, dy in ((0.0, 1.0), (0.0, -1.0), (2.6, 0.0), (-2.6, 0.0)):
            inside, outside = (world.at(x + share * dx, y + share * dy) for share in (0.05, 0.065))
            # Within 1.5 cm across the wall, 4 cm along.
            assert outside - inside > 0.09


def test_prints_keep_their_walls_and_new_snow_rounds_them():
    mesh = block(0.2, 0.3)
    world = World()
    world.add("tool", mesh, pushed_aside=0.0)
    world.press([*sinking(mesh, 0.05), *[mesh[0] + np.float32([0.0, 0.0, 1.0])] * 6])
    inside, outside = world.at(0.085, 0.0), world.at(0.115, 0.0)
    assert outside - inside > 0.09
    before = world.at(0.0, 0.0)
    for _ in range(8):
        world.step({}, 0.01)
    world.balance()
    assert world.at(0.0, 0.0) > before + 0.075
    assert world.at(0.115, 0.0) - world.at(0.085, 0.0) < outside - inside - 0.01


@pytest.mark.parametrize("lowest", [0.01, -0.005])
def test_a_blade_clears_its_lane_and_piles_the_snow_up(lowest):
    mesh = block(1.0, 0.4)
    mesh = mesh[0] * np.float32([0.03, 1.0, 1.0]), mesh[1]
    blade = rotated(mesh[0], "z", 30.0)
    world = World(1.6, 256)
    world.add("tool", mesh, "PLOUGH", rim_width=0.03)
    # A fast object elsewhere divides the step into parts in which the blade moves by less than a texel.
    bird = ball(0.1)
    world.add("bird", bird)
    for i in range(9):
        poses = {"tool": blade + np.float32([-0.5 + 0.06 * i, 0.0, 0.2 + lowest])}
        poses["bird"] = bird[0] + np.float32([0.7, 0.7, 1.0 + 2.0 * (i % 2)])
        world.step(poses, DEPTH if i == 0 else 0.0)
    total = world.balance()
    assert total["pressed_volume"] < 1e-6
    lane = [world.at(x, y) for x in np.linspace(-0.3, -0.15, 10) for y in np.linspace(-0.1, 0.1, 5)]
    assert max(lane) < 0.02
    assert world.height().max() > 1.5 * DEPTH


def ploughed(world, frames, begin=0):
    """A blade of 1 m at 30 degrees, 6 cm a frame."""
    mesh = block(1.0, 0.4)
    blade = rotated(mesh[0] * np.float32([0.03, 1.0, 1.0]), "z", 30.0)
    for i in range(begin, frames):
        pose = blade + np.float32([-1.1 + 0.06 * i, 0.0, 0.21])
        world.step({"tool": pose}, DEPTH if i == 0 else 0.0)


def plough(size=2.4, resolution=256):
    world = World(size, resolution)
    world.add("tool", (None, block(1.0, 0.4)[1]), "PLOUGH", rim_width=0.03)
    return world


def test_a_plough_leaves_an_even_windrow():
    world = plough()
    ploughed(world, 28)
    world.balance()
    xs = np.linspace(-0.6, 0.05, 84)
    for side in (-1.0, 1.0):
        crest = np.array([max(world.at(x, side * y) for y in np.linspace(0.4, 0.9, 50)) for x in xs])
        assert crest.min() > 1.2 * DEPTH
        # The crest rises slowly along the lane; a bump at each frame would be 6 cm long.
        bumps = crest[8:-8] - np.convolve(crest, np.ones(17) / 17.0, "valid")
        assert abs(bumps).max() < 0.008


def test_ploughing_resumes_byte_for_byte(tmp_path):
    whole, first, second = plough(1.6, 128), plough(1.6, 128), plough(1.6, 128)
    ploughed(whole, 14)
    ploughed(first, 9)
    save(first.sim, tmp_path / "state")
    restore(second.sim, tmp_path / "state")
    second.started = False
    ploughed(second, 14, begin=9)
    assert second.height().tobytes() == whole.height().tobytes()
    assert second.sim.statistics() == whole.sim.statistics()


def test_a_broom_removes_what_it_sweeps():
    mesh = block(0.4, 0.4)
    world = World(repose=STAYS)
    world.add("tool", mesh, "CLEAR")
    world.press([mesh[0] + np.float32([-0.2 + 0.1 * i, 0.0, 0.2]) for i in range(5)])
    total = world.balance()
    assert total["cleared_volume"] == pytest.approx(0.8 * 0.4 * DEPTH, rel=0.02)
    assert world.at(0.0, 0.0) == 0.0


def test_a_thin_object_that_presses_pushes_nothing_behind_itself():
    """By 5 cm; snow stays where it lies."""
    mesh = block(1.0, 0.4)
    blade = mesh[0] * np.float32([0.02, 1.0, 1.0])
    world = World(1.6, 128, repose=STAYS)
    world.add("tool", (blade, mesh[1]), rim_width=0.1, pushed_aside=1.0)
    world.step({"tool": blade + np.float32([-0.3, 0.0, 0.2])}, DEPTH)
    before = world.height()
    world.step({"tool": blade + np.float32([-0.25, 0.0, 0.2])})
    world.balance()
    gained = world.height() - before
    middle = int((-0.31 / 1.6 + 0.5) * 0.96 * 128 + 0.02 * 128)
    assert gained[:, :middle].max() < 1e-6
    assert gained[:, middle:].max() > 0.1 * DEPTH


def test_snow_with_nowhere_to_go_is_pressed():
    """The plate is larger than the ground."""
    world = World(0.8, 64, repose=STAYS)
    positions, triangles = block(1.0, 0.2)
    world.add("tool", (positions, triangles), pushed_aside=0.5)
    world.press(sinking((positions, triangles), 0.1))
    total = world.balance()
    assert total["pressed_volume"] == pytest.approx(0.05 * 0.8**2, rel=0.02)


def test_a_rod_presses_on_its_way_between_two_poses_over_the_snow():
    """It turns by 120 degrees in a step; upright it would reach 4 cm into the snow."""
    positions, triangles = block(1.0, 1.0)
    rod = positions * np.float32([0.5, 0.1, 0.1])
    world = World(0.8, 128, repose=STAYS)
    world.add("tool", (rod, triangles), pushed_aside=0.0)
    poses = [rotated(rod, "y", angle) + np.float32([0.0, 0.0, 0.36]) for angle in (30.0, 150.0)]
    assert min(pose[:, 2].min() for pose in poses) > DEPTH + 0.01
    world.press(poses)
    world.balance()
    assert 0.36 - 0.26 < world.height()[8:-8, 8:-8].min() < DEPTH - 0.02


def test_an_object_presses_nothing_on_its_way_while_it_is_hidden():
    world = World(repose=STAYS)
    world.add("tool", ball(), pushed_aside=0.0)
    low = ball()[0] + np.float32([-0.4, 0.0, DEPTH + 0.2])
    world.step({"tool": low}, DEPTH)
    world.step({"tool": low})
    world.sim.step({"tool": low + np.float32([0.4, 0.0, 0.0])}, 0.0, DOWN, FRAME, hidden={"tool"})
    world.step({"tool": low + np.float32([0.8, 0.0, 0.0])})
    world.step({"tool": low + np.float32([0.8, 0.0, 0.0])})
    assert world.at(0.0, 0.0) == pytest.approx(DEPTH, abs=1e-4)
    assert world.at(0.4, 0.0) < DEPTH - 0.01


def test_an_object_over_the_snow_changes_no_byte():
    plain, pressed = World(repose=1.0), World(repose=1.0)
    for world in (plain, pressed):
        world.add("tool", ball(), "PRESS" if world is pressed else "NONE")
        world.press([ball()[0] + np.float32([0.1 * i, 0.0, DEPTH + 0.27]) for i in range(4)])
    assert plain.height().tobytes() == pressed.height().tobytes()
    assert "planes" not in native.simulation_state(pressed.sim)["objects"]["ground"]


def test_a_step_without_duration_presses_nothing():
    world = World()
    world.add("tool", ball())
    world.step({"tool": ball()[0] + np.float32([0.0, 0.0, 1.0])}, DEPTH)
    before = world.height().tobytes()
    world.step({"tool": ball()[0] + np.float32([0.0, 0.0, 0.3])}, dt=0.0)
    assert world.height().tobytes() == before


def test_two_objects_remove_the_same_in_either_order():
    totals = []
    for names in (("a", "b"), ("b", "a")):
        world = World()
        for name in names:
            world.add(name, ball(), pushed_aside=0.0)
        for z in np.linspace(0.42, 0.3, 7):
            places = dict(zip(names, (-0.1, 0.1)))
            world.step({n: ball()[0] + np.float32([x, 0.0, z]) for n, x in places.items()},
                       0.0 if world.started else DEPTH)  # fmt: skip
        totals.append(world.balance()["pressed_volume"])
    assert totals[0] == pytest.approx(totals[1], rel=1e-6)
    assert totals[0] > 0.005


def test_an_open_sheet_presses_whichever_way_it_faces():
    for flips in (False, True):
        positions, triangles, _ = grid(0.4, 0.4)
        mesh = positions, triangles[:, ::-1].copy() if flips else triangles
        world = World()
        world.add("tool", mesh, pushed_aside=0.0)
        world.press([positions + np.float32([0.0, 0.0, z]) for z in np.linspace(0.17, 0.06, 6)])
        assert world.at(0.0, 0.0) == pytest.approx(0.06, abs=1e-3)


@both_engines
def test_pressing_resumes_byte_for_byte(tmp_path, engine):
    mesh = wheel(around=48)
    poses = [rolled(mesh, -0.6 + 0.1 * i) for i in range(13)]

    def run(world, begin, end):
        for i in range(begin, end):
            world.step({"tool": poses[i]}, DEPTH if i == 0 else 0.004)

    def new():
        world = World(engine=engine)
        world.add("tool", mesh)
        return world

    assert_resumes(new, run, 6, 13, tmp_path / "state").balance()


def test_a_track_on_a_plank_that_bends_stays_on_it():
    positions, triangles, uv = grid(2.0, 0.6, 16)
    mesh = wheel(around=64)
    sim = native.SnowSimulation(pixel_size=0.02, engine="CPU")
    sim.add_object("plank", triangles, uv, resolution=256)
    sim.add_object("tool", mesh[1], np.zeros((len(mesh[1]), 3, 2), np.float32), receive=False, occlude=False)
    sim.set_presser("tool", "PRESS")

    def bent(much):
        return positions - np.float32([0.0, 0.0, much]) * (positions[:, :1] ** 2)

    sim.step({"plank": bent(0.0), "tool": rolled(mesh, -0.9)}, 0.1, DOWN, FRAME)
    for i in range(1, 19):
        sim.step({"tool": rolled(mesh, -0.9 + 0.1 * i)}, 0.0, DOWN, FRAME)
    sim.step({"tool": mesh[0] + np.float32([0.0, 0.0, 3.0])}, 0.0, DOWN, FRAME)
    before = sim.height("plank")
    for i in range(1, 9):
        sim.step({"plank": bent(0.01 * i)}, 0.0, DOWN, FRAME)
    after = sim.height("plank")
    middle = slice(64, 192)
    assert before[128, middle].max() < 0.065
    assert abs(after[128, middle] - before[128, middle]).max() < 0.003


def test_wrong_settings_are_refused_with_a_reason():
    world = World()
    world.add("tool", ball())
    with pytest.raises(ValueError, match="kind must be one of NONE, PRESS, PLOUGH, CLEAR"):
        world.sim.set_presser("tool", "STAMP")
    with pytest.raises(ValueError, match="packed_density must be 100 to 917"):
        world.sim.set_presser("tool", packed_density=20.0)
    with pytest.raises(ValueError, match="no object 'other'"):
        world.sim.set_presser("other")


def fine_world(kind="PRESS", mesh=None, **settings):
    """A map on which snow comes to rest on squares of texels."""
    world = World(2.4, 1024, repose=math.radians(65.0), **settings)
    world.add("tool", mesh or wheel(around=48), kind)
    return world


def test_far_from_prints_snow_rests_as_without_them():
    pressed, plain = fine_world(), fine_world()
    mesh = wheel(around=48)
    for i in range(5):
        for world, above in ((pressed, 0.0), (plain, 1.0)):
            pose = rolled(mesh, -0.2 + 0.1 * i) + np.float32([0.0, 0.0, above])
            world.step({"tool": pose}, DEPTH if i == 0 else 0.004)
    pressed.balance()
    assert plain.at(0.0, 0.0) - pressed.at(0.0, 0.0) > 0.05
    # 7.5 cm of each border lie on slopes.
    for part in (slice(0, 128), slice(-128, None)):
        assert pressed.height()[part].tobytes() == plain.height()[part].tobytes()
        assert pressed.height()[:, part].tobytes() == plain.height()[:, part].tobytes()


def test_prints_on_a_fine_map_keep_walls_that_slump_elsewhere():
    """Of 8 cm within 1.5 cm, below a square sole."""
    world = fine_world(mesh=block(0.2, 0.3))
    sole = block(0.2, 0.3)
    world.press(sinking(sole, 0.05))
    world.balance()
    for x, y in ((0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1)):
        inside, outside = (world.at(k * x, k * y) for k in (0.92, 1.08))
        assert outside - inside > 0.08


@pytest.mark.parametrize("tool", ["PRESS", "PLOUGH", "CLEAR"])
def test_a_fine_map_resumes_byte_for_byte(tmp_path, tool):
    """A wheel rolls or, held, is pushed over the border of the ground, and then through its own way."""
    mesh = wheel(around=48)
    poses = [rolled(mesh, x) for x in (-1.4, -1.3, -1.2, -1.1, -1.0, -1.1, -1.2, -1.3)]

    def run(world, begin, end):
        for i in range(begin, end):
            world.step({"tool": poses[i]}, DEPTH if i == 0 else 0.004)

    assert_resumes(lambda: fine_world(tool), run, 4, 8, tmp_path / "state").balance()


def test_the_number_of_threads_changes_no_byte():
    program = """
import hashlib, os
if {single}:
    os.sched_setaffinity(0, {{min(os.sched_getaffinity(0))}})
import test_snow_pressing as t
world, mesh = t.World(), t.wheel(around=48)
world.add("tool", mesh)
world.press([t.rolled(mesh, -0.3 + 0.1 * i) for i in range(5)])
blade = t.plough(1.6, 128)
t.ploughed(blade, 10)
fine = t.fine_world()
fine.press([t.rolled(mesh, -1.3 + 0.1 * i) for i in range(5)])
print(hashlib.sha256(world.height().tobytes() + blade.height().tobytes() + fine.height().tobytes()).hexdigest())
"""
    assert in_child(program.format(single=True)) == in_child(program.format(single=False))
