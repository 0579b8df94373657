# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface of baked receivers: recorded while a bake runs, computed from the cache alone. No ``bpy``."""
