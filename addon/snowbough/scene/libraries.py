# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of linked libraries that stay the same when files are moved."""

import bpy


def library_name(id_block):
    """The file name of a linked ID's library, ``props.blend``; empty for local IDs. If several libraries of the .blend
    have that name, as many of its folders as tell them apart: ``chairs/props.blend``."""
    library = id_block.library
    if library is None:
        return ""
    own = _parts(library.filepath)
    others = [_parts(other.filepath) for other in bpy.data.libraries if other.filepath != library.filepath]
    count = 1
    while count < len(own) and any(other[-count:] == own[-count:] for other in others):
        count += 1
    return "/".join(own[-count:])


def stored_name(library):
    """A stored library as library_name gives it. Earlier versions stored its path: relative to the .blend
    (``//``), or absolute."""
    is_path = library.startswith(("/", "\\")) or ":" in library
    return _parts(library)[-1] if is_path else library


def _parts(path):
    return bpy.path.abspath(path).replace("\\", "/").split("/")
