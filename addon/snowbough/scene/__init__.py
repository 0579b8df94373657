# SPDX-License-Identifier: GPL-3.0-or-later
"""What snow falls on: from Blender's evaluated scene to plain arrays, and the list of receivers."""
