# SPDX-License-Identifier: GPL-3.0-or-later
"""Small production shots: each is a script of a few lines whose right answer is computed by hand.

Unless a test says otherwise, 0.1 m of snow falls straight down in frames 1 to 4, a quarter of it in each frame.
"""

import bpy
import numpy as np
import pytest
import snow_scene as s
from small_shots import QUARTER, quarters, straighten
from surface_scene import bake_surfaces, box, level, points_at

# -- mirrored receivers -----------------------------------------------------------------------------------------


def mirrored_itself(obj):
    obj.scale = (1.0, 1.0, -1.0)
    return obj


def mirrored_by_parent(obj):
    """The parent shears it, too."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, obj.rotation_euler = (-1.0, 1.0, 1.5), (0.0, 0.0, 0.4)
    obj.parent = parent
    return obj


def mirrored_by_instancer(obj):
    empty = s.instanced(obj)
    empty.scale = (1.0, -1.0, 1.0)
    return empty


def upward_share(surface):
    """Share of the faces on level snow whose outside faces up, as renderers see it: a mirroring matrix turns the order
    of corners around."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = evaluated.matrix_world
    sign = -1.0 if matrix.determinant() < 0 else 1.0
    places = [matrix @ vertex.co for vertex in evaluated.data.vertices]
    up = []
    for polygon in evaluated.data.polygons:
        a, b, c = (places[index] for index in list(polygon.vertices)[:3])
        if max(abs(a.x), abs(a.y)) < 0.5:
            up.append(sign * (b - a).cross(c - a).z > 0)
    return np.mean(up)


@pytest.mark.parametrize("mirror", [mirrored_itself, mirrored_by_parent, mirrored_by_instancer])
def test_the_faces_of_a_mirrored_receivers_surface_look_outwards(tmp_path, mirror):
    obj = mirror(box("Thing", 2.0, z=-1.0))
    receiver = obj if obj.type == "MESH" else obj.instance_collection.objects[0]
    s.receive(obj)
    s.settings(tmp_path / "cache")
    bpy.context.view_layer.update()
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    surface = bpy.data.objects[f"{receiver.name} Snow"]
    bpy.context.scene.frame_set(4)
    assert upward_share(surface) == 1.0
    bpy.ops.snowbough.apply_snow()
    assert upward_share(bpy.data.objects[f"{surface.name} 0004"]) == 1.0


# -- what frame handlers change ---------------------------------------------------------------------------------


def hole(name="Hole"):
    """A material whose alpha comes from an image that is transparent everywhere."""
    image = bpy.data.images.new(name, 4, 4, alpha=True)
    image.pixels[:] = [0.0] * 64
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    links.new(texture.outputs["Alpha"], nodes["Principled BSDF"].inputs["Alpha"])
    return material


def switch_mask(roof):
    roof.vertex_groups.new(name="None")
    modifier = roof.modifiers.new("Switched", "MASK")
    modifier.vertex_group, modifier.show_render = "None", False
    return lambda is_open: setattr(bpy.data.objects["Roof"].modifiers["Switched"], "show_render", is_open)


def switch_displacement(roof):
    """The modifier moves the roof away; it keeps its faces."""
    modifier = roof.modifiers.new("Switched", "DISPLACE")
    modifier.direction, modifier.strength, modifier.mid_level, modifier.show_render = "X", 5.0, 0.0, False
    return lambda is_open: setattr(bpy.data.objects["Roof"].modifiers["Switched"], "show_render", is_open)


def switch_slot(roof):
    roof.data.materials.append(bpy.data.materials.new("Whole"))
    hole()
    return lambda is_open: setattr(
        bpy.data.objects["Roof"].material_slots[0],
        "material",
        bpy.data.materials["Hole" if is_open else "Whole"],
    )


def switch_slot_of_an_object(roof):
    """The same on a roof with modifiers, which is read on every frame."""
    roof.modifiers.new("Thick", "SUBSURF").subdivision_type = "SIMPLE"
    return switch_slot(roof)


def switch_image(roof):
    roof.data.materials.append(hole())
    bpy.data.images.new("Whole", 4, 4, alpha=True).pixels[:] = [1.0] * 64
    return lambda is_open: setattr(
        bpy.data.materials["Hole"].node_tree.nodes["Image Texture"],
        "image",
        bpy.data.images["Hole" if is_open else "Whole"],
    )


def switch_faces_material(roof):
    roof.data.materials.append(bpy.data.materials.new("Whole"))
    roof.data.materials.append(hole())

    def switch(is_open):
        bpy.data.meshes["Roof"].polygons[0].material_index = int(is_open)
        bpy.data.meshes["Roof"].update()

    return switch


SWITCHES = [
    switch_mask, switch_displacement, switch_slot, switch_slot_of_an_object, switch_image, switch_faces_material
]  # fmt: skip


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("switch", SWITCHES)
def test_a_roof_that_a_handler_opens_lets_snow_fall_through(tmp_path, ground_of, switch):
    """It is open in frames 2 and 3."""
    set_open = switch(s.square("Roof", z=1.0))
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    bpy.app.handlers.frame_change_pre.append(lambda scene, *_: set_open(scene.frame_current in (2, 3)))
    s.bake()
    assert ground_of() == quarters(0, 1, 2, 2)


@pytest.mark.usefixtures("handlers")
def test_a_roof_stays_closed_when_a_handler_reorders_its_vertices(tmp_path, ground_of):
    """With the old faces and the new order, the two halves of the roof would be two crossed ribbons."""
    points = [
        (x, y, 1.0) for left in (-1, 0) for x, y in ((left, -1), (left + 1, -1), (left + 1, 1), (left, 1))
    ]
    roof = s.mesh_object("Roof", points, [(0, 1, 2, 3), (4, 5, 6, 7)])
    roof.data["number"] = 0.0
    roof.data.keyframe_insert('["number"]', frame=1)
    order = [0, 2, 4, 6, 1, 3, 5, 7]

    def reorder(scene, *_):
        mesh = bpy.data.meshes["Roof"]
        if scene.frame_current == 3:
            mesh.vertices.foreach_set("co", np.array([points[index] for index in order], np.float32).ravel())
            mesh.loops.foreach_set("vertex_index", [order.index(corner) for corner in range(8)])
            mesh.update(calc_edges=True)

    bpy.app.handlers.frame_change_pre.append(reorder)
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache")
    s.bake()
    assert ground_of() == quarters(0, 0, 0, 0)


# -- ways to move and to deform ---------------------------------------------------------------------------------

# Each moves a level square of 2 m and returns {frame: its height}.


def sheared(cart):
    """A parent that is scaled unevenly and turned shears a square that stays level."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, cart.rotation_euler = (2.0, 0.5, 1.0), (0.0, 0.0, 0.6)
    cart.parent = parent
    s.key(parent, "location", (1, (0.0, 0.0, 0.0)), (4, (0.0, 0.0, 0.9)))
    return {1: 0.0, 4: 0.9}


def by_shape_key(cart):
    cart.shape_key_add(name="Basis")
    up = cart.shape_key_add(name="Up")
    for vertex in up.data:
        vertex.co.z += 0.5
    s.key(up, "value", (1, 0.0), (4, 1.0))
    return {1: 0.0, 4: 0.5}


def lifted_by_a_bone(cart):
    """An armature whose only bone, which points up, moves all of an object."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Bone")
    bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    cart.vertex_groups.new(name="Bone").add(range(4), 1.0, "REPLACE")
    cart.modifiers.new("Armature", "ARMATURE").object = rig
    return rig


def by_a_driven_bone(cart):
    """A driver lifts the only bone by a tenth of the frame."""
    bone = lifted_by_a_bone(cart).pose.bones["Bone"]
    bone.driver_add("location", 1).driver.expression = "frame / 10"
    return {1: 0.1, 4: 0.4}


def by_a_path(cart):
    """The path rises by 3 m in 3 frames."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions, curve.use_path, curve.path_duration = "3D", True, 100
    line = curve.splines.new("POLY")
    line.points.add(1)
    line.points[0].co, line.points[1].co = (0.0, 0.0, 0.0, 1.0), (3.0, 0.0, 3.0, 1.0)
    path = bpy.data.objects.new("Path", curve)
    bpy.context.scene.collection.objects.link(path)
    follow = cart.constraints.new("FOLLOW_PATH")
    follow.target, follow.use_fixed_location = path, True
    s.key(follow, "offset_factor", (1, 0.0), (4, 1.0))
    return {1: 0.0, 4: 3.0}


def by_geometry_nodes(cart):
    """Set Position lifts it by 0.3 m; the faces stay."""
    tree, begin, end = s.node_tree()
    lift = tree.nodes.new("GeometryNodeSetPosition")
    lift.inputs["Offset"].default_value = (0.0, 0.0, 0.3)
    tree.links.new(begin.outputs[0], lift.inputs["Geometry"])
    tree.links.new(lift.outputs[0], end.inputs[0])
    cart.modifiers.new("Nodes", "NODES").node_group = tree
    return {1: 0.3, 4: 0.3}


WAYS = [sheared, by_shape_key, by_a_driven_bone, by_a_path, by_geometry_nodes]


@pytest.mark.parametrize("way", WAYS)
def test_snow_follows_its_receiver(tmp_path, way):
    cart = s.square("Cart")
    heights = way(cart)
    (surface,) = bake_surfaces(tmp_path, cart)
    for (
        frame,
        height,
    ) in heights.items():  # within a third of a frame's snow: it is lower near the sheared corners
        assert level(points_at(surface, frame)) == pytest.approx(height + QUARTER * frame, abs=QUARTER / 3)


def test_snow_follows_a_collection_that_an_empty_instances(tmp_path):
    cart = s.square("Cart")
    empty = s.instanced(cart)
    s.key(empty, "location", (1, (0.0, 0.0, 0.0)), (4, (0.0, 6.0, 1.2)))
    s.receive(empty)
    s.settings(tmp_path)
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    s.bake()
    points = points_at(bpy.data.objects["Cart Snow"], 4)
    assert level(points) == pytest.approx(1.3, abs=0.004) and points[:, 1].mean() == pytest.approx(
        6.0, abs=0.05
    )


def test_snow_follows_a_linked_and_overridden_object(tmp_path):
    s.write_library(tmp_path / "props.blend", "Rock")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    override = s.link(tmp_path / "props.blend", "Rock").override_create(remap_local_usages=True)
    override.location.z = 2.0
    (surface,) = bake_surfaces(tmp_path / "cache", override)
    assert level(points_at(surface, 4)) == pytest.approx(2.1, abs=0.004)


def test_snow_follows_a_linked_and_overridden_character(tmp_path):
    """The shot poses the bone of the override: 0 to 0.9 m in frames 1 to 4."""
    body = s.square("Body")
    rig = lifted_by_a_bone(body)
    hero = bpy.data.collections.new("Hero")
    for obj in (body, rig):
        hero.objects.link(obj)
    bpy.data.libraries.write(str(tmp_path / "hero.blend"), {hero})
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    with bpy.data.libraries.load(str(tmp_path / "hero.blend"), link=True, relative=True) as (_, linked):
        linked.collections = ["Hero"]
    bpy.context.scene.collection.children.link(linked.collections[0])
    linked.collections[0].override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    own = {obj.name.split(".")[0]: obj for obj in bpy.context.scene.objects if obj.override_library}
    if linked.collections[0].name in bpy.context.scene.collection.children:
        bpy.context.scene.collection.children.unlink(linked.collections[0])
    own["Rig"].override_library.is_system_override = False  # Blender 4.2 keys no others
    bone = own["Rig"].pose.bones["Bone"]
    s.key(bone, "location", (1, (0.0, 0.0, 0.0)), (4, (0.0, 0.9, 0.0)))
    (surface,) = bake_surfaces(tmp_path / "cache", own["Body"])
    for frame, height in ((1, 0.0), (4, 0.9)):
        assert level(points_at(surface, frame)) == pytest.approx(height + QUARTER * frame, abs=0.004)


def test_a_shot_of_frames_1001_to_1100(tmp_path, native):
    """It moves by 99 m, and gets a millimetre of snow a frame."""
    cart = s.square("Cart")
    s.key(cart, "location", (1001, (0.0, 0.0, 0.0)), (1100, (99.0, 0.0, 0.0)))
    straighten(cart)
    (surface,) = bake_surfaces(tmp_path, cart, frames=(1001, 1100))
    for number in (1, 50, 100):
        depth = 0.001 * number
        assert s.open_ground(s.height(native, tmp_path, "Cart", 1000 + number)) == pytest.approx(
            depth, rel=0.01
        )
        points = points_at(surface, 1000 + number)
        assert level(points) == pytest.approx(depth, abs=0.002)
        assert points[:, 0].mean() == pytest.approx(number - 1, abs=0.05)


def test_a_shot_whose_keys_begin_before_frame_0(tmp_path):
    """It rises by 0.1 m a frame from frame -10 on; the shot begins at frame 0."""
    cart = s.square("Cart")
    s.key(cart, "location", (-10, (0.0, 0.0, 0.0)), (10, (0.0, 0.0, 2.0)))
    straighten(cart)
    (surface,) = bake_surfaces(tmp_path, cart, frames=(0, 4))
    for frame in (0, 4):
        expected = 1.0 + 0.1 * frame + 0.02 * (frame + 1)
        assert level(points_at(surface, frame)) == pytest.approx(expected, abs=0.002)


@pytest.mark.parametrize("unit", [0.01, 10.0])
def test_depth_is_in_metres_whatever_a_unit_is(tmp_path, unit):
    """A square of 2 m."""
    bpy.context.scene.unit_settings.scale_length = unit
    (surface,) = bake_surfaces(tmp_path, s.square("Ground", 2.0 / unit))
    assert level(points_at(surface, 4)) * unit == pytest.approx(0.1, rel=0.03)
