# SPDX-License-Identifier: GPL-3.0-or-later
"""Snowbough: trees from OBJ files as rigged meshes, and snow on animated shots.

This file lists the add-on's modules. Importing the package loads nothing else, so that modules which do not need
Blender can be used without it. register() loads the modules below and calls the ``register`` of each. Nothing else
runs on import, so the add-on enables on any machine. :mod:`snowbough.base.native` loads the native module on first use.
"""

import importlib
import sys

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
    "settings.bending",
    "settings.objects",
    "settings.scene",
    "settings.preferences",
    "cli",
    "tree.presets",
    "tree.kept_skeleton",
    "tree.kept_bark",
    "bake.cache_place",
    "bake.engine",
    "bake.outcome",
    "bake.preflight",
    "result.surface_files",
    "result.surface_preview",
    "result.deleted_receivers",
    "result.flying_snow",
    "preview.live",
    "realtime.options",
    "realtime.engine",
    "realtime.panels",
    "ui.import_panels",
    "ui.import_operators",
    "ui.export_operator",
    "ui.sway_operator",
    "ui.receiver_operators",
    "ui.editing_lock",
    "ui.bake_operators",
    "ui.result_operators",
    "ui.surface_operators",
    "ui.direction",
    "ui.preview_operator",
    "ui.preflight_operators",
    "ui.panels",
    "ui.bending_operators",
)

_registered = []


def _forget_loaded_modules():
    """Unloads all modules, so that the code on disk runs after disabling and enabling, or Reload Scripts. The data in
    `session` stays."""
    session = f"{__package__}.base.session"
    for name in [name for name in sys.modules if name.startswith(f"{__package__}.")]:
        if name not in (session, f"{__package__}.base"):  # reload() needs the package of the module
            del sys.modules[name]
            # `from . import name` would find the old module here.
            parent, _, own = name.rpartition(".")
            if parent in sys.modules:
                vars(sys.modules[parent]).pop(own, None)
    if session in sys.modules:
        importlib.reload(sys.modules[session])


def register():
    if _blocks():  # the running bake has kept all modules
        sys.modules[f"{__package__}.base.session"].enabled = True
        return
    _unregister_modules()
    _forget_loaded_modules()
    for name in MODULES:
        module = importlib.import_module(f".{name}", __package__)
        module.register()
        _registered.append(module)


def unregister():
    """Unregisters all modules. While a bake runs inside a call of its operator, as in the background, the operator's
    class must stay. Then the bake is asked to stop, and the modules are unregistered after it."""
    if not _blocks():
        _unregister_modules()
        return
    sys.modules[f"{__package__}.base.session"].enabled = False
    sys.modules[f"{__package__}.bake.engine"].stop_and_call(_unregister_later)


def _blocks():
    session = sys.modules.get(f"{__package__}.base.session")
    return session is not None and session.bake is not None and session.bake.blocks


def _unregister_later():
    """Timer: waits for the end of the bake."""
    if _blocks():
        return 0.1
    if not sys.modules[f"{__package__}.base.session"].enabled:
        _unregister_modules()
    return None


def _unregister_modules():
    while _registered:
        _registered.pop().unregister()
