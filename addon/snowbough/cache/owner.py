# SPDX-License-Identifier: GPL-3.0-or-later
"""The .blend that owns a scene's folder in the cache. No ``bpy``.

A .blend stores the identity of its cache, and so does each copy of it. ``owner.json`` in the folder names the file that
baked first. While that file exists, the other files get folders of their own. If the file lies beside the cache, its
path is relative, so both can be moved together.
"""

import os
import socket
from pathlib import Path

from .errors import CacheBusy
from .files import OWNER, digest, remove_half_written
from .sealed import read_sealed, write_sealed
from .shapes import text


def _named(blend, root):
    """How ``owner.json`` in a scene's folder `root` names a .blend."""
    blend, cache = Path(blend).resolve(), Path(root).resolve().parent
    if blend.parent in (cache, *cache.parents):
        return {"blend": Path(os.path.relpath(blend, cache)).as_posix(), "host": ""}
    return {"blend": str(blend), "host": digest(socket.gethostname())}


def _recorded(root):
    """The entry that claim() wrote, or None."""
    recorded = read_sealed(
        Path(root) / OWNER,
        "Delete it, then open the .blend that baked there first",
        {"blend": text, "host": text},
    )
    return None if recorded is None else {name: recorded[name] for name in ("blend", "host")}


def is_owner(root, blend):
    """Whether a .blend owns a scene's folder, which need not exist: it was the first to bake there, or the first file
    was moved or renamed. A file on another computer cannot be looked for, so it stays the owner."""
    recorded = _recorded(root)
    if recorded is None:
        return True
    own = _named(blend, root)
    if recorded == own:
        return True
    first = Path(root).resolve().parent / recorded["blend"]
    try:
        if os.path.samefile(first, blend):
            return True
    except OSError:
        pass
    return recorded["host"] in ("", own["host"]) and not os.path.exists(first)


def claim(root, blend):
    """Makes a .blend the owner of a scene's folder. Raises CacheBusy if another one was faster."""
    own = _named(blend, root)
    remove_half_written(Path(root) / OWNER)
    if is_owner(root, blend) and _recorded(root) != own:
        write_sealed(Path(root) / OWNER, own)
    if not is_owner(root, blend):
        raise CacheBusy(
            f"Another .blend has just started to bake in {root}: bake again, and this file gets its own folder"
        )


def copy_identity(identity, blend, root):
    """The identity of the cache of a copied file, if `root`, the folder of `identity`, belongs to another file."""
    return digest([identity, _named(blend, root)["blend"]])[:16]
