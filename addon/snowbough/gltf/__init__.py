# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports trees for game engines: glTF 2.0 with levels of detail, skin, branch levels and the baked snow."""
