# SPDX-License-Identifier: GPL-3.0-or-later
"""The versions of a scene's bake: choosing one, and removing them. No ``bpy``."""

import contextlib
from dataclasses import dataclass, field
from pathlib import Path

from ..base.names import folder_name, tagged_name
from . import folder as receiver_folder
from .errors import CacheError
from .files import LEDGER, LOG_PATTERN, LOGS, OWNER, VERSION_PATTERN, folders_in, is_regular
from .integrity import replaced
from .lock import lock_receivers
from .manifest import read_any_head, read_head


def scene_folder(cache, scene_name, identity=""):
    """A scene's folder in a cache. identity: of the .blend's cache; empty for files that were never saved."""
    return Path(cache) / (tagged_name(scene_name, (identity,)) if identity else folder_name(scene_name))


def versions(root):
    """Version numbers in a scene's folder, ascending."""
    matches = (VERSION_PATTERN.match(name) for name in folders_in(root))
    return sorted(int(match.group(1)) for match in matches if match)


def version_folder(root, number):
    return Path(root) / f"v{number:03d}"


def _manifests(folder):
    found = {name: read_head(folder / name) for name in folders_in(folder)}
    return {name: manifest for name, manifest in found.items() if manifest is not None}


def is_finished(folder):
    """Whether a receiver's folder has a finished bake; a damaged manifest does not tell."""
    try:
        return bool((read_head(folder) or {}).get("complete"))
    except CacheError:
        return False


def choose_version(root, keys, shot_hash):
    """The version for a new bake of the receivers ``keys``.

    It is the newest one if none of them is finished there and all its receivers come from the same shot (``shot_hash``:
    all settings except the receiver's own), so that machines that share a shot fill one version. Else it is the next
    one. Folders that are not from a bake, or whose manifest is damaged, are left alone.
    """
    existing = versions(root)
    if not existing:
        return 1
    newest = existing[-1]
    folder = version_folder(root, newest)
    if any(receiver_folder.is_foreign(folder / key) for key in keys):
        return newest + 1
    try:
        manifests = _manifests(folder)
    except CacheError:
        return newest + 1
    for name, manifest in manifests.items():
        if name in keys and manifest["complete"]:
            return newest + 1
        if name not in keys and manifest["settings"].get("shot") != shot_hash:
            return newest + 1
    return newest


def resumable_version(root, keys):
    """The newest version that has a bake of any of ``keys``: (number, the keys finished there); (None, []) if there is
    none."""
    for number in reversed(versions(root)):
        folder = version_folder(root, number)
        there = folders_in(folder)
        present = [key for key in keys if key in there and not receiver_folder.is_foreign(folder / key)]
        if present:
            return number, [key for key in present if is_finished(folder / key)]
    return None, []


def remove_empty_folders(root, folders):
    """Removes those of the receivers' folders that are empty, then empty versions, then an empty folder of the
    scene."""
    emptied = [*folders, *sorted({Path(folder).parent for folder in folders}), Path(root)]
    for folder in emptied:
        with contextlib.suppress(OSError):
            Path(folder).rmdir()


@dataclass
class Bakes:
    """The bakes in a scene's folder that belong to one .blend, and their size."""

    root: Path
    folders: list = field(default_factory=list)
    """Of receivers."""
    logs: list = field(default_factory=list)
    ledgers: list = field(default_factory=list)
    """Of versions all of whose receivers are listed."""
    count: int = 0
    """Number of files, and their bytes."""
    size: int = 0
    skipped: list = field(default_factory=list)
    """Messages about folders that are left unchanged."""
    kept: list = field(default_factory=list)
    """After free(): files with the names of the bake's that the bake did not write, or that have changed since."""

    def _add(self, files):
        self.count += len(files)
        self.size += sum(path.lstat().st_size for path in files)


def find_bakes(root, identities=("",), shown=None, keys=None):
    """The Bakes below `root` whose manifests have one of these identities. shown: only versions of these names. keys:
    only these receivers. Links are not followed."""
    found = Bakes(Path(root))
    numbers = versions(root)
    for number in numbers:
        folder = version_folder(root, number)
        if shown is not None and folder.name not in shown:
            continue
        for name in folders_in(folder):
            if keys is not None and name not in keys:
                continue
            try:
                manifest = read_any_head(folder / name)
            except CacheError as error:
                found.skipped.append(str(error))
                continue
            if manifest is not None and manifest.get("cache") in identities:
                found.folders.append(folder / name)
                found._add(receiver_folder.listed_files(folder / name))
        ours = {path.name for path in found.folders if path.parent == folder}
        if ours and ours == set(folders_in(folder)) and is_regular(folder / LEDGER):
            found.ledgers.append(folder / LEDGER)
            found._add(found.ledgers[-1:])
    if found.folders and keys is None and shown is None:
        found.logs = [
            path
            for path in sorted((found.root / LOGS).glob("*.log"))
            if LOG_PATTERN.fullmatch(path.name) and is_regular(path) and not path.parent.is_symlink()
        ]
        found._add(found.logs)
    return found


def free(found):
    """Removes the result of find_bakes(), and all folders that are empty then. Returns the number of files. Raises
    CacheBusy if one of them is being baked."""
    removed = 0
    for version in sorted({folder.parent for folder in found.folders}):
        own = [folder for folder in found.folders if folder.parent == version]
        with lock_receivers(version, [folder.name for folder in own]):
            for folder in own:
                kept = replaced(folder)
                removed += receiver_folder.clear(folder, kept)
                found.kept += [folder / name for name in kept]
    for path in (*found.logs, *found.ledgers):
        path.unlink(missing_ok=True)
        removed += 1
    if found.logs:
        with contextlib.suppress(OSError):
            (found.root / LOGS).rmdir()
    remove_empty_folders(found.root, found.folders)
    if found.folders and not versions(found.root) and is_regular(found.root / OWNER):
        (found.root / OWNER).unlink()
        remove_empty_folders(found.root, ())
    return removed
