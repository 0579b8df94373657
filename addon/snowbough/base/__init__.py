# SPDX-License-Identifier: GPL-3.0-or-later
"""What all rooms use: names, kinds of maps, the native module, data of the session, differences between versions of
Blender, shorthand for nodes and options."""
