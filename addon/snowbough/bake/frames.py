# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of a bake: ShotPoses evaluates their poses in Blender's thread; FrameBaker has steps, snapshots for the
writer and checkpoints, in the thread of the simulation. No ``bpy``."""

import collections
import contextlib
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from ..base.map_kinds import BY_NAME
from ..cache import flying
from ..cache.errors import CacheError
from ..cache.files import frame_file
from ..cache.folder import checkpoints
from ..cache.journal import packed
from ..cache.ledger import COMMON, REMOVED
from ..scene.tracker import SceneTracker
from . import memory, plan
from .map_writer import WriteFailed
from .request import BakeCancelled, FrameResult
from .simulation import driver_text, other_engine


@dataclass
class FrameWork:
    """All that FrameBaker.bake needs for a frame."""

    frame: int
    poses: list
    """(scene.tracker.Changes, direction of the fall, scene.pose.ScenePose, [plan.Step, ...]) of each pose."""
    inputs: list
    """Fingerprints of the poses since the frame before (scene.inputs)."""
    depth: float
    """Metres on open, level ground after the frame."""
    to_world: dict
    """{key: (4, 4) from a receiver's space to metres in the world}."""
    hidden: frozenset
    """Keys of the receivers that are not shown."""


class ShotPoses:
    """The poses of a shot, in order. evaluate: see BakeJob.run. first_pose: the complete_pose of a BakeRequest's shot,
    snowfall its plan.Snowfall."""

    def __init__(self, evaluate, request, snowfall, first_pose):
        self._evaluate = evaluate
        self._request = request
        self._snowfall = snowfall
        self._first_pose = first_pose
        self._tracker = SceneTracker()
        # Number of its poses that the journals have.
        self._noted = 0
        self.first_changes = self._tracker.register_changes(first_pose, request.frame_start, 0.0)
        """scene.tracker.Changes of the first pose."""

    @property
    def inputs(self):
        """scene.inputs.SceneInputs of the poses so far."""
        return self._tracker.inputs

    def new_inputs(self):
        """The fingerprints of the poses since the last call."""
        poses = self.inputs.poses
        begin, self._noted = self._noted, len(poses)
        return poses[begin:]

    def replay(self, receivers, last, cancelled):
        """Evaluates all poses up to frame ``last`` without snow, and records those of the BakedReceivers. Returns their
        scene.tracker.Changes as one. Raises BakeCancelled."""
        start, pose = (self._request.frame_start, 0.0), self._first_pose
        changes = self._tracker.register_changes(pose, *start)
        for frame in range(start[0], last + 1):
            if cancelled():
                raise BakeCancelled
            for at, _ in plan.poses_of_frame(self._request, self._snowfall, frame):
                if at != start:
                    pose = self._evaluate(*at)
                    changes = changes.then(self._tracker.register_changes(pose, *at))
            _record(receivers, frame, pose)
        return changes

    def work(self, receivers, frame):
        """The FrameWork of a frame, whose pose the BakedReceivers record."""
        poses = []
        for at, steps in plan.poses_of_frame(self._request, self._snowfall, frame):
            pose = self._evaluate(*at)
            direction = plan.fall_direction(pose.fall_angle, pose.bearing)
            poses.append((self._tracker.register_changes(pose, *at), direction, pose, steps))
        _record(receivers, frame, pose)
        return FrameWork(
            frame,
            poses,
            self.new_inputs(),
            self._snowfall.totals[frame - self._request.frame_start],
            {receiver.key: pose.known_at(receiver.key).to_world for receiver in receivers},
            frozenset(pose.hidden),
        )


def _record(receivers, frame, pose):
    for receiver in receivers:
        receiver.record(frame, pose)


class FrameBaker:
    """Bakes the frames of a BakeJob in order.

    registry: bake.simulation.Registry of `simulation`. positions: {key: array} for the next step. driver:
    simulation.driver_text of the planned engine. resumed: whether the simulation continues from a checkpoint. writer:
    a MapWriter. log(text).
    """

    def __init__(
        self,
        request,
        native,
        simulation,
        registry,
        receivers,
        positions,
        settings,
        driver,
        resumed,
        writer,
        log,
    ):
        self._request = request
        self._native = native
        self._simulation = simulation
        self._registry = registry
        self._receivers = receivers
        self._positions = positions
        self._settings = settings
        self._driver = driver
        self._resumed = resumed
        self._writer = writer
        self._log = log
        # Whether the simulation's state is that of the last reported frame.
        self._between_frames = True
        self._flying = {}
        """Points in the air after the last frame, by receiver (cache.flying)."""
        # A file for tools/compare_hashes.py.
        self._hash_file = os.environ.get("SNOWBOUGH_PASS_HASHES")
        if self._hash_file:
            simulation.hash_passes(True)
            open(self._hash_file, "w", encoding="utf-8").close()

    def bake(self, work):
        """Simulates the steps of a FrameWork. The writer makes its maps and, at the interval, a checkpoint. Returns a
        FrameResult."""
        request, clock, frame = self._request, time.perf_counter, work.frame
        begun = clock()
        if not self._between_frames:
            raise RuntimeError("The previous frame failed: start the bake again")
        self._between_frames = False
        for changes, direction, pose, steps in work.poses:
            self._registry.register_changes(changes.added)
            self._registry.set_effects(changes.masks, changes.pressers)
            self._positions.update(changes.moved)
            for step in steps:
                self._registry.shed(step.sheds)
                self._simulation.step(
                    self._positions,
                    depth=step.depth,
                    direction=direction,
                    dt=step.dt,
                    hidden=changes.hidden,
                    **plan.weather(pose, step.sheds),
                )
                self._positions = {}
                if request.maps["points"] and not step.sheds:
                    self._simulation.take_flying()  # the shot has not begun
        self._follow_engine()
        if self._hash_file:
            self._write_hashes(frame)
        snowing = clock() - begun
        reading = -clock()
        volume, slid = self._take_snapshots(work)
        reading += clock()
        saving = clock()
        if request.is_checkpoint(frame):
            self.checkpoint(frame)
        self._between_frames = True
        saving = clock() - saving
        result = FrameResult(frame, request.first, request.last, work.depth, volume, slid)
        result.seconds = {"snow": snowing, "maps": reading, "gpu": snowing + reading + saving}
        return result

    def stop(self):
        """Writes a checkpoint of the last complete frame. If the simulation failed within a frame, its state belongs to
        no frame, and the last regular checkpoint remains."""
        self._writer.flush()
        done = self._receivers[0].last_frame
        if self._between_frames and done is not None and done not in checkpoints(self._receivers[0].folder):
            self.checkpoint(done)
            self._writer.flush()

    def _write_hashes(self, frame):
        """Appends a line per step, pass and object: frame, step, pass, object and hash, separated by tabs."""
        with open(self._hash_file, "a", encoding="utf-8") as file:
            for step, name, of, value in self._simulation.pass_hashes():
                file.write(f"{frame}\t{step}\t{name}\t{of}\t{value:08x}\n")

    def _follow_engine(self):
        """Notes the engine that really ran: a simulation may switch from OpenGL to the processor in its first step. A
        resumed bake must keep its engine."""
        engine = self._simulation.engine
        ran, meant = driver_text(engine), self._driver
        if ran == meant:
            return
        self._driver = ran
        self._log(f"engine {ran}: {engine['reason']}")
        if self._resumed and not self._request.allow_other_driver:
            raise other_engine(meant, ran)

    def _fly(self, frame):
        """Moves the points in the air on to a frame, and adds those of its snow. A resumed bake goes on from the files
        of the frame before."""
        born = self._simulation.take_flying()
        for receiver in self._receivers:
            before = self._flying.get(receiver.key)
            if before is None:
                before = flying.read_points(receiver.folder / frame_file("points", frame - 1))
            moved = flying.moved(before, 1.0 / self._request.fps)
            self._flying[receiver.key] = flying.joined(moved, born.get(receiver.key))

    def _take_snapshots(self, work):
        """Passes the snow of each receiver to the writer; returns the volumes of held and of slid snow in m3."""
        volume = slid = 0.0
        statistics = self._simulation.statistics()
        balance = statistics["objects"]
        common = {}
        if self._request.snow["landing"] and memory.has_repose(self._request.snow["repose"]):
            common = {name: float(statistics[f"{name}_volume"]) for name in COMMON}
        poses = packed(work.inputs)
        maps = {name: wanted for name, wanted in self._request.maps.items() if BY_NAME[name].channels}
        if self._request.maps["points"]:
            self._fly(work.frame)
        for receiver in self._receivers:
            snapshot = self._simulation.snapshot(receiver.key, **maps)
            points = {"points": self._flying[receiver.key]} if self._flying else {}
            total = balance[receiver.key]["total"]
            own_volume, own_slid = float(total["held_volume"]), float(total["slid_volume"])
            volume, slid = volume + own_volume, slid + own_slid
            entry = {
                "frame": work.frame,
                "depth": work.depth,
                "volume": own_volume,
                "slid": own_slid,
                "landed": float(total["landed_volume"]),
                "fallen": float(total["deposited_volume"]),
                "stretched": float(total["stretched_volume"]),
                **common,
                "direction": list(work.poses[-1][1]),
                "to_world": work.to_world[receiver.key].ravel().tolist(),
            }
            # Only where masks, objects, thaw or wind have removed snow.
            for name in REMOVED:
                if total[f"{name}_volume"] != 0.0:
                    entry[name] = float(total[f"{name}_volume"])
            if receiver.key in work.hidden:
                entry["hidden"] = True
            self._writer.call(
                lambda output, receiver=receiver, entry=entry, points=points: receiver.write_maps(
                    self._native, {**output, **points}, entry, poses
                ),
                snapshot.output,
                memory.output_bytes(receiver.resolution, self._request.maps["normal"]),
            )
        return volume, slid

    def checkpoint(self, frame):
        """Reads the state back. The writer packs and writes it, after the maps before it."""
        state = self._native.simulation_state(self._simulation)
        driver = driver_text(self._simulation.engine)
        beside = []
        if not self._request.is_checkpoint(frame):
            # The bakes of other receivers may have no checkpoint of this frame.
            beside = sorted(state["objects"].keys() - {receiver.key for receiver in self._receivers})
        for receiver in self._receivers:
            self._writer.call(
                lambda receiver=receiver: receiver.write_checkpoint(
                    self._native, frame, self._settings, state, driver, beside
                )
            )


def bake_frames(frames, evaluate, baker, finished, cancelled):
    """Bakes frames in order: evaluate(frame) -> FrameWork runs in this thread while the FrameBaker's thread simulates
    the frame before. finished(FrameResult) is called after each frame, and cancelled() before each. Raises
    BakeCancelled, or the first error; what was computed is kept."""
    clock = time.perf_counter
    with ThreadPoolExecutor(1, "snowbough-step") as worker:
        pending = collections.deque()
        started = clock()

        def finish():
            nonlocal started
            future, evaluating = pending.popleft()
            result = future.result()
            result.seconds["evaluate"] = evaluating
            result.seconds["total"], started = clock() - started, clock()
            finished(result)

        try:
            for frame in frames:
                if cancelled():
                    raise BakeCancelled
                evaluating = clock()
                work = evaluate(frame)
                pending.append((worker.submit(baker.bake, work), clock() - evaluating))
                # Finish the frame before only after submitting this one, so that the worker need not wait.
                if len(pending) > 1:
                    finish()
            while pending:
                finish()
        except BaseException as error:
            while pending:
                try:
                    finish()
                except Exception as later:
                    if isinstance(error, BakeCancelled):
                        raise later from None
            if isinstance(error, BakeCancelled):
                baker.stop()
            elif not isinstance(error, (CacheError, WriteFailed, OSError)):
                # Even if the scene cannot be read any more, e.g. after disabling the add-on, keep the frames since the
                # last checkpoint.
                with contextlib.suppress(Exception):
                    baker.stop()
            raise
