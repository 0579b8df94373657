# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the cache of a scene lies, and which .blend it belongs to.

Each saved scene carries the identity of its cache, so that .blend files which share a cache folder do not share what
is in it. A copy of a file carries the same one: the file that baked first keeps it, the others go by one of their own
(cache.owner), which they get for good when they are saved. A scene that was never saved has none, nor has a file of
before.
"""

import uuid
from pathlib import Path

import bpy

from .. import session
from ..cache import owner, versions
from ..cache.errors import CacheError


def cache_directory(scene, directory=None):
    """Absolute folder of the scene's cache, or what `directory` names, as Blender writes paths. Raises ValueError where
    the .blend was never saved."""
    path = scene.snowbough.cache_directory if directory is None else directory
    if not path.strip():
        raise ValueError("The cache folder is empty: choose one in the Snowbough panel")
    if path.startswith("//") and not bpy.data.filepath:
        raise ValueError(
            "Save the .blend first: its cache lies beside it. Or choose an absolute cache folder in the panel"
        )
    return str(Path(bpy.path.abspath(path)).resolve())


def _stored_identity(scene):
    """What the file has on disk: an undo to before it was saved takes it from the scene, not from the file."""
    return scene.snowbough.cache_identity or session.cache_identities.get(scene.name, "")


def identity(scene, cache):
    """The identity of a scene's cache in the folder `cache`."""
    stored, blend = _stored_identity(scene), bpy.data.filepath
    if not stored or not blend:
        return stored
    root = versions.scene_folder(cache, scene.name, stored)
    return stored if owner.is_owner(root, blend) else owner.copy_identity(stored, blend, root)


def bake_place(scene, goes_on, directory=None):
    """(absolute cache folder, identity) of a bake. goes_on: of one that was begun, also before the file had an
    identity. directory: as the command line names it, for machines that bake copies of one file together: whichever
    file it is, the identity that it carries counts."""
    cache = cache_directory(scene, directory)
    own = _stored_identity(scene) if directory is not None else identity(scene, cache)
    if goes_on and own and not versions.versions(versions.scene_folder(cache, scene.name, own)):
        used = scene.snowbough.cache_used
        if used and Path(used) == Path(cache) and versions.versions(versions.scene_folder(cache, scene.name)):
            return cache, ""
    return cache, own


def existing_cache(scene):
    """The scene's folder in the cache where a bake would go on. Returns a Path that need not exist, or None."""
    try:
        cache, own = bake_place(scene, goes_on=True)
    except (ValueError, CacheError):
        return None
    return versions.scene_folder(cache, scene.name, own)


def own_bakes(scene):
    """[cache.versions.Bakes] of the scene, where there are any. Of what was baked without an identity, and the file has
    been saved since, only the versions that the scene shows are known to be its own."""
    try:
        cache = cache_directory(scene)
    except ValueError:
        cache = None
    found = []
    for folder in dict.fromkeys(place for place in (cache, scene.snowbough.cache_used) if place):
        own = identity(scene, folder)
        if own:
            found.append(versions.find_bakes(versions.scene_folder(folder, scene.name, own), (own,)))
    if cache is not None:
        root = versions.scene_folder(cache, scene.name)
        if bpy.data.filepath:
            found.append(versions.find_bakes(root, ("", None), shown=_shown_versions(scene, root)))
        else:
            found.append(versions.find_bakes(root, ("",)))
    return [bakes for bakes in found if bakes.folders or bakes.skipped]


def _shown_versions(scene, root):
    """Names of the versions below a scene's folder that its receivers show."""
    folders = [Path(bpy.path.abspath(entry.folder)) for entry in scene.snowbough.receivers if entry.folder]
    return {folder.parent.name for folder in folders if folder.parent.parent.resolve() == root.resolve()}


@bpy.app.handlers.persistent
def _give_identities(*_):
    """Before a file is saved: its scenes get the identity of their caches."""
    for scene in bpy.data.scenes:
        if scene.library is not None:
            continue
        own = _stored_identity(scene)
        if own and bpy.data.filepath:
            try:
                own = identity(scene, cache_directory(scene))
            except (ValueError, CacheError):
                pass
        own = own or uuid.uuid4().hex[:16]
        session.cache_identities[scene.name] = own
        if scene.snowbough.cache_identity != own:
            scene.snowbough.cache_identity = own


@bpy.app.handlers.persistent
def _forget_identities(*_):
    session.cache_identities.clear()


def register():
    bpy.app.handlers.save_pre.append(_give_identities)
    bpy.app.handlers.load_pre.append(_forget_identities)


def unregister():
    bpy.app.handlers.save_pre.remove(_give_identities)
    bpy.app.handlers.load_pre.remove(_forget_identities)
