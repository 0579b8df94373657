# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake from its first pose to its last file, as plain data: no ``bpy`` and no reference into the scene.

The hidden render engine (bake_engine) calls BakeJob.run in Blender's render thread and hands in a way to
get poses. Three things run beside each other: Blender evaluates the next pose in this thread, the
simulation works on the pose before in a second one, and finished maps are packed and written in a third
(map_writer). Order and results do not depend on how the threads are scheduled.

What a job does, in order: looks at the shot's first pose (it fixes resolutions and the occlusion grid,
whichever part of the shot is baked); picks and locks the version; starts, or walks the frames up to a
checkpoint again, compares them with what the checkpoint was baked from, and restores it; then frame by
frame: steps, maps, manifest, and a checkpoint where one is due or the bake is stopped.
"""

import contextlib
import datetime
import os
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import bake_plan, cache, checkpoint
from .coverage import Coverage
from .map_writer import MapWriter, WriteFailed  # noqa: F401  (raised by run)
from .scene_inputs import SceneInputs, fingerprint, pose_name


class BakeCancelled(Exception):
    """The artist stopped the bake; everything up to the last whole frame is there and resumable."""


class NoGpu(RuntimeError):
    """There is no EGL or no driver; says what the native module said."""


class TopologyChanged(ValueError):
    """An object's vertices or triangles are others than at the first frame."""


@dataclass(frozen=True)
class BakeRequest:
    """All that a bake needs to know besides poses."""

    scene_name: str
    cache: str
    """Absolute folder; the scene's folder is made inside."""
    frame_start: int
    frame_end: int
    """The shot."""
    first: int
    last: int
    """The part of the shot to bake."""
    fps: float
    start_depth: float
    end_depth: float
    rates: tuple
    """One a frame of the shot; None: to be read from the poses, because a driver gives them."""
    flutter: float
    """Degrees."""
    max_depth: float
    slide_half_life: float
    texel_size: float
    pixel_size: float
    """Metres; 0 is automatic."""
    blur_radius: float
    """Texels."""
    substeps: int
    seed: int
    checkpoint_interval: int
    write_normals: bool
    noise_density: float
    mapping: str
    receivers: tuple
    """scene_reader.ReceiverSpec of the scene's list, disabled ones included."""
    objects: tuple = ()
    """Names of the receivers to bake; empty: all that are enabled."""
    resume: bool = False
    allow_other_driver: bool = False


@dataclass
class FrameResult:
    """What the job reports after each frame."""

    frame: int
    first: int
    last: int
    depth: float
    """Metres on open ground."""
    volume: float
    """m3 that lie on the receivers that are baked."""
    slid: float
    """m3 that slid off them since the first frame."""
    seconds: dict = field(default_factory=dict)
    """evaluate, snow, write, total."""


@dataclass
class _Receiver:
    key: str
    label: str
    name: str
    library: str
    spec: object
    uv_map: str
    resolution: int
    texel: float
    """Mean texel size in metres at the shot's first frame."""
    folder: Path = None
    frames: list = field(default_factory=list)
    covered: Coverage = None


def surface_and_uv_area(topology, positions):
    """Area of an object's surface in m2 and of its UV layout (1 is the whole map), as floats."""
    corners = positions[topology.triangles].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    uv = topology.corner_uv.astype(np.float64)
    edge, other = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    uv_cross = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]
    return 0.5 * float(np.sqrt((cross * cross).sum(axis=1)).sum()), 0.5 * float(np.abs(uv_cross).sum())


class BakeJob:
    """One bake. `native` is the module snowbough_native, or what stands in for it in tests."""

    def __init__(self, request, native):
        self.request = request
        self.native = native
        self.root = cache.scene_folder(request.cache, request.scene_name)
        self.version = None
        self.receivers = []
        self.baked = []
        """The receivers asked for, also those that were finished before."""
        self.pixel_size = 0.0
        self.results = []
        self.folders = {}
        """Receiver's label -> folder, once the version is picked."""
        self._simulation = None
        # Per key: [name in the simulation, its Topology, how often that has changed].
        self._entries = {}
        self._entries_complete = False
        # Name -> positions as the simulation has them after the steps taken so far.
        self._sent = {}
        self._inputs = SceneInputs()
        self._pose_recorded = None
        self._inputs_at = []
        # What the simulation has not been told yet.
        self._positions = {}
        self._driver = ""

    # -- the recipe ------------------------------------------------------------------------------------

    def run(self, evaluate, report=lambda result: None, cancelled=lambda: False):
        """Bakes. evaluate(frame, subframe) -> scene_reader.ScenePose; report(FrameResult) after each
        frame; cancelled() is asked between frames.

        Raises BakeCancelled, cache.CacheError and its kinds, ValueError (scene or settings) or
        RuntimeError (no EGL, driver).
        """
        request = self.request
        self._driver = driver_name(self.native)  # without a GPU nothing is begun
        first_pose = evaluate(request.frame_start, 0.0)
        snowfall = self._plan(evaluate)
        self._identify(first_pose)
        settings = self._settings(snowfall)
        cache.make_folder(self.root)
        with contextlib.ExitStack() as stack:
            stack.callback(cache.remove_empty_folders, self.root)
            self._open_version(settings, stack)
            if not self.receivers:
                return
            rest = self._checkpoint_frame()
            log = stack.enter_context(self._log())
            stack.callback(self._close_simulation)
            self._make_simulation()
            if rest is None:
                self._start(settings)
                begin = request.frame_start
            else:
                self._go_on(rest, evaluate, snowfall, first_pose, settings, log)
                begin = rest + 1
            self._bake(begin, evaluate, snowfall, settings, report, cancelled, log)

    def _plan(self, evaluate):
        request = self.request
        rates = request.rates
        if rates is None:
            rates = [
                evaluate(frame, 0.0).rate for frame in range(request.frame_start, request.frame_end + 1)
            ]
        return bake_plan.plan_snowfall(
            request.frame_start, request.frame_end, request.start_depth, request.end_depth, rates
        )

    def _identify(self, pose):
        """Finds the receivers in the shot's first pose and fixes resolutions and the grid."""
        request = self.request
        seen = {(o.receiver.name, o.receiver.library) for o in pose.objects.values() if o.receiver}
        for spec in request.receivers:
            if spec.enabled and (spec.name, spec.library) not in seen:
                raise ValueError(
                    f"'{spec.name}' is on the list of receivers, but the render does not show it at frame "
                    f"{request.frame_start}: make it renderable, or take it off the list"
                )
        enabled = [o for o in pose.objects.values() if o.receiver and o.receiver.enabled]
        if not enabled:
            raise ValueError(
                "There is nothing for snow to lie on: select objects and use 'Add Snow to Selected'"
            )
        texels, wanted = [], set(request.objects)
        for obj in enabled:
            receiver = self._measure(obj)
            texels.append(receiver.texel)
            names = {obj.receiver.name, obj.label, obj.key}
            if not request.objects or names & set(request.objects):
                self.receivers.append(receiver)
            wanted -= names
        if wanted:
            raise ValueError(
                f"No enabled receiver is named {', '.join(sorted(wanted))}; there are: "
                f"{', '.join(sorted({o.receiver.name for o in enabled}))}"
            )
        boxes = [o.positions for o in pose.objects.values() if len(o.positions)]
        low = np.min([box.min(axis=0) for box in boxes], axis=0).tolist()
        high = np.max([box.max(axis=0) for box in boxes], axis=0).tolist()
        self.pixel_size = request.pixel_size or bake_plan.automatic_pixel_size(texels, low, high)

    def _measure(self, obj):
        try:
            areas = surface_and_uv_area(obj.topology, obj.positions)
            per_map = bake_plan.metres_per_map(*areas)
        except ValueError as error:
            raise ValueError(f"'{obj.label}': {error}") from error
        resolution = obj.receiver.resolution or bake_plan.automatic_resolution(*areas, self.request.texel_size)
        if not bake_plan.MIN_RESOLUTION <= resolution <= bake_plan.MAX_RESOLUTION:
            raise ValueError(
                f"'{obj.label}' has a resolution of {resolution}; it must be 0 (automatic) or from "
                f"{bake_plan.MIN_RESOLUTION} to {bake_plan.MAX_RESOLUTION}"
            )
        return _Receiver(
            obj.key, obj.label, obj.name, obj.library, obj.receiver, obj.uv_map, resolution, per_map / resolution
        )

    # -- settings, version, checkpoint -----------------------------------------------------------------

    def _settings(self, snowfall):
        request = self.request
        shot = {
            name: getattr(request, name)
            for name in (
                "frame_start", "frame_end", "fps", "start_depth", "end_depth", "flutter", "max_depth",
                "slide_half_life", "blur_radius", "substeps", "seed", "noise_density", "mapping",
                "write_normals", "checkpoint_interval",
            )
        }  # fmt: skip
        return {**shot, "pixel_size": self.pixel_size, "totals": list(snowfall.totals)}

    def _receiver_settings(self, receiver, settings):
        own = {"resolution": receiver.resolution, "uv_map": receiver.uv_map, "name": receiver.label}
        return {"shot": cache.digest(settings), "snowfall": settings, "receiver": own}

    def _open_version(self, settings, stack):
        keys = [receiver.key for receiver in self.receivers]
        number, finished = None, []
        if self.request.resume or self.request.first > self.request.frame_start:
            number, finished = cache.resumable_version(self.root, keys)
        if number is None:
            number = cache.choose_version(self.root, keys, cache.digest(settings))
        self.version = cache.version_folder(self.root, number)
        self.baked = list(self.receivers)
        for receiver in self.receivers:
            receiver.folder = self.version / receiver.key
            self.folders[receiver.label] = receiver.folder
        for receiver in self.receivers:
            if receiver.key in finished:
                self._compare_settings(receiver, settings)
        self.receivers = [receiver for receiver in self.receivers if receiver.key not in finished]
        for receiver in self.receivers:
            stack.enter_context(cache.lock_folder(receiver.folder))
            # Between choosing and locking another machine may have finished it.
            if (cache.read_manifest(receiver.folder) or {}).get("complete"):
                raise cache.CacheFinished(
                    f"{receiver.label} was just finished in {self.version.name} by another bake; nothing to do"
                )

    def _compare_settings(self, receiver, settings):
        manifest = cache.read_manifest(receiver.folder)
        if manifest is None:
            return
        changes = cache.describe_changes(
            manifest["settings"], {**self._receiver_settings(receiver, settings)}
        )
        changes = [change for change in changes if not change.startswith("shot:")]
        if changes:
            raise cache.InputsChanged(
                f"{receiver.label} in {self.version.name} was baked with other settings "
                f"({'; '.join(changes)}): bake again from the start, or set them back"
            )

    def _checkpoint_frame(self):
        """The frame of the checkpoint to go on from, None for a fresh start."""
        request = self.request
        common = set.intersection(*(set(cache.checkpoints(r.folder)) for r in self.receivers))
        if request.resume:
            usable = [frame for frame in common if request.first - 1 <= frame <= request.last]
            if usable:
                return max(usable)
        elif request.first - 1 in common and request.first > request.frame_start:
            return request.first - 1
        if request.first > request.frame_start:
            there = f"there are: {sorted(common)}" if common else "there is none"
            raise cache.NoCheckpoint(
                f"Frame {request.first} needs the checkpoint of frame {request.first - 1} in {self.version} "
                f"({there}). Bake from frame {request.frame_start}, or start after a checkpoint"
            )
        return None

    def _start(self, settings):
        """Makes the folders ready for the shot's first frame."""
        for receiver in self.receivers:
            cache.clear(receiver.folder, keep_lock=True)
            receiver.covered = Coverage(receiver.resolution)
            self._write_manifest(receiver, settings, complete=False)

    def _go_on(self, frame, evaluate, snowfall, first_pose, settings, log):
        """Compares scene and settings with the checkpoint of ``frame`` and restores it."""
        request = self.request
        sidecars = {}
        for receiver in self.receivers:
            self._compare_settings(receiver, settings)
            cache.remove_stray_files(receiver.folder)
            sidecar = sidecars[receiver.key] = cache.read_sidecar(receiver.folder, frame)
            receiver.covered = Coverage.unpack(receiver.resolution, sidecar["covered"])
            receiver.frames = sidecar["frames"]
            if sidecar["driver"] != self._driver and not request.allow_other_driver:
                raise cache.InputsChanged(
                    f"The checkpoint was made with another driver ({sidecar['driver']}, this is {self._driver}), so "
                    "the bake would not end with the same bytes: resume there, or allow another driver"
                )
        log(f"comparing frames {request.frame_start} to {frame} with the checkpoint")
        self._walk(evaluate, snowfall, first_pose, frame)
        before = SceneInputs(next(iter(sidecars.values()))["inputs"])
        difference = before.first_difference(self._inputs)
        if difference:
            raise cache.InputsChanged(
                f"The scene is not the one that was baked ({difference}): bake again from the start"
            )
        for receiver in self.receivers:
            cache.remove_frames_after(receiver.folder, frame)
            for later in cache.checkpoints(receiver.folder):
                if later > frame:
                    cache.remove_checkpoint(receiver.folder, later)
        self._restore(frame)
        log(f"restored the checkpoint of frame {frame}")

    def _restore(self, frame):
        parts = {r.key: checkpoint.read(r.folder / cache.state_file(frame)) for r in self.receivers}
        numbers = {number for number, _ in parts.values()}
        if len(numbers) > 1:
            raise cache.InputsChanged(
                f"The receivers' checkpoints of frame {frame} do not belong together (steps "
                f"{', '.join(map(str, sorted(numbers)))}): bake again from the start"
            )
        state = {"step_number": numbers.pop(), "objects": {key: own for key, (_, own) in parts.items()}}
        self.native.set_simulation_state(self._simulation, state)

    def _walk(self, evaluate, snowfall, first_pose, last):
        """Evaluates all poses up to frame ``last`` without snow, and hands the simulation its objects."""
        start = (self.request.frame_start, 0.0)
        added, positions = self._take(first_pose, *start)
        for frame in range(start[0], last + 1):
            for at, _ in self._poses(snowfall, frame):
                if at != start:
                    more, moved = self._take(evaluate(*at), *at)
                    added += more
                    positions.update(moved)
        self._add(added)
        self._positions = positions

    # -- the scene and the simulation ------------------------------------------------------------------

    def _make_simulation(self):
        request = self.request
        self._simulation = self.native.SnowSimulation(
            pixel_size=self.pixel_size,
            noise_density=request.noise_density,
            flutter=request.flutter,
            max_depth=request.max_depth,
            slide_half_life=request.slide_half_life,
            blur_radius=request.blur_radius * min(receiver.texel for receiver in self.receivers),
            seed=request.seed,
            mapping=request.mapping,
        )

    def _add(self, added):
        """Adds objects to the simulation: receivers that this bake writes, and all else to shelter them."""
        baked = {receiver.key: receiver for receiver in self.receivers}
        for name, topology in added:
            receiver = baked.get(name)
            self._simulation.add_object(
                name,
                topology.triangles,
                topology.corner_uv if receiver else np.zeros((len(topology.triangles), 3, 2), np.float32),
                resolution=receiver.resolution if receiver else bake_plan.MIN_RESOLUTION,
                receive=receiver is not None,
                occlude=True,
            )

    def _take(self, pose, frame, subframe):
        """Notes a pose among the inputs; returns (objects to add: [(name, Topology)], positions of what is
        not where it was: {name: (V, 3)}) for the simulation.

        Names are the keys. An occluder whose topology changes goes on under a new name, key~1, key~2 and
        so on, and its former self is drawn together in one point, where it shelters nothing; so is what
        leaves the render.
        """
        name = pose_name(frame, subframe)
        added, changed, present = [], {}, set()
        for key, obj in pose.objects.items():
            entry = self._entries.get(key)
            if entry is None:
                if obj.receiver is not None and self._entries_complete:
                    raise TopologyChanged(
                        f"'{obj.label}' is a receiver that appears at frame {name}, after the shot's first: "
                        "make it renderable from the start, outside the picture"
                    )
                entry = self._entries[key] = [key, obj.topology, 0]
                added.append((key, obj.topology))
            elif entry[1] is not obj.topology and entry[1].print != obj.topology.print:
                if obj.receiver is not None:
                    raise TopologyChanged(
                        f"'{obj.label}' has other vertices, faces or UVs at frame {name} than before: snow "
                        "needs one topology for the whole shot. Apply the modifier that changes it, or take "
                        "it off the list of receivers"
                    )
                number = entry[2] + 1
                entry = self._entries[key] = [f"{key}~{number}", obj.topology, number]
                added.append((entry[0], obj.topology))
            present.add(entry[0])
            if len(obj.positions) and self._sent.get(entry[0]) is not obj.positions:
                changed[entry[0]] = self._sent[entry[0]] = obj.positions
        for gone in self._sent.keys() - present:
            last = self._sent[gone]
            if not (last == last[0]).all():
                changed[gone] = self._sent[gone] = np.repeat(last[:1], len(last), axis=0)
        self._entries_complete = True
        if name != self._pose_recorded:
            sky = fingerprint(np.array([pose.fall_angle, pose.bearing], dtype=np.float64))
            self._inputs.add(name, {**dict(_unique_labels(pose.objects)), "Snowfall": (sky, "", "")})
            self._pose_recorded = name
        return added, changed

    def _poses(self, snowfall, frame):
        """[((frame, subframe), [Step, ...]), ...] that lead to the map of ``frame``."""
        request = self.request
        steps = bake_plan.frame_steps(snowfall, frame, request.fps, request.substeps)
        if frame == request.frame_start:
            steps = bake_plan.preroll_steps(snowfall, request.fps, request.slide_half_life) + steps
        poses = []
        for step in steps:
            at = (step.frame, step.subframe)
            if not poses or poses[-1][0] != at:
                poses.append((at, []))
            poses[-1][1].append(step)
        return poses

    def _bake(self, begin, evaluate, snowfall, settings, report, cancelled, log):
        request = self.request
        clock = time.perf_counter
        with MapWriter(self.native) as writer, ThreadPoolExecutor(1, "snowbough-step") as worker:
            pending = None
            started = clock()

            def finish(future):
                nonlocal started
                result = future.result()
                result.seconds["total"], started = clock() - started, clock()
                self.results.append(result)
                log(
                    f"frame {result.frame} "
                    + " ".join(f"{name} {value:.4f}" for name, value in sorted(result.seconds.items()))
                )
                report(result)

            try:
                for frame in range(begin, request.last + 1):
                    if cancelled():
                        raise BakeCancelled
                    work, evaluating = [], clock()
                    for at, steps in self._poses(snowfall, frame):
                        pose = evaluate(*at)
                        direction = bake_plan.fall_direction(pose.fall_angle, pose.bearing)
                        work.append((*self._take(pose, *at), direction, steps))
                    evaluating = clock() - evaluating
                    inputs = [list(entry) for entry in self._inputs.poses]
                    if pending is not None:
                        finish(pending)
                        pending = None
                    pending = worker.submit(
                        self._frame, frame, work, inputs, snowfall, settings, writer, evaluating
                    )
                if pending is not None:
                    future, pending = pending, None
                    finish(future)
            except BaseException as error:
                # What was computed is worth keeping; the first error is the one to tell about.
                if pending is not None:
                    try:
                        finish(pending)
                    except Exception as later:
                        if isinstance(error, BakeCancelled):
                            raise later from None
                if isinstance(error, BakeCancelled):
                    self._stop(settings, writer)
                raise
            last = request.last
            if last == request.frame_end:
                writer.flush()
                self._complete(settings)
            else:
                self._stop(settings, writer)

    def _frame(self, frame, work, inputs, snowfall, settings, writer, evaluating):
        """Steps, maps and, where due, the checkpoint of one frame; in the worker's thread."""
        request, clock = self.request, time.perf_counter
        begun = clock()
        for added, changed, direction, steps in work:
            self._add(added)
            self._positions.update(changed)
            for step in steps:
                self._simulation.step(
                    self._positions, depth=step.depth, direction=direction, dt=step.dt
                )
                self._positions = {}
        snowing = clock() - begun
        volume = slid = 0.0
        balance = self._simulation.statistics()["objects"]
        for receiver in self.receivers:
            output = self._output(receiver)
            receiver.covered.add(output["height"])
            writer.write(receiver.folder / cache.frame_file("height", frame), output["height"])
            if request.write_normals:
                writer.write(receiver.folder / cache.frame_file("normal", frame), output["normal"])
            total = balance[receiver.key]["total"]
            lying, gone = float(total["held_volume"]), float(total["slid_volume"])
            volume, slid = volume + lying, slid + gone
            receiver.frames.append(
                {
                    "frame": frame,
                    "depth": snowfall.totals[frame - request.frame_start],
                    "volume": lying,
                    "slid": gone,
                    "highest": float(output["height"].max()),
                }
            )
        self._inputs_at = inputs
        maps = clock() - begun - snowing
        regular = (frame - request.frame_start + 1) % request.checkpoint_interval == 0
        if regular and frame < request.frame_end:
            self._checkpoint(frame, settings, writer)
        waiting = clock() - begun - snowing - maps
        result = FrameResult(frame, request.first, request.last, snowfall.totals[frame - request.frame_start],
                             volume, slid)  # fmt: skip
        result.seconds = {"evaluate": evaluating, "snow": snowing, "maps": maps, "checkpoint": waiting}
        return result

    def _output(self, receiver):
        """The maps of a receiver as they are written: {"height": (H, H)} and, where asked for, "normal"."""
        if hasattr(self._simulation, "output"):
            return self._simulation.output(receiver.key)
        return {"height": self._simulation.height(receiver.key)}

    # -- files -----------------------------------------------------------------------------------------

    def _checkpoint(self, frame, settings, writer):
        writer.flush()
        state = self.native.simulation_state(self._simulation)
        for receiver in self.receivers:
            cache.write_sidecar(
                receiver.folder,
                frame,
                {
                    "covered": receiver.covered.pack(),
                    "driver": self._driver,
                    "frames": receiver.frames,
                    "inputs": self._inputs_at,
                },
            )
            self._write_manifest(receiver, settings, complete=False)
            checkpoint.write(
                receiver.folder / cache.state_file(frame),
                state["step_number"],
                state["objects"][receiver.key],
            )
            cache.remove_irregular_checkpoints(
                receiver.folder, self.request.frame_start, self.request.checkpoint_interval, frame
            )

    def _stop(self, settings, writer):
        """Leaves a checkpoint at the last frame that is whole."""
        done = self.receivers[0].frames
        writer.flush()
        if done and done[-1]["frame"] not in cache.checkpoints(self.receivers[0].folder):
            self._checkpoint(done[-1]["frame"], settings, writer)

    def _complete(self, settings):
        for receiver in self.receivers:
            receiver.covered.write(self.native, receiver.folder / cache.EVER_COVERED)
            cache.remove_irregular_checkpoints(
                receiver.folder,
                self.request.frame_start,
                self.request.checkpoint_interval,
                self.request.frame_end + 1,
            )
            self._write_manifest(receiver, settings, complete=True)

    def _write_manifest(self, receiver, settings, complete):
        own = self._receiver_settings(receiver, settings)
        cache.write_manifest(
            receiver.folder,
            {
                "object": receiver.name,
                "label": receiver.label,
                "library": receiver.library,
                "complete": complete,
                "hash": cache.digest(own),
                "settings": own,
                "frames": receiver.frames,
            },
        )

    @contextlib.contextmanager
    def _log(self):
        """A file of its own for times and the GPU, so that equal bakes are equal bytes."""
        folder = self.root / "logs"
        cache.make_folder(folder)
        stamp = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%S")
        path = folder / f"{stamp}-{safe_host()}-{os.getpid()}.log"
        with open(path, "a", encoding="utf-8") as stream:

            def log(line):
                with contextlib.suppress(OSError):  # a full disk is told about by the maps' own writer
                    stream.write(f"{datetime.datetime.now(datetime.timezone.utc).isoformat()} {line}\n")
                    stream.flush()

            log(f"{self._driver}; {self.version.name}; {', '.join(r.label for r in self.receivers)}")
            yield log

    def _close_simulation(self):
        if self._simulation is not None:
            self._simulation.close()
            self._simulation = None


def driver_name(native):
    """What decides about the last bit of a map. Raises NoGpu."""
    try:
        info = native.gpu_info()
    except RuntimeError as error:
        raise NoGpu(f"Snow is computed with OpenGL, which is not to be had here: {error}") from error
    return f"{info['renderer']}, {info['version']}"


def safe_host():
    return cache.safe_name(socket.gethostname())


def _unique_labels(objects):
    """(label, prints) of every object; a label that several share gets a number, in the order of keys."""
    counts = {}
    for key in sorted(objects):
        label = objects[key].label
        counts[label] = counts.get(label, 0) + 1
        yield (label if counts[label] == 1 else f"{label} ({counts[label]})"), objects[key].prints
