# SPDX-License-Identifier: GPL-3.0-or-later
"""Which .blend a scene's folder in the cache belongs to. No ``bpy``.

A .blend carries the identity of its cache, and so does each copy of it. The folder says which file came first
(``owner.json``): for the others it is not theirs as long as that file is there, and they get folders of their own.
The file is named relative to the cache where that lies beside it, so both may move together.
"""

import os
import socket
from pathlib import Path

from .errors import CacheBusy
from .files import OWNER, digest
from .sealed import FORMAT, read_sealed, text, write_sealed


def _named(blend, root):
    """How a scene's folder `root` names a .blend."""
    blend, cache = Path(blend).resolve(), Path(root).resolve().parent
    if blend.parent in (cache, *cache.parents):
        return {"blend": Path(os.path.relpath(blend, cache)).as_posix(), "host": ""}
    return {"blend": str(blend), "host": digest(socket.gethostname())}


def _recorded(root):
    """What claim() wrote, or None."""
    shapes = {FORMAT: {"blend": text, "host": text}}
    recorded = read_sealed(
        Path(root) / OWNER, "Remove it, then open the .blend that baked there first", shapes.get
    )
    return None if recorded is None else {name: recorded[name] for name in ("blend", "host")}


def is_owner(root, blend):
    """Whether a scene's folder, which need not be there, belongs to a .blend: it was the first to bake there, or
    that one is gone from where it was, moved or renamed. On another computer it cannot be known to be gone."""
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
    return recorded["host"] in ("", own["host"]) and not first.exists()


def claim(root, blend):
    """Makes a .blend the owner of a scene's folder. Raises CacheBusy where another one was faster."""
    own = _named(blend, root)
    if is_owner(root, blend) and _recorded(root) != own:
        write_sealed(Path(root) / OWNER, own)
    if not is_owner(root, blend):
        raise CacheBusy(
            f"Another .blend has just begun to bake in {root}: bake again, then this one gets its own"
        )


def copy_identity(identity, blend, root):
    """The identity of a copy's cache, where `root`, that of `identity`, belongs to another file."""
    return digest([identity, _named(blend, root)["blend"]])[:16]
