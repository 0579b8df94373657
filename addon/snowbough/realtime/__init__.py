# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine Snowbough Realtime: from Blender's evaluated scene to the native real-time renderer and back.

`records` is the scene as plain data, which `reader` fills from Blender and `sync` hands to the renderer; `viewport`
shows finished frames, `engine` is what Blender calls.
"""
