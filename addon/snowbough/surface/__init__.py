# SPDX-License-Identifier: GPL-3.0-or-later
"""The snow surface of baked receivers: recorded during a bake, computed only from the cache. No ``bpy``."""
