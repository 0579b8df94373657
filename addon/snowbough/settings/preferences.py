# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: settings of the computer, not of the shot."""

import bpy
from bpy.props import EnumProperty, IntProperty

# The name under which the add-on was enabled.
ADDON = __package__.rpartition(".")[0]

ENGINES = (
    (
        "AUTO",
        "Automatic",
        "The graphics card if its driver supports OpenGL 4.5, else the processor",
    ),
    (
        "GL",
        "Graphics Card",
        "OpenGL 4.5, the fastest with a graphics card. Fails without an OpenGL 4.5 driver",
    ),
    (
        "CPU",
        "Processor",
        "All cores of the processor. Needs no graphics driver, so it works in containers, on render farms and on "
        "macOS",
    ),
)

PREVIEW_RESOLUTIONS = (
    ("AUTO", "Automatic", "1024 texels on a graphics card, 256 texels on the processor"),
    *(
        (str(side), str(side), f"Maps of at most {side} x {side} texels")
        for side in (256, 512, 1024, 2048, 4096)
    ),
)


class SnowboughPreferences(bpy.types.AddonPreferences):
    bl_idname = ADDON

    engine: EnumProperty(
        name="Compute Snow With",
        description="Engine that computes the snow of bakes and previews. Both give the same snow except for "
        "rounding. A stopped bake resumes with the engine that started it",
        items=ENGINES,
        default="AUTO",
    )

    preview_resolution: EnumProperty(
        name="Preview Maps",
        description="Largest map size of the live preview (texels). Larger maps show finer snow and update more slowly",
        items=PREVIEW_RESOLUTIONS,
        default="AUTO",
    )
    preview_memory: IntProperty(
        name="Preview Memory (MB)",
        description="Memory for the frames that the live preview has played (megabytes). More memory keeps more "
        "frames for scrubbing",
        default=1024,
        min=16,
        soft_max=16384,
    )

    def draw(self, _context):
        self.layout.use_property_split = True
        for name in ("engine", "preview_resolution", "preview_memory"):
            self.layout.prop(self, name)


def _preference(name, otherwise):
    """A preference, or `otherwise` if the add-on is not enabled, as when run from a checkout."""
    addon = bpy.context.preferences.addons.get(ADDON)
    return getattr(addon.preferences, name, otherwise) if addon is not None else otherwise


def preferred_engine():
    """AUTO, GL or CPU, from the preferences."""
    return _preference("engine", "AUTO")


def preview_limits():
    """(largest map side of the preview in texels, 0 = automatic; bytes for the frames that it keeps)."""
    resolution = _preference("preview_resolution", "AUTO")
    return 0 if resolution == "AUTO" else int(resolution), _preference("preview_memory", 1024) << 20


register, unregister = bpy.utils.register_classes_factory((SnowboughPreferences,))
