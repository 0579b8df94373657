# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress of a scene's bake, for the panels."""

import time

from ..base import session
from ..cache import versions
from ..cache.errors import CacheError
from ..cache.files import folders_in
from ..cache.manifest import read_head
from .cache_place import existing_cache

# Seconds between looks into the cache, which read a few files; panels redraw with every movement of the mouse.
LOOK_SECONDS = 1.0


def state_of(scene):
    """EMPTY (no receivers), BAKING, BAKED (all enabled receivers have files), or READY."""
    if session.bake is not None:
        return "BAKING"
    enabled = [entry for entry in scene.snowbough.receivers if entry.object and entry.enabled]
    if not enabled:
        return "EMPTY"
    return "BAKED" if all(entry.folder for entry in enabled) else "READY"


def resumable(scene):
    """Whether the newest version has an unfinished bake. Cached for LOOK_SECONDS."""
    root = existing_cache(scene)
    if root is None:
        return False
    when, found = session.unfinished_bakes.get(str(root), (0.0, False))
    if time.monotonic() - when > LOOK_SECONDS:
        found = _has_unfinished(root)
        session.unfinished_bakes[str(root)] = (time.monotonic(), found)
    return found


def _has_unfinished(root):
    numbers = versions.versions(root)
    if not numbers:
        return False
    folder = versions.version_folder(root, numbers[-1])
    for child in map(folder.joinpath, folders_in(folder)):
        try:
            manifest = read_head(child)
        except CacheError:  # resuming restores it
            return True
        if manifest is not None and not manifest["complete"]:
            return True
    return False
