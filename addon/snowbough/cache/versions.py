# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's versions: which one a bake writes to, and freeing them. No ``bpy``."""

import contextlib
import os
import shutil
from pathlib import Path

from ..names import safe_name
from . import folder as receiver_folder
from .files import VERSION_PATTERN
from .lock import lock_folder
from .manifest import read_manifest


def scene_folder(cache, scene_name):
    return Path(cache) / safe_name(scene_name)


def versions(root):
    """Version numbers in a scene's folder, ascending."""
    if not Path(root).is_dir():
        return []
    matches = (VERSION_PATTERN.match(name) for name in os.listdir(root))
    return sorted(int(match.group(1)) for match in matches if match)


def version_folder(root, number):
    return Path(root) / f"v{number:03d}"


def _manifests(folder):
    if not folder.is_dir():
        return {}
    found = {
        name: read_manifest(folder / name) for name in sorted(os.listdir(folder)) if (folder / name).is_dir()
    }
    return {name: manifest for name, manifest in found.items() if manifest is not None}


def choose_version(root, keys, shot_hash):
    """The version that a new bake of the receivers ``keys`` writes to.

    It is the newest one as long as none of them is finished there and all receivers that are there come
    from the same shot (``shot_hash``: all settings but the receiver's own), so that machines that share
    a shot fill one version; else the next one.
    """
    existing = versions(root)
    if not existing:
        return 1
    newest = existing[-1]
    manifests = _manifests(version_folder(root, newest))
    for name, manifest in manifests.items():
        if name in keys and manifest["complete"]:
            return newest + 1
        if name not in keys and manifest["settings"].get("shot") != shot_hash:
            return newest + 1
    return newest


def resumable_version(root, keys):
    """The newest version that holds or may hold an unfinished bake of any of ``keys``: (number, keys
    that are finished there). A version without any trace of them is not one; (None, []) without any."""
    for number in reversed(versions(root)):
        folder = version_folder(root, number)
        present = [key for key in keys if (folder / key).is_dir()]
        if present:
            finished = [key for key in present if (read_manifest(folder / key) or {}).get("complete")]
            return number, finished
    return None, []


def remove_empty_folders(root):
    """Removes empty receivers' and versions' folders, and the scene's where nothing is left."""
    root = Path(root)
    for number in versions(root):
        folder = version_folder(root, number)
        for child in [folder / name for name in os.listdir(folder)] + [folder]:
            with contextlib.suppress(OSError):
                child.rmdir()
    with contextlib.suppress(OSError):
        root.rmdir()


def free(root, keys=None):
    """Removes the bakes of receivers ``keys`` (None: all) in all versions of a scene's folder, and every
    folder that this leaves empty. Returns the number of files. Raises CacheBusy when one is baking."""
    root = Path(root)
    folders = [
        version_folder(root, number) / name
        for number in versions(root)
        for name in sorted(os.listdir(version_folder(root, number)))
        if (keys is None or name in keys) and (version_folder(root, number) / name).is_dir()
    ]
    removed = 0
    for folder in folders:
        with lock_folder(folder):
            removed += receiver_folder.clear(folder, keep_lock=True)
    if keys is None:
        shutil.rmtree(root / "logs", ignore_errors=True)
    remove_empty_folders(root)
    return removed
