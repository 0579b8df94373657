# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds snow to a receiver's materials, and removes it.

Each material of the object is copied for this receiver. The copy mixes the node group `Snowbough Snow` over the
original surface and is used in an OBJECT-linked slot. So the original material and the mesh's own slots stay unchanged
for their other users.
"""

from pathlib import Path

import bpy

from ..base import compat, compat_nodes
from ..base.map_kinds import BY_NAME, MAP_KINDS
from ..base.names import REST_ATTRIBUTE, SNOW_UV
from ..scene.libraries import library_name, stored_name
from ..scene.pose import metres_per_unit
from . import baked_images, look, original_state, rest_position, snow_nodes
from .snowfall import read_snowfall

FRAME_LABEL = "Snowbough"
# Distance between two rows of nodes.
ROW = 310


def uv_map_name(receiver):
    """The UV map that stores the snow: the receiver's choice, `snow`, or the active one."""
    if receiver.object.type != "MESH":  # an instanced collection: its meshes share the name
        return receiver.uv_map or SNOW_UV
    layers = receiver.object.data.uv_layers
    for name in (receiver.uv_map, SNOW_UV):
        if name and name in layers:
            return name
    return layers.active.name if layers.active else ""


def is_shared(obj):
    """Whether the object or mesh is linked, overridden or instanced: those are never changed and get a surface."""
    if obj.type != "MESH":
        return True
    return bool(obj.library or obj.override_library or obj.data.library or obj.data.users > 1)


# --------------------------------------------------------------------------------------------------
# Nodes in one material


class _Builder:
    """Makes nodes inside one labelled frame of a tree."""

    def __init__(self, tree):
        self.tree = tree
        self.frame = tree.nodes.new("NodeFrame")
        self.frame.label = FRAME_LABEL

    def node(self, kind, location):
        node = self.tree.nodes.new(kind)
        node.parent = self.frame
        node.location = location
        return node

    def link(self, output, input_):
        self.tree.links.new(output, input_)


def _sampled(builder, sequence, uv_map, location):
    """An image texture node that shows the sequence in the receiver's UV map."""
    uv = builder.node("ShaderNodeUVMap", (location[0] - 220, location[1]))
    uv.uv_map = uv_map
    texture = builder.node("ShaderNodeTexImage", location)
    texture.image = sequence.image
    texture.extension = "EXTEND"
    sequence.configure(texture.image_user)
    builder.link(uv.outputs[0], texture.inputs["Vector"])
    return texture.outputs["Color"]


def _number(builder, sequence, uv_map, y):
    """The number that the sequence stores, from its first frame on, and 0 before it.

    Before the first frame Blender has no file and would show magenta. A keyframed step, which artists can edit, hides
    the snow there.
    """
    if sequence is None:  # not baked yet: no snow
        value = builder.node("ShaderNodeValue", (-700, y))
        value.outputs[0].default_value = 0.0
        return value.outputs[0]
    begun = builder.node("ShaderNodeMath", (-420, y))
    begun.operation = "MULTIPLY"
    begun.label = "From the first baked frame on"
    step = ((sequence.first - 1, 0.0), (sequence.first, 1.0))
    compat_nodes.key_value(builder.tree, begun.inputs[1], step, "CONSTANT")
    builder.link(_sampled(builder, sequence, uv_map, (-700, y)), begun.inputs[0])
    return begun.outputs[0]


def _normal(builder, sequence, uv_map, y):
    if sequence is None:
        return builder.node("ShaderNodeNewGeometry", (-700, y)).outputs["Normal"]
    node = builder.node("ShaderNodeNormalMap", (-420, y))
    node.space = "TANGENT"
    node.uv_map = uv_map
    builder.link(_sampled(builder, sequence, uv_map, (-700, y)), node.inputs["Color"])
    return node.outputs[0]


def output_node(tree):
    """The active material output. Adds one if there is none."""
    node = tree.get_output_node("ALL") or tree.get_output_node("CYCLES") or tree.get_output_node("EEVEE")
    return node or tree.nodes.new("ShaderNodeOutputMaterial")


def _position(builder, scale, rest, y):
    """The position on the object in metres, undeformed if the object stores that."""
    if rest:
        node = builder.node("ShaderNodeAttribute", (-700, y))
        node.attribute_name = REST_ATTRIBUTE
        place = node.outputs["Vector"]
    else:
        place = builder.node("ShaderNodeTexCoord", (-700, y)).outputs["Object"]
    metres = builder.node("ShaderNodeVectorMath", (-420, y))
    metres.operation = "MULTIPLY"
    metres.inputs[1].default_value = scale
    builder.link(place, metres.inputs[0])
    return metres.outputs[0]


def add_snow_nodes(material, maps, uv_map, displacement_scale, metres, rest):
    """Mixes snow over the material.

    maps: {name of a kind of map: BakedSequence or None}. displacement_scale: Blender units per metre if the material
    displaces the surface (Cycles displacement), else None. metres: metres per unit of object space, for each axis.
    rest: whether the object stores its undeformed positions. Returns the node of the group.
    """
    tree = material.node_tree
    output = output_node(tree)
    surface = next(iter(output.inputs["Surface"].links), None)
    displaced = next(iter(output.inputs["Displacement"].links), None)
    surface = surface.from_socket if surface else None
    displaced = displaced.from_socket if displaced else None

    builder = _Builder(tree)
    group = builder.node("ShaderNodeGroup", (-160, 0))
    group.node_tree = snow_nodes.ensure_group()
    y = 0
    for name, sequence in maps.items():
        node = _normal if BY_NAME[name].channels == 3 else _number
        if name.capitalize() in group.inputs:
            builder.link(node(builder, sequence, uv_map, y), group.inputs[name.capitalize()])
            y -= ROW
    builder.link(_position(builder, metres, rest, y), group.inputs["Position"])
    if surface is not None:
        builder.link(surface, group.inputs["Shader"])
    builder.link(group.outputs["Shader"], output.inputs["Surface"])

    if displacement_scale is not None:
        node = builder.node("ShaderNodeDisplacement", (-160, -420))
        node.space = "WORLD"
        node.inputs["Midlevel"].default_value = 0.0
        node.inputs["Scale"].default_value = displacement_scale
        builder.link(group.outputs["Thickness"], node.inputs["Height"])
        result = node.outputs[0]
        if displaced is not None:
            both = builder.node("ShaderNodeVectorMath", (60, -420))
            both.operation = "ADD"
            builder.link(displaced, both.inputs[0])
            builder.link(result, both.inputs[1])
            result = both.outputs[0]
        builder.link(result, output.inputs["Displacement"])
        compat.set_displacement_method(material, "BOTH")
    builder.frame.location = (output.location.x - 200, output.location.y + 260)
    output.location.x += 420
    return group


# --------------------------------------------------------------------------------------------------
# A receiver's slots


def _plain_material(name, original):
    """A material with nodes that looks like `original`, which has none, or like Blender's default."""
    material = bpy.data.materials.new(name)
    compat.use_material_nodes(material)
    principled = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    if original is not None:
        principled.inputs["Base Color"].default_value = original.diffuse_color
        principled.inputs["Metallic"].default_value = original.metallic
        principled.inputs["Roughness"].default_value = original.roughness
    return material


def _snowy_copy(obj, original):
    name = f"{original.name if original else obj.name} snow"
    if original is None or original.node_tree is None or not original.use_nodes:
        return _plain_material(name, original)
    material = original.copy()
    material.name = name
    animation = material.node_tree.animation_data
    if animation is not None and animation.action is not None:
        animation.action = animation.action.copy()  # the copied material still shares its curves
    return material


def _record_elsewhere(receiver):
    """The record of the same object in another scene that has changed its materials; empty if there is none."""
    for scene in bpy.data.scenes:
        for other in scene.snowbough.receivers:
            record = original_state.read(other)
            if scene != receiver.id_data.original and other.object == receiver.object and "slots" in record:
                return record
    return {}


def _note_slots(receiver, record):
    """Records the object's slots, once, and keeps their materials from being lost. Adds a slot if there is none. If
    another scene has added snow to the object, its record is the one."""
    obj = receiver.object
    if "slots" in record:
        return
    shared = _record_elsewhere(receiver)
    if shared:
        record.update({name: shared[name] for name in ("slots", "added_slot", "copies") if name in shared})
        return
    record["added_slot"] = not obj.material_slots
    if record["added_slot"]:
        obj.data.materials.append(None)
    record["slots"] = []
    for slot in obj.material_slots:
        original = slot.material
        kept = original is not None and original.library is None and not original.use_fake_user
        if kept:
            original.use_fake_user = True
        record["slots"].append(
            {
                "link": slot.link,
                "material": original.name_full if original else None,
                "library": library_name(original) if original and original.library else None,
                "fake_user": kept,
            }
        )


def _find_material(entry):
    for material in bpy.data.materials:
        library = library_name(material) if material.library else None
        stored = None if entry["library"] is None else stored_name(entry["library"])
        if material.name_full == entry["material"] and library == stored:
            return material
    return None


def _drop_copies(obj, record):
    for name in record.pop("copies", []):
        material = bpy.data.materials.get(name)
        if material is not None and material.library is None:
            for slot in obj.material_slots:
                if slot.material == material:
                    slot.material = None
            if material.users == int(material.use_fake_user):
                animation = material.node_tree.animation_data
                action = animation.action if animation else None
                bpy.data.materials.remove(material)
                if action is not None and action.users == 0:
                    bpy.data.actions.remove(action)


def has_wet_maps(receiver):
    return baked_images.load_sequence(receiver.folder, "wet") is not None


def add(scene, receiver, displace, only_wet=False):
    """Adds snow to the receiver's materials, or updates it after a bake. displace: whether the material displaces.
    only_wet: show where it is wet, and no snow.

    Raises ValueError for objects without a UV map. The object must not be shared, see is_shared().
    """
    obj = receiver.object
    uv_map = uv_map_name(receiver)
    if not uv_map:
        raise ValueError(f"{obj.name} has no UV map: add one, or use Add Snow to Selected, which adds it")
    maps = {
        kind.name: baked_images.load_sequence(receiver.folder, kind.name)
        for kind in MAP_KINDS
        if kind.channels
    }
    if maps["wet"] is None:
        del maps["wet"]
    elif only_wet:
        maps = {"wet": maps["wet"]}
    scale = 1.0 / metres_per_unit(scene) if displace else None
    metres = [abs(axis) * metres_per_unit(scene) for axis in obj.matrix_world.to_scale()]
    snowfall = read_snowfall(bpy.path.abspath(receiver.folder))

    record = original_state.read(receiver)
    _note_slots(receiver, record)
    _drop_copies(obj, record)
    rest = rest_position.keep(obj, record)
    record["copies"] = []
    for slot, entry in zip(obj.material_slots, record["slots"]):
        material = _snowy_copy(obj, _find_material(entry) if entry["material"] else None)
        group = add_snow_nodes(material, maps, uv_map, scale, metres, rest)
        look.set_group_inputs(group, look.of(scene))
        group.inputs["Depth"].default_value = snowfall.depth
        group.inputs["Wind"].default_value = snowfall.wind
        slot.link = "OBJECT"
        slot.material = material
        record["copies"].append(material.name)
    original_state.write(receiver, record)


def foreign_scene(receiver):
    """The name of the other scene whose maps the material of a shared receiver shows; empty if it shows its own."""
    images = {
        Path(bpy.path.abspath(node.image.filepath)).parent
        for slot in (receiver.object.material_slots if receiver.object is not None else ())
        if slot.material is not None and look.group_nodes(slot.material)
        for node in slot.material.node_tree.nodes
        if node.type == "TEX_IMAGE"
        and node.image is not None
        and node.parent
        and node.parent.label == FRAME_LABEL
    }
    for scene in bpy.data.scenes:
        for entry in scene.snowbough.receivers:
            is_other = scene != receiver.id_data.original and entry.folder != receiver.folder
            if is_other and entry.object == receiver.object and entry.folder:
                if Path(bpy.path.abspath(entry.folder)) in images:
                    return scene.name
    return ""


def remove(receiver):
    """Restores the receiver's own materials and slots."""
    obj = receiver.object
    record = original_state.read(receiver)
    if "slots" not in record:
        return
    _drop_copies(obj, record)
    for slot, entry in zip(obj.material_slots, record.pop("slots")):
        original = _find_material(entry) if entry["material"] else None
        slot.link = "OBJECT"
        slot.material = None
        slot.link = entry["link"]
        if entry["link"] == "OBJECT":
            slot.material = original
        if original is not None and entry["fake_user"]:
            original.use_fake_user = False
    rest_position.release(record)
    if record.pop("added_slot"):
        obj.data.materials.clear()  # the only slot is ours; pop() would leave it on the object
    original_state.write(receiver, record)
