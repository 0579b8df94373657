# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowbough: trees from OBJ as rigged meshes, and snow that stays where it fell.

This file is the add-on's table of contents. Each module below has a ``register`` and an
``unregister`` and nothing else runs on import, so the add-on enables on any machine; what needs the
native module loads it through :mod:`snowbough.native` when it is first used.
"""

import importlib

bl_info = {
    "name": "Snowbough",
    "author": "The Snowbough authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > Xfrog Tree (.obj); Scene properties > Snowbough; 3D View > Sidebar",
    "description": "Imports Xfrog trees as continuous, rigged meshes and lets snow fall on animated shots",
    "category": "Import-Export",
}

MODULES = (
    "import_tree",
    "import_presets",
    "sway",
    "cli",
    "settings",
    "receivers",
    "bake_engine",
    "bake_lock",
    "bake_operators",
    "result_operators",
    "direction",
    "preview",
    "preflight",
    "panels",
)

_modules = [importlib.import_module(f".{name}", __package__) for name in MODULES]


def register():
    for module in _modules:
        module.register()


def unregister():
    for module in reversed(_modules):
        module.unregister()
