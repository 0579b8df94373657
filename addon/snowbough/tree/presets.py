# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the import operator, shown in its file browser as Blender's operator presets.

A preset has the differences from the options' defaults. Options that depend on the file are not in presets.
"""

import tempfile
from dataclasses import asdict
from pathlib import Path

import bpy

from ..base import compat
from .import_options import ImportOptions

OPERATOR = "import_scene.xfrog_tree"

# Options that presets do not set.
OF_THE_FILE = {
    "up_axis",
    "unit",
    "height",
    "levels",
    "outside_files",
    "keep_surface",
    "bones",
    "foliage_names",
    "snow_resolution",
    "show_bones",
    "mark_asset",
}

PRESETS = {
    "Broad-leaf": {},
    "Evergreen": {"width": "INVERSE", "species": "EVERGREEN"},
    "Game_engine": {
        "detail": "GAME",
        "lod_chain": True,
        "max_bones": 250,
        "max_bone_level": 2,
    },
    "Film_close-up": {"detail": "FILM", "max_bones": 0},
}

_registered = []


def text_of(preset):
    """The script by which Blender applies a preset to the operator."""
    values = {
        **{name: value for name, value in asdict(ImportOptions()).items() if name not in OF_THE_FILE},
        **preset,
    }
    lines = [f"op.{name} = {value!r}" for name, value in values.items()]
    return "\n".join(["import bpy", "", "op = bpy.context.active_operator", "", *lines, ""])


def write_presets(folder):
    """Writes all presets as files to folder/operator/<operator>."""
    target = Path(folder) / "operator" / OPERATOR
    target.mkdir(parents=True, exist_ok=True)
    for name, preset in PRESETS.items():
        (target / f"{name}.py").write_text(text_of(preset), encoding="utf-8")


def register():
    # In Blender's temporary folder, which is deleted with the session.
    folder = Path(tempfile.mkdtemp(prefix="snowbough-", dir=bpy.app.tempdir)) / "presets"
    write_presets(folder)
    _registered.append((folder, compat.register_presets(folder, OPERATOR)))


def unregister():
    compat.unregister_presets(*_registered.pop())
