# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives baked snow its thickness: in the material, with modifiers, or as a separate surface.

ADAPTIVE  Cycles displaces the surface in the material and dices it to pixels.
MODIFIER  Subdivision and Displace modifiers make geometry for every renderer and the viewport.
SHELL     A snow surface, a separate object (see snow_surface). The receiver stays unchanged, except where it gets wet.
NONE      Only the material shows snow.
"""

import math

import bpy

from ..base import compat
from ..base.names import DISPLACE_MODIFIER, OWN_MODIFIERS, SUBDIVISION_MODIFIER, SURFACE_MODIFIER
from ..scene.pose import metres_per_unit
from . import baked_images, original_state, snow_material, snow_surface

SCALE_TOLERANCE = 1e-3
MAX_FACES = 500_000
MAX_LEVEL = 11
# The mode of objects for which the user has not chosen one.
DEFAULT_MODE = "SHELL"

MODES = (
    (
        "ADAPTIVE",
        "Cycles Displacement",
        "The material displaces; Cycles subdivides the mesh to the size of a pixel",
    ),
    (
        "MODIFIER",
        "Modifiers",
        "Subdivision and Displace modifiers make geometry for every renderer. The object needs a uniform scale",
    ),
    (
        "SHELL",
        "Snow Surface",
        "A separate mesh with its own material, hems and overhangs. It also works for linked and instanced meshes",
    ),
    ("NONE", "None", "The snow changes only the material"),
)


def uniform_scale(obj):
    """The object's world scale if it is equal along all axes and not mirrored, else None."""
    scale = obj.matrix_world.to_scale()
    if min(scale) <= 0.0 or max(scale) > min(scale) * (1.0 + SCALE_TOLERANCE):
        return None
    return sum(scale) / 3.0


def _subdivision_levels(obj, size):
    """Levels of simple subdivision that give the object about one face per four texels of a map `size` wide."""
    wanted = min(size * size / 4.0, MAX_FACES) / max(len(obj.data.polygons), 1)
    return min(MAX_LEVEL, math.floor(math.log(max(wanted, 1.0), 4.0) + 0.5))


def _texture(obj, sequence):
    texture = bpy.data.textures.new(f"{obj.name} snow height", "IMAGE")
    texture.image = sequence.image
    texture.extension = "EXTEND"
    texture.use_clamp = False
    sequence.configure(texture.image_user)
    return texture


def _add_modifiers(scene, receiver):
    obj = receiver.object
    scale = uniform_scale(obj)
    sequence = baked_images.load_sequence(receiver.folder, "height")
    subdivision = obj.modifiers.new(SUBDIVISION_MODIFIER, "SUBSURF")
    subdivision.subdivision_type = "SIMPLE"
    if sequence is not None:
        subdivision.render_levels = _subdivision_levels(obj, sequence.size)
    else:  # not baked yet
        subdivision.render_levels = 0
    subdivision.levels = max(0, subdivision.render_levels - 1)
    if sequence is None:
        return
    displace = obj.modifiers.new(DISPLACE_MODIFIER, "DISPLACE")
    displace.texture = _texture(obj, sequence)
    displace.texture_coords = "UV"
    displace.uv_layer = snow_material.uv_map_name(receiver)
    displace.mid_level = 0.0
    displace.strength = 1.0 / (scale * metres_per_unit(scene))
    displace.direction = "NORMAL"


def _add_adaptive(scene, receiver):
    obj = receiver.object
    feature_set = compat.cycles_feature_set(scene)
    subdivision = obj.modifiers.new(SUBDIVISION_MODIFIER, "SUBSURF")
    subdivision.subdivision_type = "SIMPLE"
    subdivision.levels = 0
    subdivision.render_levels = 1
    if not compat.set_adaptive_subdivision(scene, obj, subdivision, True):
        obj.modifiers.remove(subdivision)
        raise ValueError("Cycles is disabled in the preferences: enable its add-on or choose Modifiers")
    return feature_set


def _remove_modifiers(scene, receiver, record):
    obj = receiver.object
    if obj is None or obj.type != "MESH":
        return
    subdivision = obj.modifiers.get(SUBDIVISION_MODIFIER)
    if subdivision is not None and record.get("displacement") == "ADAPTIVE":
        compat.set_adaptive_subdivision(scene, obj, subdivision, False)
        others = any(
            original_state.read(other).get("displacement") == "ADAPTIVE"
            for other in scene.snowbough.receivers
            if other != receiver
        )
        if record.get("feature_set") and not others:
            scene.cycles.feature_set = record["feature_set"]
    displace = obj.modifiers.get(DISPLACE_MODIFIER)
    if displace is not None:
        texture = displace.texture
        obj.modifiers.remove(displace)
        if texture is not None and texture.users == 0:
            bpy.data.textures.remove(texture)
    if subdivision is not None:
        obj.modifiers.remove(subdivision)


def clear(scene, receiver):
    """Removes what apply() added, except the materials."""
    record = original_state.read(receiver)
    _remove_modifiers(scene, receiver, record)
    snow_surface.remove(receiver)
    record = original_state.read(receiver)
    for key in ("displacement", "feature_set"):
        record.pop(key, None)
    original_state.write(receiver, record)


def apply(scene, receiver, mode):
    """Adds snow of that mode to the receiver and replaces the snow of earlier calls. Materials of surfaces keep their
    sliders.

    Raises ValueError, saying what to do, if the mode does not suit the object; then nothing is changed.
    """
    obj = receiver.object
    if mode == "MODIFIER" and uniform_scale(obj) is None:
        raise ValueError(
            f"{obj.name} has a different scale along its axes, which would distort the snow: apply the scale (Ctrl+A) "
            "or choose the snow surface"
        )
    if mode != "SHELL" and snow_material.is_shared(obj):
        raise ValueError(
            f"{obj.name} is linked or instanced, and such objects are never changed: choose the snow surface"
        )
    materials = snow_surface.touched_materials(receiver)
    clear(scene, receiver)
    record_update = {"displacement": mode}
    if mode == "SHELL":
        snow_material.remove(receiver)
        snow_surface.make(scene, receiver, materials)
        if not snow_material.is_shared(obj) and snow_material.has_wet_maps(receiver):
            snow_material.add(scene, receiver, displace=False, only_wet=True)
    else:
        snow_material.add(scene, receiver, displace=mode == "ADAPTIVE")
        if mode == "MODIFIER":
            _add_modifiers(scene, receiver)
        elif mode == "ADAPTIVE":
            record_update["feature_set"] = _add_adaptive(scene, receiver)
    record = original_state.read(receiver)
    record.update(record_update)
    original_state.write(receiver, record)


def mode_of(receiver):
    """The current mode of the receiver's snow, or None."""
    return original_state.read(receiver).get("displacement")


def refresh(scene, receiver):
    """After a bake: shows the new files on a receiver that already has snow."""
    mode = mode_of(receiver)
    if mode is not None:
        apply(scene, receiver, mode)


def remove(scene, receiver):
    """Restores the object as it was before snow was added."""
    clear(scene, receiver)
    snow_material.remove(receiver)


def require_frames(scene):
    """Raises ValueError if Render > Time Stretching is on and a receiver shows maps in its material or by modifiers:
    Blender then takes the images of other frames, in EEVEE and for modifiers, but not in Cycles."""
    names = [
        f"'{entry.object.name}'"
        for entry in scene.snowbough.receivers
        if entry.object is not None and entry.enabled and mode_of(entry) not in (None, "SHELL")
    ]
    if names and compat.frame_length(scene) != 1.0:
        raise ValueError(
            f"Time Stretching (Output properties, Frame Range) is on, and Blender does not show image sequences by it: "
            f"choose Displacement > Snow Surface for {', '.join(names)}, or set Old and New to the same number"
        )


class Muted:
    """A context that disables our own displacement, so that snow does not fall on displaced snow, and the modifiers of
    surfaces, so that they read no files.

    switch: "show_render" for render evaluation, "show_viewport" for what the viewport shows.
    """

    def __init__(self, scene, switch="show_render"):
        self._switch = switch
        self._modifiers = [
            (obj.name, modifier.name, getattr(modifier, switch))
            for obj in scene.objects
            for modifier in getattr(obj, "modifiers", ())
            if modifier.name in (*OWN_MODIFIERS, SURFACE_MODIFIER)
        ]

    def _set(self, value_of):
        for obj, name, shown in self._modifiers:
            modifier = bpy.data.objects[obj].modifiers.get(name) if obj in bpy.data.objects else None
            if modifier is not None:
                setattr(modifier, self._switch, value_of(shown))

    def __enter__(self):
        self._set(lambda shown: False)
        return self

    def __exit__(self, *_exception):
        self._set(lambda shown: shown)
