# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees as game engines take them: glTF 2.0 with levels of detail, skin, branch levels and the baked snow."""
