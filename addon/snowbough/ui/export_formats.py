# SPDX-License-Identifier: GPL-3.0-or-later
"""The formats of an exported tree, by the suffix of its file."""

from dataclasses import replace
from pathlib import Path

import bpy

from ..gltf import export_tree
from ..usd import stage

WRITERS = {**export_tree.GLTF, **dict.fromkeys(stage.SUFFIXES, stage.write)}


def export(context, obj, path, options):
    """Writes a tree in any of the formats. See export_tree.export."""
    if Path(path).suffix.lower() in stage.SUFFIXES:
        stage.library(bpy.utils.user_resource("SCRIPTS", path="modules"))
        # USD has the finest level alone.
        options = replace(options, levels=1, cards=False)
    return export_tree.export(context, obj, path, options, WRITERS)
