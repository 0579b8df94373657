# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sets: ``scene.snowbough``, ``object.snowbough`` and the add-on's preferences.

The list of receivers belongs to the scene, because settings on linked or overridden objects get lost.
Names, units and defaults are part of the interface that scripts rely on. Nothing here computes:
:mod:`.bake.plan` turns the numbers into snowfall.

A setting of the simulation itself stands in SnowProperties and nowhere else: bakes, previews and manifests carry
them all as one dict (snow_of), under the names that the native ``SnowSimulation`` has for them.
"""

import math

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import compat
from .names import MAX_FALL_ANGLE, MAX_RESOLUTION, SNOW_KINDS

MAPPINGS = (
    ("COMPUTE", "Compute", "Texels gather what they see of the sky: smooth, and the same bytes every time"),
    (
        "GEOMETRY",
        "Geometry",
        "Pixels scatter their snow over texels, as first published: uneven, needs OpenGL; for comparison",
    ),
)

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


SIDES = (
    (
        "AUTO",
        "Automatic",
        "Both sides of parts that have no inside, such as leaves, cards, flags and bowls; the outside of all else",
    ),
    ("FRONT", "Front", "Only the front of faces, where their normals point to"),
    ("BOTH", "Both", "Whichever side faces the sky"),
)


def _range_getter(name):
    def get(self):
        return getattr(self.id_data, name) if self.use_scene_range else getattr(self, f"own_{name}")

    return get


def _range_setter(name):
    other = {"frame_start": "frame_end", "frame_end": "frame_start"}[name]

    def set_(self, value):
        if self.use_scene_range:
            setattr(self, f"own_{other}", getattr(self.id_data, other))
            self.use_scene_range = False
        setattr(self, f"own_{name}", value)

    return set_


class SnowboughReceiver(bpy.types.PropertyGroup):
    """One entry of the scene's list: an object that snow accumulates on."""

    object: PointerProperty(
        name="Object",
        description="Mesh, or empty that instances a collection, that snow accumulates on",
        type=bpy.types.Object,
    )
    enabled: BoolProperty(
        name="Bake",
        description="Bake this receiver. Switched off it still shelters what is below it",
        default=True,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Width and height of the accumulation map (texels). "
        "0 chooses a power of two from 256 to 4096 from the surface area and the texel size",
        default=0,
        min=0,
        max=MAX_RESOLUTION,
    )
    uv_map: StringProperty(
        name="UV Map",
        description="UV map without overlaps that snow is stored in. "
        "Empty takes the map named 'snow', else the object's active one",
    )
    sides: EnumProperty(
        name="Sides",
        description="Which sides of its faces take snow",
        items=SIDES,
        default="AUTO",
    )
    folder: StringProperty(
        name="Baked Files",
        description="Folder of the newest finished bake of this receiver",
        subtype="DIR_PATH",
        options={"HIDDEN"} | compat.BLEND_RELATIVE,
    )
    restore: StringProperty(
        name="Restore",
        description="What the object was like before Snowbough changed it, as JSON",
        options={"HIDDEN"},
    )


class SnowProperties:
    """What ``SnowSimulation`` takes under the same names: metres, seconds, radians (bake.simulation converts)."""

    flutter: FloatProperty(
        name="Flutter",
        description="Half angle of the cone in which flakes stray from the direction (degrees)",
        subtype="ANGLE",
        default=math.radians(10.0),
        min=0.0,
        max=math.radians(45.0),
    )
    max_depth: FloatProperty(
        name="Maximum Depth",
        description="Snow that level ground holds before it slides off (metres)",
        default=1.0,
        min=1e-4,
        soft_max=10.0,
    )
    slide_half_life: FloatProperty(
        name="Slide Half-Life",
        description="Time in which half of the excess snow slides off (seconds)",
        default=2.0,
        min=1e-3,
        soft_max=60.0,
    )
    repose: FloatProperty(
        name="Repose",
        description="Steepest slope of snow's own surface before it moves to what lies lower or falls over an edge: "
        "wet snow stands steeper than powder. At 90 snow stays where it fell, on walls too (degrees)",
        subtype="ANGLE",
        default=math.radians(65.0),
        min=math.radians(5.0),
        max=math.radians(90.0),
    )
    seed: IntProperty(
        name="Seed",
        description="Another number gives other random flakes (no unit)",
        default=0,
        min=0,
    )
    noise_density: FloatProperty(
        name="Noise Density",
        description="Share of pixels that catch a flake in one step; below 1 the snow gets grainy (0 to 1)",
        default=1.0,
        min=0.001,
        max=1.0,
    )
    mapping: EnumProperty(
        name="Mapping",
        description="How snow gets from the occlusion grid onto the maps; both give the same snow",
        items=MAPPINGS,
        default="COMPUTE",
    )


SNOW_SETTINGS = tuple(SnowProperties.__annotations__)


def snow_of(settings):
    """{name: value} of ``scene.snowbough``'s SnowProperties, as plain data."""
    return {name: getattr(settings, name) for name in SNOW_SETTINGS}


class SnowboughSceneSettings(SnowProperties, bpy.types.PropertyGroup):
    """``scene.snowbough``: one snowfall over one shot."""

    cache_directory: StringProperty(
        name="Cache",
        description="Folder for the baked maps; // stands for the folder of the .blend",
        subtype="DIR_PATH",
        default="//snowbough_cache",
        options={"ANIMATABLE"} | compat.BLEND_RELATIVE,
    )
    cache_used: StringProperty(
        name="Cache of the Last Bake",
        description="Absolute folder that the last bake wrote to; found again after Save As",
        options={"HIDDEN"},
    )

    use_scene_range: BoolProperty(
        name="Scene Range",
        description="Snow falls over the scene's frame range",
        default=True,
    )
    own_frame_start: IntProperty(
        name="Own First Frame",
        description="First frame where Scene Range is off (frames)",
        default=1,
        min=0,
        options={"HIDDEN"},
    )
    own_frame_end: IntProperty(
        name="Own Last Frame",
        description="Last frame where Scene Range is off (frames)",
        default=250,
        min=0,
        options={"HIDDEN"},
    )
    frame_start: IntProperty(
        name="First Frame",
        description="First frame of the shot; the start depth lies there before its own snow (frames)",
        min=0,
        get=_range_getter("frame_start"),
        set=_range_setter("frame_start"),
    )
    frame_end: IntProperty(
        name="Last Frame",
        description="Last frame of the shot: the end depth lies there (frames)",
        min=0,
        get=_range_getter("frame_end"),
        set=_range_setter("frame_end"),
    )

    kind: EnumProperty(
        name="Kind of Snow",
        description="What snow that is put on objects looks like (Set Kind of Snow changes what lies already)",
        items=SNOW_KINDS,
        default="FRESH",
    )
    start_depth: FloatProperty(
        name="Start Depth",
        description="Snow on open level ground at the first frame (metres)",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        step=1,
        precision=3,
    )
    end_depth: FloatProperty(
        name="End Depth",
        description="Snow on open level ground at the last frame (metres)",
        default=0.10,
        min=0.0,
        soft_max=1.0,
        step=1,
        precision=3,
    )
    rate: FloatProperty(
        name="Rate",
        description="Relative strength of the snowfall, to be keyframed: it spreads the depth over the "
        "shot and does not change the end depth (no unit)",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    fall_angle: FloatProperty(
        name="Fall Angle",
        description="Angle between the falling snow and the vertical (degrees)",
        subtype="ANGLE",
        default=0.0,
        min=0.0,
        max=MAX_FALL_ANGLE,
    )
    bearing: FloatProperty(
        name="Bearing",
        description="Where the wind blows to, clockwise from +Y seen from above (degrees)",
        subtype="ANGLE",
        default=0.0,
        soft_min=-2 * math.pi,
        soft_max=2 * math.pi,
    )
    show_direction: BoolProperty(
        name="Show Direction",
        description="Show dials for the direction of the snow in the 3D view",
        default=True,
    )

    texel_size: FloatProperty(
        name="Texel Size",
        description="Target size of a texel for receivers with automatic resolution (metres)",
        default=0.01,
        min=1e-5,
        soft_max=1.0,
        step=1,
        precision=4,
    )
    pixel_size: FloatProperty(
        name="Pixel Size",
        description="Grid on which occlusion is found (metres). 0 takes the finest receiver's texel",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        step=1,
        precision=4,
    )
    blur_radius: FloatProperty(
        name="Blur Radius",
        description="Smoothing of the written maps: sigma in each map's own texels (texels)",
        default=2.0,
        min=0.0,
        soft_max=16.0,
    )
    substeps: IntProperty(
        name="Substeps",
        description="Poses that each frame's snowfall is spread over, for fast objects (poses a frame)",
        default=1,
        min=1,
        max=16,
    )
    directions: IntProperty(
        name="Directions",
        description="Directions of flutter that a shot's snow falls from at least: few frames are divided into more "
        "steps, so that a still is as smooth as a long shot (directions a shot)",
        default=64,
        min=1,
        soft_max=256,
    )
    checkpoint_interval: IntProperty(
        name="Checkpoint Every",
        description="A stopped bake resumes from the last checkpoint (frames)",
        default=10,
        min=1,
        soft_max=100,
    )
    write_normals: BoolProperty(
        name="Normal Maps",
        description="Also write tangent-space normal maps of the snow",
        default=False,
    )

    receivers: CollectionProperty(
        name="Receivers",
        description="Objects that snow accumulates on; all other rendered meshes shelter them",
        type=SnowboughReceiver,
    )
    active_receiver: IntProperty(
        name="Active Receiver",
        description="Line of the list that is shown below it (no unit)",
        options={"HIDDEN"},
    )


class SnowboughObjectSettings(bpy.types.PropertyGroup):
    """``object.snowbough``."""

    occlude: BoolProperty(
        name="Blocks Snow",
        description="This object keeps snow from what is below it",
        default=True,
    )
    is_shell: BoolProperty(
        name="Is Snow",
        description="A snow shell that Snowbough made; bakes leave it out",
        options={"HIDDEN"},
    )
    hidden_by_preview: StringProperty(
        name="Hidden by the Preview",
        description="What the live preview keeps out of sight while it runs, and how it was before, as JSON",
        options={"HIDDEN"},
    )


class SnowboughMeshData(bpy.types.PropertyGroup):
    """``mesh.snowbough``, of an imported tree's bark."""

    bark_vertices: IntProperty(
        name="Vertices of the Bark",
        description="As many as the import made: with others it has been edited (no unit)",
        options={"HIDDEN"},
    )


class SnowboughPreferences(bpy.types.AddonPreferences):
    """The add-on's preferences: what is the machine's and not the shot's."""

    bl_idname = __package__

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
    addon = bpy.context.preferences.addons.get(__package__)
    return getattr(addon.preferences, name, otherwise) if addon is not None else otherwise


def preferred_engine():
    """AUTO, GL or CPU as the preferences say."""
    return _preference("engine", "AUTO")


def preview_limits():
    """(largest maps of the preview in texels, 0 = automatic; what its memory of frames may take in bytes)."""
    resolution = _preference("preview_resolution", "AUTO")
    return 0 if resolution == "AUTO" else int(resolution), _preference("preview_memory", 1024) << 20


CLASSES = (
    SnowboughReceiver,
    SnowboughSceneSettings,
    SnowboughObjectSettings,
    SnowboughMeshData,
    SnowboughPreferences,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.snowbough = PointerProperty(type=SnowboughSceneSettings)
    bpy.types.Object.snowbough = PointerProperty(type=SnowboughObjectSettings)
    bpy.types.Mesh.snowbough = PointerProperty(type=SnowboughMeshData)


def unregister():
    del bpy.types.Mesh.snowbough
    del bpy.types.Object.snowbough
    del bpy.types.Scene.snowbough
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
