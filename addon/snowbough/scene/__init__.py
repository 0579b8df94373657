# SPDX-License-Identifier: GPL-3.0-or-later
"""What snow falls on: Blender's evaluated scene as plain arrays, and the list of receivers."""
