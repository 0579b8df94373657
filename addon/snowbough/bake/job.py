# SPDX-License-Identifier: GPL-3.0-or-later
"""The complete procedure of a bake, on plain data: no ``bpy`` and no references to the scene.

The hidden render engine (bake.engine) calls BakeJob.run in Blender's render thread and passes a function that returns
poses. Three tasks run in parallel: Blender evaluates the next pose in this thread, a second thread simulates the pose
before, and other threads (map_writer) compute, compress and write the maps of earlier poses. Order and results do not
depend on the scheduling of the threads.

The steps of a job are:

1. Read the first pose of the shot, and of receivers that it does not show a later one. They determine the resolutions
   and the occlusion grid, even if a part is baked.
2. Choose and lock the version.
3. Start, or resume: evaluate the frames up to the checkpoint again, compare them with its inputs, and restore it. A
   bake that adds frames to a finished one does the same with its checkpoint, in a new version (continuing).
4. For each frame: simulate its steps, write the maps and the manifest, and write a checkpoint at each interval or when
   the bake is stopped.
"""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from ..cache import owner, versions
from ..cache.errors import CacheFinished, InputsChanged
from ..cache.files import MANIFEST, digest, make_folder
from ..cache.folder import restore_manifest
from ..cache.ledger import read_ledger, write_ledger
from ..cache.lock import drop_dead_locks, lock_receivers
from ..cache.versions import is_finished
from ..surface.side_by_side import for_each, run_side_by_side, takes_longer_than, workers
from . import continuing, memory, plan, resuming, simulation
from .baked_receiver import BakedReceiver
from .choice import choose_receivers, complete_pose, share_points
from .frames import FrameBaker, ShotPoses, bake_frames
from .log import open_log
from .map_writer import MapWriter
from .request import BakeCancelled
from .simulation import driver_text, engine_info

STOPPING_SECONDS = 4.0


@dataclass
class _Run:
    """The arguments of BakeJob.run, and the shot as it is known after its first pose."""

    report: Callable
    cancelled: Callable
    shaping: Callable
    poses: ShotPoses = None
    settings: dict = None
    log: Callable = None


class BakeJob:
    """One bake. `native` is the module snowbough_native, or a substitute in tests. stopping_seconds: after a bake was
    stopped, surfaces are computed only if they take at most this long."""

    def __init__(self, request, native, stopping_seconds=STOPPING_SECONDS):
        self.request = request
        self.native = native
        self.stopping_seconds = stopping_seconds
        self.root = versions.scene_folder(request.cache, request.known_as, request.cache_id)
        self.version = None
        self.receivers = []
        self.baked = []
        """The requested receivers, including those that were finished before."""
        self.others = []
        """With landing, the shot's other receivers: their snow is simulated, too, but not written."""
        self.refused = {}
        """Label -> reason why no snow is baked on it; known after the first pose."""
        self._all_keys = []
        """Of the shot's receivers."""
        self.pixel_size = 0.0
        self.results = []
        self.folders = {}
        """Receiver's label -> folder; known after the version is chosen."""
        self.repaired = []
        """Messages about damaged files that this bake makes again."""
        self._finished = None
        """The continuing.Finished bake that this one adds frames to."""
        self._simulation = None
        self._registry = None
        # Positions for the next step of the simulation.
        self._positions = {}
        self._driver = ""
        # It loads its driver while the first pose is evaluated. Later the simulation uses it.
        self._engine = native.Engine(engine=request.engine, mapping=request.snow["mapping"])

    # -- running ---------------------------------------------------------------------------------------

    def run(self, evaluate, report=lambda result: None, cancelled=lambda: False, shaping=lambda share: None):
        """Bakes. evaluate(frame, subframe) -> scene.pose.ScenePose; report(FrameResult) is called after each frame,
        cancelled() between frames, and shaping(0 to 1) while surfaces are made.

        Raises BakeCancelled, CacheError and its subclasses, ValueError (scene or settings) or RuntimeError (NoGpu if
        engine GL is required but unavailable, or if a driver fails).
        """
        with contextlib.ExitStack() as stack:
            stack.enter_context(self._engine)
            first_pose = complete_pose(evaluate, self.request)
            run = _Run(report, cancelled, shaping)
            self._identify(first_pose)
            self.request, self._finished = continuing.find_parts(self.root, self.receivers, self.request)
            request = self.request
            snowfall = self._plan(evaluate)
            settings = run.settings = self._settings(snowfall)
            if request.extend:
                self._finished.compare_settings(self.receivers, settings, request.units)
            run.poses = ShotPoses(evaluate, request, snowfall, first_pose)
            first = run.poses.first_changes
            self._positions = first.moved
            stack.callback(self._close_simulation)
            stack.callback(lambda: [receiver.close() for receiver in self.receivers])
            if not request.may_resume:
                self._make_simulation(first)  # lays out the maps while the driver loads
            # It may raise, so call it before creating files.
            engine = engine_info(self._engine, request.snow["mapping"])
            self._driver = driver_text(engine)
            make_folder(self.root)
            stack.callback(lambda: versions.remove_empty_folders(self.root, self.folders.values()))
            self._open_version(settings, stack)
            if not self.receivers:
                self._compare_finished(run)
                if not read_ledger(self.version):  # after a kill, or damaged
                    write_ledger(self.version, self._all_keys)
                return
            rest = self._checkpoint_to_resume()
            if request.blend:
                owner.claim(self.root, request.blend)
            if request.may_resume:  # finished receivers, which need no map, are known only now
                self._make_simulation(first)
            log = run.log = stack.enter_context(open_log(self.root))
            log(f"cache {self.root}")
            log(f"engine {self._driver}: {engine['reason']}")
            log(f"{self.version.name}; {', '.join(r.shown for r in self.receivers)}")
            for reason in self.refused.values():
                log(f"left out: {reason}")
            for text in self.repaired:
                log(text)
            self._registry.prepare()
            if request.extend:
                stack.enter_context(self._discarding())
            if rest is None or request.extend:
                for_each(self.receivers, lambda receiver: receiver.start(settings))
            if rest is not None:
                self._resume_from(run, rest)
            begin = request.frame_start if rest is None else rest + 1
            writer = stack.enter_context(MapWriter(len(self.receivers)))
            baker = FrameBaker(
                request,
                self.native,
                self._simulation,
                self._registry,
                self.receivers,
                self._positions,
                settings,
                driver=self._driver,
                resumed=rest is not None,
                writer=writer,
                log=log,
            )
            if rest is not None and request.extend:
                baker.checkpoint(rest)
            try:
                self._bake(run, begin, baker, writer)
            except BakeCancelled:
                # Make surfaces of the finished frames while the user waits; Update Surface makes the rest.
                with contextlib.suppress(BakeCancelled):
                    self._make_surfaces(shaping, takes_longer_than(self.stopping_seconds))
                raise
            if request.last < request.frame_end:
                baker.stop()
            writer.flush()
            self._make_surfaces(shaping, lambda share: cancelled())
            if request.last == request.frame_end:
                for_each(self.receivers, lambda receiver: receiver.complete(settings, self.native))
                write_ledger(self.version, self._all_keys)

    def _make_surfaces(self, shaping, cancelled):
        """Computes the surfaces after the last map, because the faces of snow depend on the whole shot.
        cancelled(0 to 1): whether to stop when this share is done."""

        def progress(share):
            shaping(share)
            return not cancelled(share)

        for_each(self.receivers, BakedReceiver.finish_recording)
        jobs = [partial(receiver.make_surface, self.native) for receiver in self.receivers]
        weights = [receiver.surface_seconds for receiver in self.receivers]
        if not run_side_by_side(jobs, progress, weights):
            raise BakeCancelled
        if any(weights):
            shaping(1.0)

    @property
    def surface_seconds(self):
        """Rough time that the surfaces of this bake take, in seconds of a common processor."""
        each = [receiver.surface_seconds for receiver in self.receivers]
        return sum(each) / max(1, min(len(each), workers()))

    def _plan(self, evaluate):
        request = self.request
        rates = request.rates
        if rates is None:
            rates = [evaluate(frame, 0.0).rate for frame in range(request.frame_start, request.frame_end + 1)]
        return plan.plan_snowfall(
            request.frame_start,
            request.frame_end,
            request.start_depth,
            request.end_depth,
            rates,
            request.parts,
        )

    @contextlib.contextmanager
    def _discarding(self):
        """Removes what was written if the finished frames would change."""
        try:
            yield
        except InputsChanged:
            for receiver in self.receivers:
                receiver.discard()
            raise

    def _identify(self, pose):
        """Finds the receivers in the shot's complete_pose and determines resolutions and grid."""
        choice = choose_receivers(pose, self.request)
        self.receivers, self.refused = choice.receivers, choice.refused
        self._all_keys = [own.key for own in (*choice.receivers, *choice.others)]
        if self.request.snow["landing"]:
            self.others = choice.others
        self.pixel_size = simulation.pixel_size(pose, choice.texels, self.request.pixel_size)
        share_points(self.native, self.request, pose, self.receivers)
        sizes = [
            memory.MapSize(own.resolution, len(pose.known[own.key].topology.triangles))
            for own in [*self.receivers, *self.others]
        ]
        shortage = memory.shortage(sizes, self.request.snow["repose"], self.request.maps["normal"])
        if shortage:
            raise RuntimeError(shortage)

    # -- settings, version, checkpoint -----------------------------------------------------------------

    def _settings(self, snowfall):
        return {**self.request.shot(), "pixel_size": self.pixel_size, "totals": list(snowfall.totals)}

    def _open_version(self, settings, stack):
        keys = [receiver.key for receiver in self.receivers]
        number, finished = None, []
        if self.request.may_resume:
            number, finished = versions.resumable_version(self.root, keys)
        if number is None:
            number = versions.choose_version(self.root, keys, digest(settings))
        self.version = versions.version_folder(self.root, number)
        self.baked = list(self.receivers)
        for other in self.others:
            other.folder = self.version / other.key
        for receiver in self.receivers:
            receiver.folder = self.version / receiver.key
            receiver.cache = self.request.cache_id
            self.folders[receiver.shown] = receiver.folder
        if self.request.parts and not self.request.extend:
            self._finished = continuing.finished_before(self.version, self.receivers, self.request.parts)
        for receiver in self.receivers:
            if receiver.key in finished:
                receiver.compare_settings(settings, self.request)
        damaged = resuming.find_damage([own for own in self.receivers if own.key in finished])
        self.receivers = [own for own in self.receivers if own.key not in finished or own.key in damaged]
        if not self.receivers:
            drop_dead_locks(self.version)
            return
        lock = stack.enter_context(lock_receivers(self.version, sorted(own.key for own in self.receivers)))
        for receiver in self.receivers:
            receiver.lock = lock
            if self.request.may_resume and restore_manifest(receiver.folder):
                self.repaired.append(
                    f"{receiver.folder / MANIFEST} was damaged and is restored from a checkpoint"
                )
            if self._finished is not None:
                receiver.kept = self._finished.kept_frames(receiver, self.request.allow_other_driver)
            # Another machine may have finished it between choosing and locking.
            if receiver.key not in damaged and is_finished(receiver.folder):
                raise CacheFinished(
                    f"{receiver.shown} was just finished in {self.version.name} by another bake"
                )

    def _checkpoint_to_resume(self):
        """The frame of the checkpoint that this bake continues, None for a fresh start."""
        if self.request.extend:
            return self._finished.checkpoint_frame(self.receivers, self._beside())
        damage = resuming.find_damage(self.receivers) if self.request.may_resume else {}
        rest = resuming.checkpoint_frame(self.request, self.receivers, self._beside(), self.version, damage)
        begin = self.request.frame_start if rest is None else rest + 1
        for _, path in damage.values():
            self.repaired.append(f"{path} was missing or damaged: frames from {begin} on are baked again")
        return rest

    def _resume_from(self, run, frame):
        """Compares scene and settings with the checkpoint of ``frame`` and restores it."""
        request, beside = self.request, self._beside()
        driver = None if request.allow_other_driver else self._driver
        if request.extend:
            own, beside = self._finished.copies(self.receivers), self._finished.copies(beside)
            state, before = resuming.read_checkpoints(self.native, [], [*own, *beside], frame, driver)
            for receiver, copy in zip(self.receivers, own):
                receiver.take_frames(frame, copy.covered)
        else:
            for receiver in (*self.receivers, *beside):
                receiver.compare_settings(run.settings, request)
            state, before = resuming.read_checkpoints(self.native, self.receivers, beside, frame, driver)
        run.log(f"comparing frames {request.frame_start} to {frame} with the checkpoint")
        changes = run.poses.replay(self.receivers, frame, run.cancelled)
        run.poses.new_inputs()  # its journal has them
        self._registry.register_changes(changes.added)
        self._registry.set_effects(changes.masks, changes.pressers)
        self._positions.update(changes.moved)
        recorded = {**resuming.finished_inputs(self.baked, self.receivers), **before}
        resuming.compare_scenes(recorded, run.poses.inputs, "was baked from", "bake again from the start")
        if not request.extend:
            for receiver in self.receivers:
                receiver.forget_after(frame, run.settings)
        self.native.set_simulation_state(self._simulation, state)
        run.log(f"restored the checkpoint of frame {frame}")

    def _compare_finished(self, run):
        """Compares the scene, frame by frame, with the inputs of the finished receivers."""
        recorded = resuming.finished_inputs(self.baked, self.receivers)
        if not recorded:
            return
        run.poses.replay(self.receivers, self.request.last, run.cancelled)
        resuming.compare_scenes(
            recorded,
            run.poses.inputs,
            f"in {self.version.name} was baked from",
            "bake again; the finished version is kept until it is freed",
        )

    # -- the scene and the simulation ------------------------------------------------------------------

    def _make_simulation(self, first):
        """Makes the simulation with the scene.tracker.Changes of the shot's first pose. Needs no engine yet."""
        request = self.request
        self._simulation = simulation.make_simulation(
            self.native, request.snow, self.pixel_size, request.engine, wait_for_gpu=False
        )
        # All other objects only block snow.
        maps = {
            own.key: (
                own.resolution,
                request.blur_radius * own.texel,
                own.spec.sides,
                own.spec.shed_half_life,
            )
            for own in [*self.receivers, *self._beside()]
        }
        self._registry = simulation.Registry(self._simulation, maps)
        self._registry.register_changes(first.added)
        self._registry.set_effects(first.masks, first.pressers)

    def _beside(self):
        """The receivers that are simulated beside those that this bake writes: with landing all that are left, because
        snow falls from one onto another."""
        if not self.request.snow["landing"]:
            return []
        writes = {receiver.key for receiver in self.receivers}
        return [own for own in [*self.baked, *self.others] if own.key not in writes]

    def _bake(self, run, begin, baker, writer):
        def finished(result):
            result.seconds["files"] = writer.busy_since_last_call()
            self.results.append(result)
            seconds = (f"{name} {value:.4f}" for name, value in sorted(result.seconds.items()))
            run.log(f"frame {result.frame} " + " ".join(seconds))
            run.report(result)

        frames = range(begin, self.request.last + 1)
        bake_frames(frames, partial(self._evaluate_frame, run), baker, finished, run.cancelled)

    def _evaluate_frame(self, run, frame):
        """The FrameWork of a frame."""
        work = run.poses.work(self.receivers, frame)
        if self._finished is not None and frame <= self._finished.last:
            resuming.compare_scenes(
                self._finished.inputs(self.receivers),
                run.poses.inputs,
                f"in {self._finished.version.name} was baked from",
                "bake again from the start",
            )
        return work

    def _close_simulation(self):
        if self._simulation is not None:
            self._simulation.close()
            self._simulation = None
