# SPDX-License-Identifier: GPL-3.0-or-later
"""The outcome of a bake, and its result in the scene: the folder of each receiver's files."""

import time
from pathlib import Path

import bpy

from ..base import session
from ..base.names import counted
from ..cache import versions
from ..cache.errors import CacheError
from ..cache.files import folders_in
from ..cache.folder import baked_frames
from ..cache.manifest import read_head
from ..result import displacement
from ..result.snow_surface import blend_path
from ..scene.libraries import library_name, stored_name
from .cache_place import bake_place, known_as


def describe(running):
    """(severity, one line of text) about the end of a RunningBake."""
    if running.error is not None:
        return "ERROR", one_line(running.error)
    if running.cancelled:
        return "WARNING", "The bake was stopped. Finished frames are kept: Resume continues after them"
    results, refused = running.job.results, running.job.refused
    if results:
        seconds = time.monotonic() - running.begun
        text = f"Baked {counted(len(results), 'frame')} in {seconds:.1f} s"
        if running.job.request.extend:
            text += f". {_added(running.job.request)}"
    else:
        text = "Everything is already baked from the current scene"
    if running.job.repaired:
        text += f". {'; '.join(running.job.repaired)}"
    if not refused:
        return "INFO", one_line(text)
    return "WARNING", one_line(
        f"{text}, without {counted(len(refused), 'receiver')}: {'; '.join(refused.values())}"
    )


def _added(request):
    """What Continue Bake did, as a sentence."""
    last, depth = request.parts[-1]
    text = (
        f"Frames {request.frame_start}-{last} are as they were, frames {last + 1}-{request.frame_end} are new"
    )
    if request.end_depth == depth:
        text += f", and no snow falls in them: End Depth is {depth:g} m as before"
    return text


def one_line(error):
    text = " ".join(str(error).split())
    return text or type(error).__name__


def after_bake(scene, running):
    """Sets the folder of each baked receiver, shows the new files where old ones were shown, and reloads images.
    Returns a list of messages for the user."""
    job, notes = running.job, []
    scene.snowbough.cache_used = job.request.cache
    by_object = {}
    for receiver in job.baked:
        by_object.setdefault((receiver.spec.name, receiver.spec.library), receiver.folder)
    for entry in scene.snowbough.receivers:
        if entry.object is None:
            continue
        folder = by_object.get((entry.object.name, library_name(entry.object)))
        if folder is not None and baked_frames(folder):
            entry.folder = blend_path(folder)
            try:
                displacement.refresh(scene, entry)
            except CacheError as error:
                notes.append(str(error))
    for receiver in job.baked:
        if receiver.recorder is not None and receiver.recorder.changed_at is not None:
            notes.append(
                f"'{receiver.shown}' has other faces from frame {receiver.recorder.changed_at} on, so it has no snow "
                "surface: choose Displacement > None to show its snow in the material"
            )
    # The first frame shows almost no snow.
    if job.results and scene.frame_current <= job.request.frame_start:
        scene.frame_set(job.results[-1].frame)
    for image in bpy.data.images:
        if image.source == "SEQUENCE" and str(job.root) in bpy.path.abspath(image.filepath):
            image.reload()
    return notes


def show_bakes(scene, directory=None):
    """Sets the folder of each receiver to its newest bake in the cache, as for a .blend that was not saved after its
    bake. directory: the cache that the command line names; None for the scene's own, for receivers without a folder.
    Raises ValueError, CacheError."""
    entries = [
        entry
        for entry in scene.snowbough.receivers
        if entry.object is not None and (directory is not None or not entry.folder)
    ]
    if not entries:
        return
    cache, identity = bake_place(scene, True, directory)
    root, found = versions.scene_folder(cache, known_as(scene), identity), {}
    for number in reversed(versions.versions(root)):
        version = versions.version_folder(root, number)
        for folder in map(version.joinpath, folders_in(version)):
            manifest = read_head(folder)
            if manifest is not None and baked_frames(folder):
                is_member = manifest["label"] != manifest["object"]
                name = manifest["label"].removesuffix(f" / {manifest['object']}")
                found.setdefault((name, "" if is_member else stored_name(manifest["library"])), folder)
    for entry in entries:
        library = library_name(entry.object) if entry.object.type == "MESH" else ""
        folder = found.get((entry.baked_as or entry.object.name, library))
        if folder is not None:
            entry.folder = blend_path(folder)


def conclude(scene, running):
    """after_bake(), and describe() with its messages."""
    notes = after_bake(scene, running)
    severity, text = describe(running)
    if not notes:
        return severity, text
    return "WARNING" if severity == "INFO" else severity, one_line(f"{text}. {'; '.join(notes)}")


@bpy.app.handlers.persistent
def _forget_outcome(*_):
    """The outcome belongs to another file, or to a bake that was undone or redone."""
    session.last_outcome = session.NO_OUTCOME


@bpy.app.handlers.persistent
def relocate_folders(*_):
    """After Save As in another folder, Blender updates image paths but not our folders beside the .blend: finds them in
    the cache of the last bake."""
    for scene in bpy.data.scenes:
        used = scene.snowbough.cache_used
        for entry in scene.snowbough.receivers:
            if not entry.folder or not used or Path(bpy.path.abspath(entry.folder)).is_dir():
                continue
            # <cache>/<scene>/<version>/<receiver>
            candidate = Path(used).joinpath(*Path(entry.folder.lstrip("/").replace("\\", "/")).parts[-3:])
            if candidate.is_dir():
                entry.folder = blend_path(candidate)


def register():
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        handlers.append(relocate_folders)
    for name in ("load_pre", "undo_post", "redo_post"):
        getattr(bpy.app.handlers, name).append(_forget_outcome)


def unregister():
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        if relocate_folders in handlers:
            handlers.remove(relocate_folders)
    for name in ("load_pre", "undo_post", "redo_post"):
        getattr(bpy.app.handlers, name).remove(_forget_outcome)
