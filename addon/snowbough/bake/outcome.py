# SPDX-License-Identifier: GPL-3.0-or-later
"""How a bake ended, and what the scene learns from it: where the files of each receiver lie."""

from pathlib import Path

import bpy

from .. import session
from ..cache.errors import CacheError
from ..cache.folder import baked_frames
from ..cache.manifest import read_manifest
from ..result import displacement
from ..result.snow_surface import blend_path
from ..scene.pose import library_path


def describe(running):
    """(severity, one clear line) on how a RunningBake ended."""
    if running.error is not None:
        return "ERROR", one_line(running.error)
    if running.cancelled:
        return "WARNING", "The bake was stopped. What was baked is kept: Resume goes on from there"
    results, refused = running.job.results, running.job.refused
    if results:
        seconds = sum(result.seconds["total"] for result in results)
        text = f"Baked {len(results)} frames in {seconds:.1f} s"
    else:
        text = "Everything was baked already, from the scene as it is now"
    if not refused:
        return "INFO", text
    return "WARNING", one_line(f"{text}, without {len(refused)} receivers: {'; '.join(refused.values())}")


def one_line(error):
    text = " ".join(str(error).split())
    return text or type(error).__name__


def after_bake(scene, running):
    """What the scene learns from a bake: where the files of each receiver lie. What shows older ones is
    wired to the new ones, and images are read again. Returns what the artist should know of that, a list of texts."""
    job, notes = running.job, []
    scene.snowbough.cache_used = job.request.cache
    by_object = {}
    for receiver in job.baked:
        by_object.setdefault((receiver.spec.name, receiver.spec.library), receiver.folder)
    for entry in scene.snowbough.receivers:
        if entry.object is None:
            continue
        folder = by_object.get((entry.object.name, library_path(entry.object)))
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
                "surface: choose Displacement > None to show its snow with the material"
            )
    # On the first frame there is next to no snow to be seen.
    if job.results and scene.frame_current <= job.request.frame_start:
        scene.frame_set(job.results[-1].frame)
    for image in bpy.data.images:
        if image.source == "SEQUENCE" and str(job.root) in bpy.path.abspath(image.filepath):
            image.reload()
    return notes


def conclude(scene, running):
    """after_bake(), and describe() with what it noted."""
    severity, text = describe(running)
    notes = after_bake(scene, running)
    if not notes:
        return severity, text
    return "WARNING" if severity == "INFO" else severity, one_line(f"{text}. {'; '.join(notes)}")


@bpy.app.handlers.persistent
def _forget_outcome(*_):
    """How a bake of another file went is no news here."""
    session.last_outcome = session.NO_OUTCOME


def _baked_name(entry):
    """What a receiver was called when its folder was baked by an add-on that did not note it."""
    try:
        manifest = read_manifest(Path(bpy.path.abspath(entry.folder)))
    except CacheError:
        manifest = None
    if manifest is None:
        return entry.object.name
    if entry.object.type == "MESH":
        return manifest["object"]
    return manifest["label"].removesuffix(f" / {manifest['object']}")


@bpy.app.handlers.persistent
def heal_folders(*_):
    """After Save As elsewhere the image paths are remapped by Blender, our folders beside the .blend are
    not: finds them again in the cache that the last bake wrote to."""
    for scene in bpy.data.scenes:
        used = scene.snowbough.cache_used
        for entry in scene.snowbough.receivers:
            if entry.folder and entry.object is not None and not entry.baked_as:
                entry.baked_as = _baked_name(entry)
            if not entry.folder or not used or Path(bpy.path.abspath(entry.folder)).is_dir():
                continue
            # <cache>/<scene>/<version>/<receiver>
            candidate = Path(used).joinpath(*Path(entry.folder.lstrip("/").replace("\\", "/")).parts[-3:])
            if candidate.is_dir():
                entry.folder = blend_path(candidate)


def register():
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        handlers.append(heal_folders)
    bpy.app.handlers.load_pre.append(_forget_outcome)


def unregister():
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        if heal_folders in handlers:
            handlers.remove(heal_folders)
    bpy.app.handlers.load_pre.remove(_forget_outcome)
