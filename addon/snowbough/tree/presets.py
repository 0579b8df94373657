# SPDX-License-Identifier: GPL-3.0-or-later
"""Ready-made settings of the import operator, shown in its file browser as Blender's operator presets.

The presets are the files in presets/operator/import_scene.xfrog_tree.
"""

from pathlib import Path

from . import compat

FOLDER = Path(__file__).resolve().parent / "presets"
_tokens = []


def register():
    _tokens.append(compat.register_presets(FOLDER))


def unregister():
    compat.unregister_presets(FOLDER, _tokens.pop())
