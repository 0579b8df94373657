# SPDX-License-Identifier: GPL-3.0-or-later
"""Names and limits that several rooms use, each written once. No ``bpy``.

What is part of files (names of UV maps, properties, modifiers) must stay: scenes made before are found by it.
"""

import hashlib
import math
import re

# UV maps: bark tiles, original and leaves lie where their exporter put them, snow stores every place once.
BARK_UV = "bark"
ORIGINAL_UV = "original"
LEAF_UV = "leaf"
SNOW_UV = "snow"

# How far beyond 0 to 1 UVs may lie on a snow map; the native module has the same.
UV_TOLERANCE = 1e-4

# Metres from the origin beyond which single precision no longer tells texels apart: vertices there are left out.
FARTHEST = 1e6

# Our render engine for 3D views and F12, as Blender knows it.
REALTIME_ENGINE = "SNOWBOUGH_REALTIME"

# On an object: the side in texels that its UV map `snow` was laid out for.
SNOW_RESOLUTION_PROPERTY = "snowbough_snow_resolution"

# Texels a side of an accumulation map, as the native module takes them.
MIN_RESOLUTION = 64
MAX_RESOLUTION = 8192

# Radians between falling snow and the vertical: beyond, open ground would need endlessly deep snow.
MAX_FALL_ANGLE = math.radians(89.5)

# The node group of all snow materials.
SNOW_GROUP = "Snowbough Snow"

# Kinds of snow, as Blender lists choices; what they set is in result.look.
SNOW_KINDS = (
    ("POWDER", "Powder", "Dry and loose: fine grains, much glitter, lies on gentle slopes only"),
    ("FRESH", "Fresh", "Fallen a few hours ago: soft relief, some glitter"),
    ("WET", "Wet", "Heavy and smooth, a little darker, sticks to steep things"),
    ("OLD", "Old", "Weathered: coarse grains, deeper relief, greyer"),
)

# On the points of an imported tree's leaves: the bone that a leaf hangs on, as the number of its vertex group.
LEAF_BONE_ATTRIBUTE = "snowbough_bone"

# On the points of an imported tree's bark: the level of their branch, the trunk's is the lowest. glTF carries only
# attributes whose names begin with an underscore, and only those of points.
POINT_LEVEL_ATTRIBUTE = "_BRANCH_LEVEL"

# On the points of an object that is told to keep it: where they are undeformed. Blender's own name.
REST_ATTRIBUTE = "rest_position"

# The modifiers that a receiver gets for its displacement.
SUBDIVISION_MODIFIER = "Snowbough Subdivision"
DISPLACE_MODIFIER = "Snowbough Displace"
OWN_MODIFIERS = (SUBDIVISION_MODIFIER, DISPLACE_MODIFIER)

# The modifier of a snow surface, which reads its points.
SURFACE_MODIFIER = "Snowbough Surface"

# Exit codes of the command line (bake.cli and tree.cli say when).
EXIT_OK = 0
EXIT_FAILED = 1
EXIT_NO_CHECKPOINT = 3
EXIT_CHANGED = 4
EXIT_CACHE = 5
EXIT_NO_NATIVE = 6
EXIT_LOCK_LOST = 7
EXIT_STOPPED = 130


# Names of devices under Windows, where no file can have them, whatever follows after a dot.
_DEVICE = re.compile(r"(?:CON|PRN|AUX|NUL|COM\d|LPT\d)(?:\.|$)", re.IGNORECASE)
# A safe name that ends like the ones that carry a digest.
_TAGGED = re.compile(r"-[0-9a-f]{8}$", re.IGNORECASE)


def safe_name(name):
    """A file name that every system takes: ASCII letters, digits, ``.``, ``_``, ``-``; at most 64. Several names may
    give the same one."""
    cleaned = re.sub(r"[^A-Za-z0-9._-]", "_", name)[:64].lstrip(".-")
    return f"_{cleaned}" if not cleaned or _DEVICE.match(cleaned) else cleaned


def folder_name(name):
    """safe_name, one for each name, also where a file system takes upper and lower case for the same: of the names
    that would share one, ``Like this`` keeps it and the others get eight digits."""
    safe = safe_name(name)
    if safe == name == name.capitalize() and not name.endswith(".") and not _TAGGED.search(name):
        return safe
    return tagged_name(name, ())


def tagged_name(name, identity):
    """safe_name and eight digits that tell apart all pairs of a name and an identity, a tuple of texts or numbers."""
    text = "\0".join(str(part) for part in (name, *identity))
    return f"{safe_name(name)}-{hashlib.blake2b(text.encode(), digest_size=4).hexdigest()}"


def receiver_key(name, identity):
    """Folder name of a receiver: its safe name and eight digits that tell apart local and linked objects
    of one name and instances. identity: tuple of what is unique about it (library, instancer, index)."""
    return tagged_name(name, identity)


# What an import or export may run into; it is said to the user. Nothing else is caught.
FAILURES = (ValueError, RuntimeError, OSError, MemoryError)
