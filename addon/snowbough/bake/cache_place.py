# SPDX-License-Identifier: GPL-3.0-or-later
"""Location of a scene's cache, and the .blend that it belongs to.

Each saved scene stores the identity of its cache, so that .blend files with one cache folder do not share bakes. A copy
of a file stores the same identity: the file that baked first keeps it, and the others use a derived one (cache.owner),
which is stored when they are saved. Scenes that were never saved have no identity.
"""

import uuid
from pathlib import Path

import bpy

from ..base import session
from ..cache import location, owner, versions
from ..cache.errors import CacheError


def cache_directory(scene, directory=None):
    """Absolute folder of the scene's cache, or of `directory`, a path of the system. Raises ValueError, e.g. if the
    .blend was never saved."""
    if directory is not None:
        return str(location.from_command_line(directory))
    return str(location.from_panel(scene.snowbough.cache_directory, bpy.data.filepath))


def known_as(scene):
    """The name that the scene's folder in the cache has: that of its first bake. A copy of a scene, or a new scene of
    that name, gets another one."""
    owners = {}
    for one in bpy.data.scenes:
        stored = one.snowbough.cache_scene
        if stored and (stored not in owners or one.name == stored):
            owners[stored] = one
    if owners.get(scene.snowbough.cache_scene) == scene:
        return scene.snowbough.cache_scene
    number, name = 1, scene.name
    while name in owners:
        number += 1
        name = f"{scene.name} ({number})"
    return name


def _stored_identity(scene):
    """The identity in the file on disk; undo to a step before saving removes it from the scene only."""
    return scene.snowbough.cache_identity or session.cache_identities.get(scene.name, "")


def identity(scene, cache):
    """The identity of a scene's cache in the folder `cache`."""
    stored, blend = _stored_identity(scene), bpy.data.filepath
    if not stored or not blend:
        return stored
    root = versions.scene_folder(cache, known_as(scene), stored)
    return stored if owner.is_owner(root, blend) else owner.copy_identity(stored, blend, root)


def bake_place(scene, continues, directory=None):
    """(absolute cache folder, identity) of a bake. continues: whether to continue a bake, which may be from before the
    file had an identity. directory: the cache that the command line names. Machines may bake copies of a file there
    together, so the identity in the file is used as it is."""
    cache = cache_directory(scene, directory)
    own = _stored_identity(scene) if directory is not None else identity(scene, cache)
    if continues and own and not versions.versions(versions.scene_folder(cache, known_as(scene), own)):
        used = scene.snowbough.cache_used
        if (
            used
            and Path(used) == Path(cache)
            and versions.versions(versions.scene_folder(cache, known_as(scene)))
        ):
            return cache, ""
    return cache, own


def existing_cache(scene):
    """The scene's folder in the cache for resuming, a Path that need not exist, or None."""
    try:
        cache, own = bake_place(scene, continues=True)
    except (ValueError, CacheError):
        return None
    return versions.scene_folder(cache, known_as(scene), own)


def own_bakes(scene):
    """[cache.versions.Bakes] of the scene. Of bakes without an identity, only the versions that a saved scene shows are
    known to be its own."""
    try:
        cache = cache_directory(scene)
    except ValueError:
        cache = None
    found = []
    for folder in dict.fromkeys(place for place in (cache, scene.snowbough.cache_used) if place):
        own = identity(scene, folder)
        if own:
            found.append(versions.find_bakes(versions.scene_folder(folder, known_as(scene), own), (own,)))
    if cache is not None:
        root = versions.scene_folder(cache, known_as(scene))
        if bpy.data.filepath:
            found.append(versions.find_bakes(root, ("",), shown=_shown_versions(scene, root)))
        else:
            found.append(versions.find_bakes(root, ("",)))
    return [bakes for bakes in found if bakes.folders or bakes.skipped]


def _shown_versions(scene, root):
    """Names of the versions in a scene's folder that its receivers show."""
    folders = [Path(bpy.path.abspath(entry.folder)) for entry in scene.snowbough.receivers if entry.folder]
    return {folder.parent.name for folder in folders if folder.parent.parent.resolve() == root.resolve()}


@bpy.app.handlers.persistent
def _assign_identities(*_):
    """Before saving: gives the file's scenes the identities of their caches."""
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
    bpy.app.handlers.save_pre.append(_assign_identities)
    bpy.app.handlers.load_pre.append(_forget_identities)


def unregister():
    bpy.app.handlers.save_pre.remove(_assign_identities)
    bpy.app.handlers.load_pre.remove(_forget_identities)
