# SPDX-License-Identifier: GPL-3.0-or-later
"""The formats of an exported tree, by the suffix of its file."""

import bpy

from ..gltf import export_tree
from ..usd import stage


def _write_usd(tree, path, options):
    return stage.write(tree, path, options, where=bpy.utils.user_resource("SCRIPTS", path="modules"))


WRITERS = {**export_tree.GLTF, **dict.fromkeys(stage.SUFFIXES, _write_usd)}


def export(context, obj, path, options):
    """Writes a tree in any of the formats. See export_tree.export."""
    return export_tree.export(context, obj, path, options, WRITERS)
