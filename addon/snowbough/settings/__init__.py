# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings: ``scene.snowbough``, ``object.snowbough``, ``mesh.snowbough`` and the add-on's preferences.

Scripts rely on their names, units and defaults.
"""
