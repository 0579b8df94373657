# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a scene's bake is, as the panels show it."""

import time

from . import bake_engine, bake_operators, cache

# A look into the cache is a few file reads; panels redraw with every movement of the mouse.
LOOK_SECONDS = 1.0
_looked = {}


def state_of(scene):
    """EMPTY (no receivers), BAKING, BAKED (all enabled receivers have files), or READY."""
    if bake_engine.session() is not None:
        return "BAKING"
    enabled = [entry for entry in scene.snowbough.receivers if entry.object and entry.enabled]
    if not enabled:
        return "EMPTY"
    return "BAKED" if all(entry.folder for entry in enabled) else "READY"


def resumable(scene):
    """Whether the newest version holds an unfinished bake, as it was at most LOOK_SECONDS ago."""
    root = bake_operators.existing_cache(scene)
    if root is None:
        return False
    when, found = _looked.get(str(root), (0.0, False))
    if time.monotonic() - when > LOOK_SECONDS:
        found = _has_unfinished(root)
        _looked[str(root)] = (time.monotonic(), found)
    return found


def _has_unfinished(root):
    numbers = cache.versions(root)
    if not numbers:
        return False
    folder = cache.version_folder(root, numbers[-1])
    for child in folder.iterdir():
        try:
            manifest = cache.read_manifest(child)
        except cache.CacheError:
            continue
        if manifest is not None and not manifest["complete"]:
            return True
    return False
