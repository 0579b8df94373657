# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver of a bake: its size, its settings, its manifest and its checkpoints. No ``bpy``."""

import contextlib
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from ..base.map_kinds import BY_NAME
from ..base.names import MAX_RESOLUTION, MIN_RESOLUTION
from ..cache import flying
from ..cache import folder as receiver_folder
from ..cache.coverage import Coverage
from ..cache.errors import CacheError, InputsChanged, LockLost, with_remedy
from ..cache.files import (
    EVER_COVERED,
    MANIFEST,
    POSITIONS,
    RECEIVER,
    bake_files,
    digest,
    frame_file,
    state_file,
)
from ..cache.integrity import checksums_of, first_damage
from ..cache.journal import Journal
from ..cache.manifest import describe_changes, read_head, write_manifest
from ..scene.uv_overlap import outside_share, tiles_text
from ..surface.compute import damaged as damaged_surface
from ..surface.compute import update as update_surface
from ..surface.recording import ReceiverRecorder
from ..surface.style import WantedPoints
from . import plan
from .continuing import is_longer

# How snow is deposited. A bake is only resumed with the same method; the first one (scattering) stored no name.
DEPOSIT = "gathered"


@dataclass
class BakedReceiver:
    """A receiver that a bake writes."""

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
    cache: str = ""
    """Identity of the .blend's cache."""
    lock: object = None
    """cache.lock.BakeLock; required for writing."""
    journal: Journal = None
    """Of the folder, while it is written."""
    last_frame: int = None
    """The last frame whose maps were written."""
    found: tuple = ()
    """Frames of the checkpoints that the bake found and has not passed."""
    covered: Coverage = None
    wanted: WantedPoints = WantedPoints()
    """Its part in the surface points of the scene."""
    surface_seconds: float = 0.0
    """Rough time that its surface takes."""
    kept: object = None
    """bake.continuing.KeptFrames of the bake that this one continues."""
    recorder: ReceiverRecorder = None
    """Records its poses if the bake ends with a surface."""

    @property
    def shown(self):
        """The label for the user."""
        return self.spec.shown(self.label)

    def settings(self, shot):
        """All that its maps depend on: the settings of the shot (a dict) and its own."""
        own = {
            "resolution": self.resolution,
            "uv_map": self.uv_map,
            "name": self.label,
            "sides": self.spec.sides,
        }
        if self.spec.mask is not None:
            own["mask"] = self.spec.mask.text
        if self.spec.shed_half_life:
            own["shed_half_life"] = self.spec.shed_half_life
        return {"shot": digest(shot), "snowfall": shot, "receiver": own, "deposit": DEPOSIT}

    def compare_settings(self, shot, request):
        """Raises InputsChanged, naming the differences, if the folder was baked with other settings than those of the
        `request`."""
        manifest = read_head(self.folder)
        if manifest is None:
            return
        before, units = manifest["settings"], request.units
        changes = describe_changes(before, self.settings(shot), units)
        if not changes:
            return
        sizes = describe_changes(
            *(self._automatic(own, request) for own in (before, self.settings(shot))), units
        )
        if sizes == changes:
            raise InputsChanged(
                f"{self.shown} in {self.folder.parent.name} was baked with other automatic sizes ({'; '.join(sizes)}), "
                "because Texel Size or the area of a receiver differs, which Subdivision Surface, Weld, Simplify or a "
                "scale changes: set that back, or bake again from the start"
            )
        remedy = "bake again from the start, or set them back"
        if is_longer(manifest["settings"]["snowfall"], shot):
            begin = "" if manifest["complete"] else "set them back and resume, then "
            remedy = f"{begin}Continue Bake adds the new frames and keeps the others. Or {remedy}"
        raise InputsChanged(
            f"{self.shown} in {self.folder.parent.name} was baked with other settings ({'; '.join(changes)}): {remedy}"
        )

    def _automatic(self, settings, request):
        """Those of its settings that are computed from the scene."""
        own, shot = settings["receiver"], settings["snowfall"]
        return {
            "pixel_size": shot["pixel_size"] if not request.pixel_size else None,
            "resolution": own["resolution"] if not self.spec.resolution else None,
        }

    def start(self, shot):
        """Prepares the folder for the first frame of the shot."""
        self.lock.check()
        receiver_folder.clear(self.folder)
        receiver_folder.remove_stray_files(self.folder)
        self.found = receiver_folder.checkpoints(self.folder)
        self.covered = Coverage(self.resolution)
        self.write_manifest(shot, complete=False)
        with self._writing():
            self.journal = Journal.start(self.folder, self._described(shot))

    def take_frames(self, last, covered):
        """Copies the maps and lines of the kept frames up to `last`. covered: Coverage of these frames."""
        with self._writing():
            for entry, poses in self.kept.copy(last, self.folder):
                self.journal.append(entry, poses)
        self.covered, self.last_frame = covered, last

    def discard(self):
        """Removes everything that this bake has written."""
        self.close()
        self.lock.check()
        receiver_folder.clear(self.folder)

    def write_maps(self, native, output, entry, poses):
        """Writes the result of a native OutputSnapshot's output(). entry: what the journal stores about the frame, a
        dict with its number as ``frame``; the greatest height on either side and checksums are added. poses: of the
        frame, cache.journal.packed."""
        frame, height = entry["frame"], output["height"]
        with self._writing():
            for name, values in output.items():
                kind, path = BY_NAME[name], self.folder / frame_file(name, frame)
                if kind.channels:
                    native.write_exr(str(path), kind.encoded(values), half=kind.is_half)
                else:
                    flying.write_points(path, values)
            checksums = checksums_of(self.folder, [frame_file(name, frame) for name in output])
            if self.kept is not None:
                checksums = self.kept.keep(frame, self.folder, checksums)
        self.covered.add(height)
        entry = {**entry, "highest": float(max(height.max(), -height.min())), "checksums": checksums}
        with self._writing():
            self.journal.append(entry, poses)
        self.last_frame = frame

    def _described(self, shot):
        """The part of the manifest that is known before the first frame."""
        own = self.settings(shot)
        return {
            "object": self.name,
            "label": self.label,
            "library": self.library,
            "cache": self.cache,
            "hash": digest(own),
            "settings": own,
            "wanted": astuple(self.wanted),
        }

    def write_manifest(self, shot, complete):
        manifest = {
            **self._described(shot),
            "files": bake_files(shot["frame_start"], shot["frame_end"]),
            "complete": complete,
        }
        if complete:
            manifest["end"] = self.journal.end.as_dict()
            manifest["checksums"] = checksums_of(self.folder, self._written_once())
        write_manifest(self.folder, manifest)

    def _written_once(self):
        """Names of the files of a finished bake that have no checksum in themselves, besides the maps of frames."""
        has_surface = self.recorder is not None and self.recorder.changed_at is None
        return [EVER_COVERED, RECEIVER, POSITIONS] if has_surface else [EVER_COVERED]

    def first_damage(self):
        """(frame, path) of the first file that is missing or damaged: the bake must go on before that frame. None if
        all files of the manifest are intact."""
        manifest = read_head(self.folder)
        if manifest is None:
            return None
        found = first_damage(self.folder, manifest)
        if found is None and manifest["complete"]:
            name = damaged_surface(self.folder)
            found = None if name is None else (manifest["settings"]["snowfall"]["frame_end"], name)
        return None if found is None else (found[0], self.folder / found[1])

    def record(self, frame, pose):
        """Records the receiver's shape in the scene.pose.ScenePose of a frame. Frames must come in order."""
        if self.spec.surface is None:
            return
        if self.recorder is None:
            self.recorder = ReceiverRecorder(self.folder)
        with self._writing():
            self.recorder.add(frame, pose.known_at(self.key))

    def finish_recording(self):
        """Writes the receiver's shape. Surfaces also read the shapes of the receivers beside theirs."""
        if self.recorder is not None and self.last_frame is not None:
            with self._writing():
                self.recorder.finish()

    def make_surface(self, native, progress):
        """Computes the snow surface of all baked frames. Returns False if progress(0 to 1) asked to stop."""
        if self.recorder is None or self.last_frame is None or self.recorder.changed_at is not None:
            return True
        with self._writing():
            return update_surface(native, self.folder, self.spec.surface, progress, self.lock.check)

    def close(self):
        if self.recorder is not None:
            self.recorder.close()

    def write_checkpoint(self, native, frame, shot, state, driver, beside=()):
        """Writes the checkpoint of ``frame``, the last frame whose maps were written. state: from simulation_state;
        driver: the engine and driver that ran (simulation.driver_text); beside: keys of other receivers whose state to
        include."""
        with self._writing():
            self.journal.flush()
        sidecar = {
            "beside": list(beside),
            "covered": self.covered.pack(),
            "driver": driver,
            "end": self.journal.end.as_dict(),
        }
        own = {**state, "objects": {key: state["objects"][key] for key in (self.key, *beside)}}
        with self._writing():
            receiver_folder.write_sidecar(self.folder, frame, sidecar)
        with self._writing():
            native.write_checkpoint(str(self.folder / state_file(frame)), own)
        with self._writing():
            self._remove_passed_checkpoints(shot, frame)

    def read_checkpoint(self, native, frame, sizes):
        """Restores coverage and journal from a checkpoint; returns (state, driver, poses). sizes: {key: resolution} of
        the receivers that it may hold."""
        receiver_folder.remove_stray_files(self.folder)
        state, driver, lines = self._read_checkpoint(native, frame, sizes)
        self.journal, self.last_frame = Journal(self.folder, lines.ends[-1]), frame
        self.found = receiver_folder.checkpoints(self.folder)
        return state, driver, lines.poses

    def peek_checkpoint(self, native, frame, sizes):
        """The same without changing anything, for a receiver that another bake may be writing."""
        state, driver, lines = self._read_checkpoint(native, frame, sizes)
        return state, driver, lines.poses

    def _read_checkpoint(self, native, frame, sizes):
        sidecar = receiver_folder.read_sidecar(self.folder, frame)
        lines = receiver_folder.lines_until(self.folder, frame, sidecar)
        try:
            self.covered = Coverage.unpack(self.resolution, sidecar["covered"])
            state = native.read_checkpoint(str(self.folder / state_file(frame)), sizes)
            state["objects"][self.key]  # raises if it is missing
            return state, sidecar["driver"], lines
        except KeyError:
            raise CacheError(
                f"{self.folder / state_file(frame)} belongs to another receiver: free the bake, then bake again"
            ) from None
        except (RuntimeError, ValueError) as error:
            raise CacheError(
                f"{self.folder / state_file(frame)} is damaged ({error}): delete it to resume from the checkpoint "
                "before it, or free the bake and bake again"
            ) from error

    def checkpoints(self):
        """Frames of the checkpoints that it can be resumed from: none while its files are being removed."""
        is_bake = (self.folder / MANIFEST).is_file()
        return receiver_folder.checkpoints(self.folder) if is_bake else []

    def beside(self, frame):
        """Keys of the other receivers whose state its checkpoint of ``frame`` holds."""
        return receiver_folder.read_sidecar(self.folder, frame).get("beside", [])

    def forget_after(self, frame, shot):
        """Removes everything that was baked after a checkpoint, which read_checkpoint has read."""
        self.lock.check()
        self.write_manifest(shot, complete=False)
        # Before the lines that they stand on.
        for later in receiver_folder.checkpoints(self.folder):
            if later > frame:
                receiver_folder.remove_checkpoint(self.folder, later)
        self.journal.cut()
        receiver_folder.remove_frames_after(self.folder, frame)

    def complete(self, shot, native):
        """Finishes the receiver. Nothing is written to it afterwards."""
        try:
            with self._writing():
                self.journal.flush()
                self.covered.write(native, self.folder / EVER_COVERED)
                self._remove_passed_checkpoints(shot, shot["frame_end"] + 1)
            with self._writing():
                self.write_manifest(shot, complete=True)
        except LockLost:
            raise
        except (OSError, RuntimeError) as error:
            raise CacheError(with_remedy(error)) from error

    @contextlib.contextmanager
    def _writing(self):
        """Checks the lock before and after a failed write. Raises LockLost if another bake took it, also if that caused
        the failure: the other bake clears the folder."""
        self.lock.check()
        try:
            yield
        except (OSError, RuntimeError):
            self.lock.check()
            raise

    def _remove_passed_checkpoints(self, shot, before):
        if any(frame < before for frame in self.found):  # looking for them takes longer with each frame
            receiver_folder.remove_irregular_checkpoints(
                self.folder, shot["frame_start"], shot["checkpoint_interval"], before
            )
            self.found = [frame for frame in self.found if frame >= before]


def surface_and_uv_area(topology, positions):
    """Area of an object's surface in m2 and of its UV layout (1 is the whole map)."""
    corners = positions[topology.triangles].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    uv = topology.corner_uv.astype(np.float64)
    edge, other = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    uv_cross = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0]
    return 0.5 * float(np.sqrt((cross * cross).sum(axis=1)).sum()), 0.5 * float(np.abs(uv_cross).sum())


def _check_uv(obj):
    share = outside_share(obj.topology.corner_uv)
    if share and (tiles := tiles_text(obj.topology.corner_uv)):
        raise ValueError(f"its UV map '{obj.uv_map}' {tiles}")
    if share:
        raise ValueError(
            f"{share:.0%} of its UV map '{obj.uv_map}' is outside 0 to 1 or not finite: unwrap it, or pack its islands"
        )


def measure(obj, texel_size):
    """The BakedReceiver of a scene.pose.ObjectPose. Raises ValueError with its name if it has no area."""
    try:
        _check_uv(obj)
        areas = surface_and_uv_area(obj.topology, obj.positions)
        per_map = plan.metres_per_map(*areas)
    except ValueError as error:
        raise ValueError(f"'{obj.receiver.shown(obj.label)}': {error}") from error
    resolution = obj.receiver.resolution or plan.automatic_resolution(*areas, texel_size)
    if not MIN_RESOLUTION <= resolution <= MAX_RESOLUTION:
        raise ValueError(
            f"'{obj.receiver.shown(obj.label)}' has a resolution of {resolution}: it must be 0 (automatic) or from "
            f"{MIN_RESOLUTION} to {MAX_RESOLUTION}"
        )
    return BakedReceiver(
        obj.key,
        obj.label,
        obj.name,
        obj.library,
        obj.receiver,
        obj.uv_map,
        resolution,
        per_map / resolution,
    )
