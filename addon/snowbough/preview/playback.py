# SPDX-License-Identifier: GPL-3.0-or-later
"""The simulation behind the live preview: it follows the timeline and the settings.

- **Forwards**, each frame's snow falls on the pose of that frame. A step over dropped frames includes their snow.
- **Back**, and forwards within the played frames, the snow comes from the history. For a frame that the history has
  dropped, the snow since the moment before it falls on the current pose.
- **Anywhere else**, all the snow of that frame falls on its pose.
- **Settings.** Another depth scales the snow, another blur smooths it again. Other changes, such as the direction, make
  the snow stale: `resimulate` repeats the snowfall on poses that were played, first in few steps for a quick picture,
  then in as many as a bake takes for its start depth.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..bake import baked_receiver, plan, simulation
from ..bake.from_scene import constant_rates, constant_values
from ..base import native
from ..base.names import is_software
from ..scene.masks import load_sequences
from ..scene.pose import TopologyChanged, metres_per_unit
from ..scene.reader import SceneReader
from ..scene.receivers import receiver_specs
from ..scene.tracker import SceneTracker
from ..settings.preferences import preferred_engine, preview_limits
from ..settings.simulation import snow_of
from .history import History, Moment

# Frames dropped by playback that one step may include.
MAX_SKIPPED = 8
# Steps that repeat the snow of a whole shot: while a setting is being dragged, and afterwards.
QUICK_STEPS = 6
STEPS = plan.PREROLL_STEPS
# Resolutions of maps if neither the preferences nor the receiver set one: on a graphics card, and on the processor.
RESOLUTION = 1024
RESOLUTION_ON_PROCESSOR = 256


@dataclass(frozen=True)
class PreviewSettings:
    """The settings of a scene that the preview uses, as plain data."""

    snowfall: plan.Snowfall
    fps: float
    snow: dict
    """settings.simulation.snow_of."""
    blur_radius: float
    """In texels of the baked map."""
    texel_size: float
    specs: tuple
    """scene.pose.ReceiverSpec without styles, which do not affect the simulation."""
    styles: tuple
    """The same with styles."""
    winds: tuple
    """(fall angle, bearing) of every frame of the shot; empty if they are only known by evaluating the scene."""

    @classmethod
    def from_scene(cls, scene):
        """Raises ValueError for settings that give no snowfall."""
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

    @property
    def can_scale(self):
        """Whether another depth scales the snow: not where it thaws or drifts."""
        return self.snowfall.totals[-1] >= self.snowfall.preroll and not self.snow["drift"]

    def total(self, frame):
        """Snow depth in metres on open, level ground after a frame."""
        first, last = self.snowfall.frame_start, self.snowfall.frame_end
        return self.snowfall.totals[min(frame, last) - first] if frame >= first else self.snowfall.preroll

    def with_wind(self, pose, frame):
        """The pose of a frame with the wind of these settings."""
        if not self.winds:
            return pose
        first = self.snowfall.frame_start
        fall_angle, bearing = self.winds[min(max(frame - first, 0), len(self.winds) - 1)]
        return replace(pose, fall_angle=fall_angle, bearing=bearing)

    def needs_new_simulation(self, other):
        """Whether a running simulation cannot take the changed settings."""
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
    """Size of a texel, in metres."""
    baked_texel: float
    """Size of a texel in a bake, in metres; the unit of the blur radius."""


class Playback:
    """Snow over the frames of a scene. Raises what reading the scene or making the simulation raises."""

    def __init__(self, scene, depsgraph):
        self.settings = PreviewSettings.from_scene(scene)
        limit, budget = preview_limits()
        self._limit = limit
        self.history = History(budget)
        self.simulation = None
        self.stale = False
        """Whether the snow does not fit the settings any more; resimulate() corrects it."""
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
        """Makes a new simulation at the pose of the current frame, with all the snow of that frame."""
        self.close()
        self.history.clear()
        snowfall = self.settings.snowfall
        load_sequences(self.settings.specs, snowfall.frame_start, snowfall.frame_end)
        self.reader = SceneReader(list(self.settings.specs), metres_per_unit(scene))
        pose = self._read(depsgraph, scene.frame_current)
        module = native.load()
        engine = preferred_engine()
        with module.Engine(engine=engine, mapping=self.settings.snow["mapping"]) as held:
            self.maps = self._plan_maps(pose, self._limit or _automatic_limit(held.info))
            self.simulation = simulation.make_simulation(
                module,
                self.settings.snow,
                simulation.pixel_size(pose, [own.texel for own in self.maps.values()]),
                engine,
            )
        maps = {
            key: (
                own.resolution,
                self.settings.blur_radius * own.baked_texel,
                pose.objects[key].receiver.sides,
                pose.objects[key].receiver.shed_half_life,
            )
            for key, own in self.maps.items()
        }
        self._registry = simulation.Registry(self.simulation, maps)
        self._tracker = SceneTracker()
        self._hidden = frozenset()
        self.pose, self.frame = pose, scene.frame_current
        self._set_pose(pose)
        self._accumulate([(self.frame, pose)], STEPS)

    def _read(self, depsgraph, frame):
        """The pose of a frame. The wind comes from the settings, which Blender may not have evaluated yet."""
        return self.settings.with_wind(self.reader.read(depsgraph, frame), frame)

    def _plan_maps(self, pose, limit):
        """{key: Map} of the receivers."""
        maps = {}
        for key, obj in pose.objects.items():
            if obj.receiver is None or not obj.receiver.enabled:
                continue
            baked = baked_receiver.measure(obj, self.settings.texel_size)
            resolution = min(baked.resolution, limit)
            maps[key] = Map(resolution, baked.texel * baked.resolution / resolution, baked.texel)
        if not maps:
            raise ValueError("There is nothing for snow to lie on: use 'Add Snow to Selected'")
        return maps

    # -- steps ---------------------------------------------------------------------------------------

    def _set_pose(self, pose):
        """Passes new meshes to the simulation. Stores the moved positions and hidden objects for the next step; returns
        whether there are others than before."""
        changes = self._tracker.register_changes(pose, self.frame, 0.0)
        self._registry.register_changes(changes.added)
        self._registry.set_effects(changes.masks, changes.pressers)
        self._registry.prepare()
        has_changed = bool(changes.moved or changes.masks) or changes.hidden != self._hidden
        self._moved, self._hidden = changes.moved, changes.hidden
        return has_changed

    def _step(self, pose, depth, dt, sheds=True):
        moved, self._moved = self._moved, {}
        self._registry.shed(sheds)
        direction = plan.fall_direction(pose.fall_angle, pose.bearing)
        weather = plan.weather(pose, sheds)
        self.simulation.step(moved, depth=depth, direction=direction, dt=dt, hidden=self._hidden, **weather)

    def _settle_pose(self, pose):
        """Applies the pose in a step without snow, if anything has moved."""
        if self._set_pose(pose):
            self._step(pose, 0.0, 0.0)

    def _accumulate(self, poses, steps):
        """Simulates all the snow up to the last of the poses [(frame, pose)]. Each pose gets the snow since the one
        before and becomes a moment of the history. steps: of the whole shot. The simulation must have the first pose
        and no snow."""
        settings = self.settings
        falling = settings.snowfall.totals[-1] - settings.snowfall.preroll
        before, time = 0.0, settings.snowfall.frame_start - 1
        if settings.snowfall.preroll > 0.0:
            for step in plan.preroll_steps(settings.snowfall, settings.fps, settings.snow["slide_half_life"]):
                self._step(poses[0][1], step.depth, step.dt, step.sheds)
            before = settings.snowfall.preroll
        for index, (frame, pose) in enumerate(poses):
            if index:
                self._set_pose(pose)
            depth, seconds = settings.total(frame) - before, max(0, frame - time) / settings.fps
            share = max(0.0, depth / falling) if falling != 0.0 else 0.0
            count = max(1, round(steps * share))
            for _ in range(count):
                self._step(pose, depth / count, seconds / count)
            before, time = settings.total(frame), max(time, frame)
            self._keep(frame, pose)

    def _clear_snow(self):
        state = native.load().simulation_state(self.simulation)
        bare = _scaled({**state, "pressers": {}}, 0.0)
        for own in bare["objects"].values():
            own.pop("planes", None)
        native.load().set_simulation_state(self.simulation, {**bare, "step_number": 0})

    def _snow_frames(self, pose, first, last):
        """Lets the snow of the frames first to last fall on a pose."""
        snowfall = self.settings.snowfall
        frames = range(max(first, snowfall.frame_start), min(last, snowfall.frame_end) + 1)
        steps = [step for frame in frames for step in plan.frame_steps(snowfall, frame, self.settings.fps)]
        for step in steps:
            self._step(pose, step.depth, step.dt, step.sheds)
        if not steps:  # the simulation still needs the positions
            self._step(pose, 0.0, 0.0)

    # -- memory --------------------------------------------------------------------------------------

    def _keep(self, frame, pose):
        state = native.load().simulation_state(self.simulation)
        self.history.put(Moment(frame, pose, self.settings.total(frame), state))

    def _restore(self, moment, pose):
        """Restores the snow of a moment, scaled to the current depth, on a pose."""
        self._settle_pose(pose)
        state, total = moment.state, self.settings.total(moment.frame)
        if total != moment.total and moment.total > 0.0:
            state = _scaled(state, total / moment.total)
        native.load().set_simulation_state(self.simulation, state)

    # -- following the timeline ------------------------------------------------------------------------

    def go_to(self, scene, depsgraph):
        """Goes to the scene's current frame. Raises ValueError if no receiver is left."""
        self.apply_settings(scene, depsgraph)
        if self.stale:
            self.resimulate(QUICK_STEPS)
        frame = scene.frame_current
        if frame == self.frame:
            return
        pose = self._read(depsgraph, frame)
        try:
            self._advance_to(frame, pose)
        except TopologyChanged:  # a receiver appeared, or its map cannot carry its new faces
            self._begin(scene, depsgraph)

    def _advance_to(self, frame, pose):
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
            self._set_pose(pose)
            self._snow_frames(pose, last + 1, frame)
        elif nearest is not None and self.history.frames[-1] > frame:
            self._restore(nearest, pose)
            self._snow_frames(pose, nearest.frame + 1, frame)
            return  # frames that the history has dropped stay out of it
        else:
            self.history.drop_after(frame)
            self._clear_snow()
            self._set_pose(pose)
            self._accumulate([(frame, pose)], STEPS)
            return
        self._keep(frame, pose)

    # -- following the settings --------------------------------------------------------------------------

    def apply_settings(self, scene, depsgraph):
        """Applies changed settings. Returns whether the snow has changed. Where only resimulate() can show the change,
        sets `stale` instead. Raises ValueError for settings that give no snowfall."""
        before, settings = self.settings, PreviewSettings.from_scene(scene)
        if settings == before:
            return False
        self.settings = settings
        if settings.needs_new_simulation(before):
            self._begin(scene, depsgraph)
            return True
        if settings.snow != before.snow:
            self.simulation.change_settings(**simulation.changeable(settings.snow))
        self.stale |= (settings.snow, settings.fps, settings.winds) != (before.snow, before.fps, before.winds)
        changed = settings.styles != before.styles
        if settings.blur_radius != before.blur_radius:
            for key, own in self.maps.items():
                self.simulation.set_blur_radius(key, settings.blur_radius * own.baked_texel)
            changed = True
        can_scale = settings.can_scale and before.can_scale
        self.stale |= settings.snowfall != before.snowfall and not can_scale
        if settings.snowfall != before.snowfall and not self.stale:
            changed |= self._apply_depth(before)
        return changed

    def apply_scene(self, scene, depsgraph):
        """Applies moved objects and turned wind while the timeline stands still. Returns whether anything changed."""
        if scene.frame_current != self.frame:
            return False
        pose = self._read(depsgraph, self.frame)
        if _same_scene(pose, self.pose):
            return False
        turned = pose.weather != self.pose.weather
        before = self.pose.objects
        masked = any(key in before and own.mask is not before[key].mask for key, own in pose.objects.items())
        self.pose = pose
        self.stale |= turned
        self.history.drop_after(self.frame)
        if masked:  # the snow of earlier frames fell on another one
            self.history.clear()
            self.stale = True
        try:
            self._settle_pose(pose)
            self._keep(self.frame, pose)
        except TopologyChanged:
            self._begin(scene, depsgraph)
        return True

    def _apply_depth(self, before):
        was, now = before.total(self.frame), self.settings.total(self.frame)
        if was == now:
            return False
        if was <= 0.0:
            self.stale = True
            return False
        state = _scaled(native.load().simulation_state(self.simulation), now / was)
        native.load().set_simulation_state(self.simulation, state)
        return True

    def resimulate(self, steps=STEPS):
        """Repeats the snowfall with the current settings over the poses that were played."""
        played = [(frame, pose) for frame, pose in self.history.poses() if frame < self.frame]
        stride = max(1, -(-len(played) // max(1, steps // 2)))
        poses = [*played[::-stride][::-1], (self.frame, self.pose)]
        poses = [(frame, self.settings.with_wind(pose, frame)) for frame, pose in poses]
        self.history.forget_snow()
        self._clear_snow()
        self._set_pose(poses[0][1])
        self._accumulate(poses, steps)
        self.stale = False


def _automatic_limit(info):
    software = info["name"] != "GL" or is_software(info["driver"])
    return RESOLUTION_ON_PROCESSOR if software else RESOLUTION


def _same_scene(one, other):
    """Whether the snow that fell on one pose also fits the other."""
    return (
        one.weather == other.weather
        and one.objects.keys() == other.objects.keys()
        and all(obj.prints == other.objects[key].prints for key, obj in one.objects.items())
    )


def _scaled(state, factor):
    """A simulation's state with all heights multiplied by a factor."""
    objects = {
        key: {**own, "height": own["height"] * np.float32(factor)} for key, own in state["objects"].items()
    }
    return {**state, "objects": objects}
