# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: what is the machine's and not the shot's."""

import bpy
from bpy.props import EnumProperty, IntProperty

# The name that the add-on was enabled under.
ADDON = __package__.rpartition(".")[0]

ENGINES = (
    (
        "AUTO",
        "Automatic",
        "The graphics card where there is one with a driver that can do it, else the processor",
    ),
    ("GL", "Graphics Card", "OpenGL 4.5, the quickest with a graphics card. Refuses where there is none"),
    (
        "CPU",
        "Processor",
        "All cores of the processor. Needs no graphics driver, so it works in containers, on farm nodes and where "
        "OpenGL is too old, as on macOS",
    ),
)

PREVIEW_RESOLUTIONS = (
    ("AUTO", "Automatic", "1024 where a graphics card computes the snow, 256 on the processor"),
    *(
        (str(side), str(side), f"Maps of {side} x {side} texels at most")
        for side in (256, 512, 1024, 2048, 4096)
    ),
)


class SnowboughPreferences(bpy.types.AddonPreferences):
    bl_idname = ADDON

    engine: EnumProperty(
        name="Compute Snow With",
        description="What bakes and previews compute snow with. The two agree but for rounding; a stopped bake "
        "resumes with the one that began it",
        items=ENGINES,
        default="AUTO",
    )

    preview_resolution: EnumProperty(
        name="Preview Maps",
        description="Largest maps of the live preview; receivers with smaller ones have their own (texels)",
        items=PREVIEW_RESOLUTIONS,
        default="AUTO",
    )
    preview_memory: IntProperty(
        name="Preview Memory",
        description="What the live preview remembers of the frames it has played, to scrub in (megabytes)",
        default=1024,
        min=16,
        soft_max=16384,
    )

    def draw(self, _context):
        self.layout.use_property_split = True
        for name in ("engine", "preview_resolution", "preview_memory"):
            self.layout.prop(self, name)


def _preference(name, otherwise):
    """A preference, or `otherwise` where the add-on runs without any, as from a checkout."""
    addon = bpy.context.preferences.addons.get(ADDON)
    return getattr(addon.preferences, name, otherwise) if addon is not None else otherwise


def preferred_engine():
    """AUTO, GL or CPU as the preferences say."""
    return _preference("engine", "AUTO")


def preview_limits():
    """(largest maps of the preview in texels, 0 = automatic; what its memory of frames may take in bytes)."""
    resolution = _preference("preview_resolution", "AUTO")
    return 0 if resolution == "AUTO" else int(resolution), _preference("preview_memory", 1024) << 20


def register():
    bpy.utils.register_class(SnowboughPreferences)


def unregister():
    bpy.utils.unregister_class(SnowboughPreferences)
