# SPDX-License-Identifier: GPL-3.0-or-later
"""Names and limits that several rooms use, and amounts as text. No ``bpy``.

Names that files store (UV maps, properties, modifiers) must not change, or existing scenes are not recognised.
"""

import hashlib
import math
import re

# UV maps: bark repeats, original and leaf keep the exporter's coordinates, snow has no overlaps.
BARK_UV = "bark"
ORIGINAL_UV = "original"
LEAF_UV = "leaf"
SNOW_UV = "snow"

# Tolerance for UVs outside 0 to 1 on a snow map; the native module has the same.
UV_TOLERANCE = 1e-4

# Depth of snow in metres that the look assumes at least: its noise and shapes are scaled by the depth.
MIN_DEPTH = 1e-4

# Metres from the origin beyond which single precision cannot separate texels; such vertices are left out.
FARTHEST = 1e6

# Identifier of our render engine for 3D views and F12.
REALTIME_ENGINE = "SNOWBOUGH_REALTIME"

# On an object: side, in texels, of the map that its UV map `snow` was packed for.
SNOW_RESOLUTION_PROPERTY = "snowbough_snow_resolution"

# Side of a map in texels, as the native module accepts it.
MIN_RESOLUTION = 64
MAX_RESOLUTION = 8192

# Radians between falling snow and the vertical. At 90 degrees no snow would reach level ground.
MAX_FALL_ANGLE = math.radians(89.5)

# The node group of all snow materials.
SNOW_GROUP = "Snowbough Snow"

# Kinds of snow, as items of an enum property; result.look has their values.
SNOW_KINDS = (
    ("POWDER", "Powder", "Dry and loose: fine grains, much glitter, only on gentle slopes"),
    ("FRESH", "Fresh", "Fallen a few hours ago: soft bumps, some glitter"),
    ("WET", "Wet", "Heavy and smooth, slightly darker, sticks to steep surfaces"),
    ("OLD", "Old", "Weathered: coarse grains, higher bumps, greyer"),
    ("SAND", "Sand", "Dry sand: round heaps of 34 degrees, no light inside"),
    ("DUST", "Dust", "A thin film from the whole sky, also on walls and a little on undersides"),
    ("ASH", "Ash", "Volcanic ash: dark and loose, in round heaps of 35 degrees"),
)

# On the points of imported leaves: the bone of the leaf, as the index of its vertex group.
LEAF_BONE_ATTRIBUTE = "snowbough_bone"

# On the points of imported bark: the lowest level of their branches, 0 is the trunk. glTF exports only attributes of
# points, and only those whose names begin with an underscore.
POINT_LEVEL_ATTRIBUTE = "_BRANCH_LEVEL"

# Blender's own attribute of the undeformed positions of points, on objects that store it.
REST_ATTRIBUTE = "rest_position"

# The modifiers that displace a receiver.
SUBDIVISION_MODIFIER = "Snowbough Subdivision"
DISPLACE_MODIFIER = "Snowbough Displace"
OWN_MODIFIERS = (SUBDIVISION_MODIFIER, DISPLACE_MODIFIER)

# The modifier that reads the points of a snow surface.
SURFACE_MODIFIER = "Snowbough Surface"

# On the points of a snow surface: their positions in the last frame.
SURFACE_POSITION_ATTRIBUTE = "snow_position"

# On the points of the snow surface of a rigid receiver: their positions without snow.
SURFACE_BARE_ATTRIBUTE = "snow_bare"

# On the points of a snow surface: how near they lie to where it goes on within the snow of another piece, 0 to 1.
SURFACE_JOINT_ATTRIBUTE = "snow_joint"

# Exit codes of the command line (see bake.cli and tree.cli).
EXIT_OK = 0
EXIT_FAILED = 1
EXIT_NO_CHECKPOINT = 3
EXIT_CHANGED = 4
EXIT_CACHE = 5
EXIT_NO_NATIVE = 6
EXIT_LOCK_LOST = 7
EXIT_COVERAGE = 8
EXIT_STOPPED = 130


# Device names of Windows, which no file may have, with or without a suffix.
_DEVICE = re.compile(r"(?:CON|PRN|AUX|NUL|COM\d|LPT\d)(?:\.|$)", re.IGNORECASE)
# A safe name that ends like one with a digest.
_TAGGED = re.compile(r"-[0-9a-f]{8}$", re.IGNORECASE)


def safe_name(name):
    """A file name that is valid on every system: ASCII letters, digits, ``.``, ``_``, ``-``; at most 64. Several names
    may give the same one."""
    cleaned = re.sub(r"[^A-Za-z0-9._-]", "_", name)[:64].lstrip(".-")
    return f"_{cleaned}" if not cleaned or _DEVICE.match(cleaned) else cleaned


def folder_name(name):
    """A safe name that is unique for each name, also on file systems that ignore case: ``Like this`` stays, all other
    names get eight digits."""
    safe = safe_name(name)
    if safe == name == name.capitalize() and not name.endswith(".") and not _TAGGED.search(name):
        return safe
    return tagged_name(name, ())


def tagged_name(name, identity):
    """A safe name with eight digits that are unique for a name and an identity, a tuple of texts or numbers."""
    text = "\0".join(str(part) for part in (name, *identity))
    return f"{safe_name(name)}-{hashlib.blake2b(text.encode(), digest_size=4).hexdigest()}"


def receiver_key(name, identity):
    """Folder name of a receiver: its safe name and eight digits that separate local objects, linked objects and
    instances of one name. identity: tuple of its unique properties (library, instancer, index)."""
    return tagged_name(name, identity)


def counted(number, noun, plural=None):
    """``1 file``, ``1,204 files``, ``2 branches``."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


def sized(count):
    """A number of bytes for people: ``640 KiB``, ``40 MiB``, ``3.2 GiB``."""
    for unit, size, digits in (("GiB", 2**30, 1), ("MiB", 2**20, 0)):
        if count >= size:
            return f"{count / size:.{digits}f} {unit}"
    return f"{-(-int(count) // 1024)} KiB"


# Units as tooltips name them in brackets, and as labels and messages show them.
_UNITS = {
    "metres": "m",
    "seconds": "s",
    "texels": "texels",
    "degrees": "°",
    "kilograms": "kg",
    "kilograms per cubic metre": "kg/m³",
    "gigapascals": "GPa",
    "megapascals": "MPa",
}


def unit_of(description):
    """The unit of a setting with that tooltip: m, s, texels, ° (whose values are radians), kg/m³, or nothing."""
    return next((unit for name, unit in _UNITS.items() if f"({name})" in description), "")


def with_unit(value, unit):
    """The value of a setting for people: ``0.1 m``, ``7.162°``."""
    if not isinstance(value, float):
        return "not set" if value is None else str(value)
    return f"{math.degrees(value):.4g}°" if unit == "°" else f"{value:.6g} {unit}".strip()


# Parts of the names of renderers and drivers that run on the processor.
_SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "software")


def is_software(renderer):
    """Whether the renderer or driver with that name runs on the processor."""
    return any(name in renderer.lower() for name in _SOFTWARE)


# Errors of an import or an export that are reported to the user. Other errors are not caught.
FAILURES = (ValueError, RuntimeError, OSError, MemoryError)
