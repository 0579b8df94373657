# SPDX-License-Identifier: GPL-3.0-or-later
"""The simulation behind the live preview: it goes where the timeline goes, and follows the settings.

- **Forwards** each frame's snow falls on that frame's pose; frames that playback drops are made up for.
- **Back**, and forwards within what was played: the snow of then, from memory (history). A frame that memory has let
  go of is the one before with what fell since laid on the pose of now.
- **Anywhere else** all the snow of that frame is laid anew on its pose.
- **Settings.** Another depth scales what lies, another blur smooths it differently. Whatever else changes, such as the
  direction, makes what lies stale: `relay` lays it once more over poses that were played, in few steps at first, for
  the eye, and then in as many as the start depth of a bake takes.
"""

from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..bake import baked_receiver, plan, simulation
from ..bake.from_scene import constant_rates, constant_values
from ..scene.pose import TopologyChanged, metres_per_unit
from ..scene.reader import SceneReader
from ..scene.receivers import receiver_specs
from ..scene.tracker import SceneTracker
from ..settings.preferences import preferred_engine, preview_limits
from ..settings.simulation import snow_of
from .history import History, Moment

# Frames that playback may drop and that are made up for in one go.
MAX_SKIPPED = 8
# Steps in which the snow of a whole shot is laid anew: while a setting is being dragged, and afterwards.
QUICK_STEPS = 6
STEPS = plan.PREROLL_STEPS
# Maps where neither preferences nor receiver say otherwise: on a graphics card, and on the processor.
RESOLUTION = 1024
RESOLUTION_ON_PROCESSOR = 256
SOFTWARE_DRIVERS = ("llvmpipe", "softpipe", "swiftshader")


@dataclass(frozen=True)
class Wishes:
    """The settings of a scene that the preview heeds, as plain data."""

    snowfall: plan.Snowfall
    fps: float
    snow: dict
    """settings.simulation.snow_of."""
    blur_radius: float
    """Texels of a bake's map."""
    texel_size: float
    specs: tuple
    """scene.pose.ReceiverSpec, without styles: these change nothing of the simulation."""
    styles: tuple
    """The same with styles."""
    winds: tuple
    """(fall angle, bearing) of every frame of the shot; empty where only evaluating the scene can tell."""

    @classmethod
    def of(cls, scene):
        """Raises ValueError for settings that make no snowfall."""
        settings = scene.snowbough
        start, end = settings.frame_start, settings.frame_end
        winds = [constant_values(scene, name, start, end) for name in ("fall_angle", "bearing")]
        rates = constant_rates(scene, start, end) or (settings.rate,) * (end - start + 1)
        snowfall = plan.plan_snowfall(start, end, settings.start_depth, settings.end_depth, rates)
        return cls(
            snowfall,
            scene.render.fps / scene.render.fps_base,
            snow_of(settings),
            settings.blur_radius,
            settings.texel_size,
            tuple(replace(spec, surface=None) for spec in receiver_specs(scene)),
            tuple(receiver_specs(scene)),
            () if None in winds else tuple(zip(*winds)),
        )

    def total(self, frame):
        """Metres on open level ground at the end of a frame."""
        first, last = self.snowfall.frame_start, self.snowfall.frame_end
        return self.snowfall.totals[min(frame, last) - first] if frame >= first else self.snowfall.preroll

    def with_wind(self, pose, frame):
        """A pose of a frame with the wind that blows there by these settings."""
        if not self.winds:
            return pose
        first = self.snowfall.frame_start
        fall_angle, bearing = self.winds[min(max(frame - first, 0), len(self.winds) - 1)]
        return replace(pose, fall_angle=fall_angle, bearing=bearing)

    def needs_new_simulation(self, other):
        """Whether what differs cannot be changed in a simulation that runs."""
        return (self.specs, self.texel_size, self.snow["mapping"]) != (
            other.specs,
            other.texel_size,
            other.snow["mapping"],
        )


@dataclass(frozen=True)
class Map:
    """A receiver's map in the preview."""

    resolution: int
    texel: float
    """Metres."""
    baked_texel: float
    """Metres of a texel in a bake, in which blur is told."""


class Playback:
    """Snow over the frames of a scene. Raises what reading the scene or making the simulation raises."""

    def __init__(self, scene, depsgraph):
        self.wishes = Wishes.of(scene)
        limit, budget = preview_limits()
        self._limit = limit
        self.history = History(budget)
        self.simulation = None
        self.stale = False
        """Whether what lies does not fit the settings any more: relay() mends it."""
        try:
            self._begin(scene, depsgraph)
        except BaseException:
            self.close()
            raise

    def close(self):
        if self.simulation is not None:
            self.simulation.close()
            self.simulation = None

    # -- beginning -----------------------------------------------------------------------------------

    def _begin(self, scene, depsgraph):
        """A new simulation with the pose of the current frame, and all of that frame's snow on it."""
        self.close()
        self.history.clear()
        self.reader = SceneReader(list(self.wishes.specs), metres_per_unit(scene))
        pose = self._read(depsgraph, scene.frame_current)
        module = native.load()
        engine = preferred_engine()
        with module.Engine(engine=engine, mapping=self.wishes.snow["mapping"]) as held:
            self.maps = self._plan_maps(pose, self._limit or _automatic_limit(held.info))
            self.simulation = simulation.make_simulation(
                module,
                self.wishes.snow,
                simulation.pixel_size(pose, [own.texel for own in self.maps.values()]),
                engine,
            )
        maps = {
            key: (own.resolution, self.wishes.blur_radius * own.baked_texel, pose.objects[key].receiver.sides)
            for key, own in self.maps.items()
        }
        self._registry = simulation.Registry(self.simulation, maps)
        self._tracker = SceneTracker()
        self.pose, self.frame = pose, scene.frame_current
        self._take_pose(pose)
        self._lay([(self.frame, pose)], STEPS)

    def _read(self, depsgraph, frame):
        """The pose of a frame. The wind is the settings': Blender's evaluation may not have heard of them yet."""
        return self.wishes.with_wind(self.reader.read(depsgraph, frame), frame)

    def _plan_maps(self, pose, limit):
        """{key: Map} of the receivers."""
        maps = {}
        for key, obj in pose.objects.items():
            if obj.receiver is None or not obj.receiver.enabled:
                continue
            baked = baked_receiver.measure(obj, self.wishes.texel_size)
            resolution = min(baked.resolution, limit)
            maps[key] = Map(resolution, baked.texel * baked.resolution / resolution, baked.texel)
        if not maps:
            raise ValueError("There is nothing for snow to lie on: use 'Add Snow to Selected'")
        return maps

    # -- steps ---------------------------------------------------------------------------------------

    def _take_pose(self, pose):
        """Tells the simulation where everything is; returns what the next step must say of it."""
        added, moved = self._tracker.register_changes(pose, self.frame, 0.0)
        self._registry.register_changes(added)
        self._registry.prepare()
        self._moved = moved
        return moved

    def _step(self, pose, depth, dt):
        moved, self._moved = self._moved, {}
        self.simulation.step(moved, depth=depth, direction=_direction(pose), dt=dt)

    def _settle_pose(self, pose):
        """The pose without any snow, where something is not where it was."""
        if self._take_pose(pose):
            self._step(pose, 0.0, 0.0)

    def _lay(self, poses, steps):
        """Lays all the snow of the last of the poses [(frame, pose)] anew: each of them gets what fell since the one
        before, and becomes a moment of the history. steps: of the whole shot. The simulation has the first pose and no
        snow."""
        wishes = self.wishes
        falling = wishes.snowfall.totals[-1] - wishes.snowfall.preroll
        before, time = 0.0, wishes.snowfall.frame_start - 1
        if wishes.snowfall.preroll > 0.0:
            for step in plan.preroll_steps(wishes.snowfall, wishes.fps, wishes.snow["slide_half_life"]):
                self._step(poses[0][1], step.depth, step.dt)
            before = wishes.snowfall.preroll
        for index, (frame, pose) in enumerate(poses):
            if index:
                self._take_pose(pose)
            depth, seconds = max(0.0, wishes.total(frame) - before), max(0, frame - time) / wishes.fps
            share = depth / falling if falling > 0.0 else 0.0
            count = max(1, round(steps * share))
            for _ in range(count):
                self._step(pose, depth / count, seconds / count)
            before, time = wishes.total(frame), max(time, frame)
            self._keep(frame, pose)

    def _clear_snow(self):
        bare = _scaled(native.load().simulation_state(self.simulation), 0.0)
        native.load().set_simulation_state(self.simulation, {**bare, "step_number": 0})

    def _fall(self, pose, first, last):
        """The snow of frames first to last falls on a pose."""
        plan_ = self.wishes.snowfall
        frames = range(max(first, plan_.frame_start), min(last, plan_.frame_end) + 1)
        steps = [step for frame in frames for step in plan.frame_steps(plan_, frame, self.wishes.fps)]
        for step in steps:
            self._step(pose, step.depth, step.dt)
        if not steps:  # it still hears where everything is
            self._step(pose, 0.0, 0.0)

    # -- memory --------------------------------------------------------------------------------------

    def _keep(self, frame, pose):
        state = native.load().simulation_state(self.simulation)
        self.history.put(Moment(frame, pose, self.wishes.total(frame), state))

    def _restore(self, moment, pose):
        """The snow of a moment, as much as the settings have of it now, on a pose."""
        self._settle_pose(pose)
        state, total = moment.state, self.wishes.total(moment.frame)
        if total != moment.total and moment.total > 0.0:
            state = _scaled(state, total / moment.total)
        native.load().set_simulation_state(self.simulation, state)

    # -- following the timeline ------------------------------------------------------------------------

    def go_to(self, scene, depsgraph):
        """Comes to the scene's current frame. Raises ValueError where there is nothing to snow on any more."""
        self.heed_settings(scene, depsgraph)
        if self.stale:
            self.relay(QUICK_STEPS)
        frame = scene.frame_current
        if frame == self.frame:
            return
        pose = self._read(depsgraph, frame)
        try:
            self._come_to(frame, pose)
        except TopologyChanged:  # a receiver that came in, or whose map ends here
            self._begin(scene, depsgraph)

    def _come_to(self, frame, pose):
        ahead, last = frame - self.frame, self.frame
        self.pose, self.frame = pose, frame
        known = self.history.at(frame)
        if known is not None and _same_scene(known.pose, pose):
            self._restore(known, pose)
            return
        if known is not None:
            self.history.drop_after(frame - 1)
        nearest = self.history.before(frame)
        if 0 < ahead <= MAX_SKIPPED:
            self._take_pose(pose)
            self._fall(pose, last + 1, frame)
        elif nearest is not None and self.history.frames[-1] > frame:
            self._restore(nearest, pose)
            self._fall(pose, nearest.frame + 1, frame)
            return  # what memory has let go of stays out of it
        else:
            self.history.drop_after(frame)
            self._clear_snow()
            self._take_pose(pose)
            self._lay([(frame, pose)], STEPS)
            return
        self._keep(frame, pose)

    # -- following the settings --------------------------------------------------------------------------

    def heed_settings(self, scene, depsgraph):
        """Takes changed settings over. Returns whether the snow is another than before; where only relay() can show
        it, `stale` is set. Raises ValueError for settings that make no snowfall."""
        before, wishes = self.wishes, Wishes.of(scene)
        if wishes == before:
            return False
        self.wishes = wishes
        if wishes.needs_new_simulation(before):
            self._begin(scene, depsgraph)
            return True
        if wishes.snow != before.snow:
            self.simulation.change_settings(**simulation.changeable(wishes.snow))
        self.stale |= (wishes.snow, wishes.fps, wishes.winds) != (before.snow, before.fps, before.winds)
        changed = wishes.styles != before.styles
        if wishes.blur_radius != before.blur_radius:
            for key, own in self.maps.items():
                self.simulation.set_blur_radius(key, wishes.blur_radius * own.baked_texel)
            changed = True
        if wishes.snowfall != before.snowfall and not self.stale:
            changed |= self._heed_depth(before)
        return changed

    def heed_scene(self, scene, depsgraph):
        """Takes over what was moved, or turned the wind, while the timeline stands still. Returns whether anything
        was."""
        if scene.frame_current != self.frame:
            return False
        pose = self._read(depsgraph, self.frame)
        if _same_scene(pose, self.pose):
            return False
        turned = (pose.fall_angle, pose.bearing) != (self.pose.fall_angle, self.pose.bearing)
        self.pose = pose
        self.stale |= turned
        self.history.drop_after(self.frame)
        try:
            self._settle_pose(pose)
            self._keep(self.frame, pose)
        except TopologyChanged:
            self._begin(scene, depsgraph)
        return True

    def _heed_depth(self, before):
        was, now = before.total(self.frame), self.wishes.total(self.frame)
        if was == now:
            return False
        if was <= 0.0:
            self.stale = True
            return False
        state = _scaled(native.load().simulation_state(self.simulation), now / was)
        native.load().set_simulation_state(self.simulation, state)
        return True

    def relay(self, steps=STEPS):
        """Lays what lies anew by the settings as they are, over the poses that were played."""
        played = [(frame, pose) for frame, pose in self.history.poses() if frame < self.frame]
        stride = max(1, -(-len(played) // max(1, steps // 2)))
        poses = [*played[::-stride][::-1], (self.frame, self.pose)]
        poses = [(frame, self.wishes.with_wind(pose, frame)) for frame, pose in poses]
        self.history.forget_snow()
        self._clear_snow()
        self._take_pose(poses[0][1])
        self._lay(poses, steps)
        self.stale = False


def _automatic_limit(info):
    software = info["name"] != "GL" or any(name in info["driver"].lower() for name in SOFTWARE_DRIVERS)
    return RESOLUTION_ON_PROCESSOR if software else RESOLUTION


def _direction(pose):
    return plan.fall_direction(pose.fall_angle, pose.bearing)


def _same_scene(one, other):
    """Whether snow that fell on the one lies rightly on the other."""
    return (
        (one.fall_angle, one.bearing) == (other.fall_angle, other.bearing)
        and one.objects.keys() == other.objects.keys()
        and all(obj.prints == other.objects[key].prints for key, obj in one.objects.items())
    )


def _scaled(state, factor):
    """A simulation's state with all heights times a factor."""
    objects = {
        key: {**own, "height": own["height"] * np.float32(factor)} for key, own in state["objects"].items()
    }
    return {**state, "objects": objects}
