# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine Snowbough Realtime: it passes Blender's evaluated scene to the native real-time
renderer and shows the images.

`records` describes the scene as plain data. `reader` fills it from Blender, `sync` passes it to the renderer,
`viewport` shows finished frames, and `engine` contains the class that Blender calls.
"""
