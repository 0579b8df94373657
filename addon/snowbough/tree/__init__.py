# SPDX-License-Identifier: GPL-3.0-or-later
"""From an OBJ file to a rigged tree in the scene, and its sway in the wind."""
