# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sets: ``scene.snowbough``, ``object.snowbough``, ``mesh.snowbough`` and the add-on's preferences.

Names, units and defaults are part of the interface that scripts rely on.
"""
