# SPDX-License-Identifier: GPL-3.0-or-later
"""The maps that a bake writes for each frame. A new map is a row of MAP_KINDS, and a row of kMapsOnRequest in
``native/snow/output/map_output.h``. No ``bpy``.

Folders, bakes, settings, panels, images and materials read this table. A name that a file stores must not change.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MapKind:
    """One kind of map. ``<name>_<frame>.<ending>`` stores ``value * scale + offset``."""

    name: str
    """Key in the dict of the native output, and beginning of the files' names."""
    channels: int
    """1 for a number per texel, 3 for a direction in tangent space, 0 for points in space. A material links it to the
    input of the group `Snowbough Snow` with the same name in capitals (result.snow_nodes)."""
    is_half: bool
    """Whether a channel has 16 bits instead of 32."""
    scale: float = 1.0
    offset: float = 0.0
    ending: str = "exr"
    color_space: str = "Non-Color"
    setting: str = ""
    """The switch of the scene's settings that requests the map; empty for maps that every bake writes."""
    label: str = ""
    description: str = ""
    """Label and tooltip of the switch."""

    def encoded(self, values):
        """The values as the file stores them."""
        return values if (self.scale, self.offset) == (1.0, 0.0) else values * self.scale + self.offset


MAP_KINDS = (
    MapKind("height", channels=1, is_half=False),
    MapKind(
        "normal",
        channels=3,
        is_half=True,
        scale=0.5,
        offset=0.5,
        setting="write_normals",
        label="Normal Maps",
        description="Also write tangent-space normal maps of the snow",
    ),
    MapKind(
        "wet",
        channels=1,
        is_half=True,
        setting="wet",
        label="Wet Ground",
        description="Follow melted snow and rain as water that soaks in, runs down, drips and dries, and write its map",
    ),
    MapKind(
        "points",
        channels=0,
        is_half=False,
        ending="ply",
        setting="points",
        label="Flying Snow",
        description="Also write the snow in the air as a point cloud: what slides off, falls from boughs or is thrown "
        "by ploughs, with its velocity and volume",
    ),
)
BY_NAME = {kind.name: kind for kind in MAP_KINDS}
ON_REQUEST = tuple(kind for kind in MAP_KINDS if kind.setting)
