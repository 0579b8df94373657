# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves occlude and gather snow by their alpha: from a material's nodes to the baked map."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import snow_scene as s

# 4 x 4 texels, row 0 = v 0: the middle four are a hole.
RING = np.pad(np.zeros((2, 2)), 1, constant_values=1.0)


def image(name="leaf", alpha=RING, color=None, path=None):
    """An image of one colour (or with `color` in all channels) and an alpha, packed or saved to `path`."""
    height, width = alpha.shape
    made = bpy.data.images.new(name, width, height, alpha=True)
    pixels = np.full((height, width, 4), 0.5, np.float32)
    if color is not None:
        pixels[..., :3] = color[..., None]
    pixels[..., 3] = alpha
    made.pixels.foreach_set(pixels.reshape(-1))
    made.update()
    if path is None:
        made.pack()
    else:
        made.filepath_raw, made.file_format = str(path), "PNG"
        made.save()
    return made


def material(picture, output="Alpha", name="Leaf"):
    """A Principled material whose alpha is the image's; returns (material, texture node, BSDF node)."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = picture
    surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    if output:
        tree.links.new(texture.outputs[output], surface.inputs["Alpha"])
    return made, texture, surface


def leaf_over_ground(tmp_path, leaf_material, receives=False):
    """A card of 1 m, 0.5 m above a ground of 2 m."""
    ground, leaf = s.square("Ground", 2.0), s.square("Leaf", 1.0, z=0.5)
    if leaf_material is not None:
        leaf.data.materials.append(leaf_material)
    s.receive(ground, *([leaf] if receives else []))
    s.settings(tmp_path, (1, 2))
    return ground, leaf


def is_ring(ground):
    """Whether a map of the ground shows the shadow of the card with the hole."""
    hole = s.texel(ground, 0.5, 0.5) == pytest.approx(0.1, rel=0.05)
    edges = [s.texel(ground, u, v) for u, v in ((0.31, 0.5), (0.69, 0.5), (0.5, 0.31), (0.5, 0.69))]
    return hole and max(edges) < 0.01 and s.texel(ground, 0.1, 0.1) > 0.09


def is_full_shadow(ground):
    return s.texel(ground, 0.5, 0.5) == 0 and s.texel(ground, 0.1, 0.1) > 0.09


def bake_ground(native, tmp_path):
    s.bake()
    return s.height(native, tmp_path, "Ground", 2)


def test_snow_falls_through_the_holes_of_a_leaf(native, tmp_path):
    leaf_over_ground(tmp_path, material(image())[0])
    assert is_ring(bake_ground(native, tmp_path))


def test_a_leaf_gathers_snow_only_where_it_is_there(native, tmp_path):
    leaf_over_ground(tmp_path, material(image())[0], receives=True)
    assert is_ring(bake_ground(native, tmp_path))
    leaf = s.height(native, tmp_path, "Leaf", 2)
    assert s.texel(leaf, 0.5, 0.5) == 0 and s.texel(leaf, 0.12, 0.5) == pytest.approx(0.1, rel=0.1)
    frames = [s.manifest_of(tmp_path, name)["frames"][-1] for name in ("Ground", "Leaf")]
    assert [frame["volume"] for frame in frames] == pytest.approx([0.1 * 3.25, 0.1 * 0.75], rel=0.02)


def test_an_imported_map_d_cuts_leaves_out(native, tmp_path):
    image(path=tmp_path / "mask.png")  # Blender's importer takes the file's alpha channel
    (tmp_path / "leaf.mtl").write_text("newmtl Leaf\nKd 0.1 0.4 0.1\nmap_d mask.png\n")
    (tmp_path / "leaf.obj").write_text(
        "mtllib leaf.mtl\no Card\nv -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl Leaf\nf 1/1 2/2 3/3 4/4\n"
    )
    bpy.ops.wm.obj_import(filepath=str(tmp_path / "leaf.obj"), forward_axis="Y", up_axis="Z")
    s.receive(s.square("Ground", 2.0))
    s.settings(tmp_path / "cache", (1, 2))
    s.bake()
    assert is_ring(s.height(native, tmp_path / "cache", "Ground", 2))


@pytest.mark.parametrize(
    "transmission", [(1.0, 1.0, 1.0), (0.4, 0.8, 0.2)], ids=["opaque", "lets light through"]
)
def test_our_own_leaves_cut_by_their_texture(addon, native, tmp_path, transmission):
    image(path=tmp_path / "leaf.png")
    texture = SimpleNamespace(path=str(tmp_path / "leaf.png"), scale=(1.0, 1.0), offset=(0.0, 0.0))
    none = SimpleNamespace(path="", scale=(1.0, 1.0), offset=(0.0, 0.0))
    source = SimpleNamespace(
        name="Birch", defined=True, diffuse=(0.1, 0.4, 0.1), opacity=1.0, transmission=transmission,
        bump_strength=1.0, diffuse_texture=texture, alpha_texture=texture, specular_texture=none,
        bump_texture=none, normal_texture=none,
    )  # fmt: skip
    leaf_material = addon("tree.materials").leaf_material(source)
    _, leaf = leaf_over_ground(tmp_path / "cache", leaf_material)
    leaf.data.uv_layers.new(name=addon("base.names").LEAF_UV)  # filled as Blender fills it: 0 to 1 a face
    s.bake()
    assert is_ring(s.height(native, tmp_path / "cache", "Ground", 2))


def test_snow_over_a_leafs_material_leaves_its_holes(native, tmp_path):
    _, leaf = leaf_over_ground(tmp_path, material(image())[0], receives=True)
    s.bake()
    bpy.ops.snowbough.setup_material()
    assert leaf.material_slots[0].link == "OBJECT"
    s.bake()
    for name in ("Ground", "Leaf"):
        first, second = (s.folder_of(tmp_path, name, version) for version in (1, 2))
        assert (first / "height_0002.exr").read_bytes() == (second / "height_0002.exr").read_bytes()


def mixed_with_transparent(tree, texture, surface):
    """Mix of Transparent (where the factor is 0) and the surface."""
    mix, clear = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(texture.outputs["Alpha"], mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(surface.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("ALL").inputs["Surface"])


def inverted_mask(tree, texture, surface):
    """1 - (alpha < 0.5), through a reroute: what glTF's MASK looks like."""
    less, invert = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    less.operation, invert.operation = "LESS_THAN", "SUBTRACT"
    less.inputs[1].default_value, invert.inputs[0].default_value = 0.5, 1.0
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(texture.outputs["Alpha"], less.inputs[0])
    tree.links.new(less.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], invert.inputs[1])
    tree.links.new(invert.outputs[0], surface.inputs["Alpha"])


def inside_a_group(tree, texture, surface):
    """The alpha passes through a node group unchanged."""
    group = bpy.data.node_groups.new("Mask", "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketFloat")
        group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketFloat")
    else:
        group.inputs.new("NodeSocketFloat", "In")
        group.outputs.new("NodeSocketFloat", "Out")
    begin, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(begin.outputs[0], end.inputs[0])
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    tree.links.new(texture.outputs["Alpha"], node.inputs[0])
    tree.links.new(node.outputs[0], surface.inputs["Alpha"])


def red_channel(tree, texture, surface):
    separate = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(texture.outputs["Color"], separate.inputs[0])
    tree.links.new(separate.outputs[0], surface.inputs["Alpha"])


def turned_about_the_middle(tree, texture, surface):
    """Half a turn and a shift by whole images: the ring is the same again."""
    uv, mapping = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeMapping")
    uv.uv_map = "snow"
    mapping.inputs["Rotation"].default_value[2] = np.pi
    mapping.inputs["Location"].default_value = (3.0, -1.0, 0.0)
    tree.links.new(uv.outputs[0], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Alpha"], surface.inputs["Alpha"])


@pytest.mark.parametrize(
    "wire", [mixed_with_transparent, inverted_mask, inside_a_group, red_channel, turned_about_the_middle]
)
def test_the_nodes_that_importers_make_are_followed(native, tmp_path, wire):
    made, texture, surface = material(image(color=RING), output=None)
    wire(made.node_tree, texture, surface)
    leaf_over_ground(tmp_path, made)
    assert is_ring(bake_ground(native, tmp_path))


def test_each_face_shows_its_own_material(native, tmp_path):
    leaf_over_ground(tmp_path, bpy.data.materials.new("Wood"))
    clear = s.square("Clear", 1.0, z=0.25)
    clear.data.materials.append(bpy.data.materials["Wood"])
    clear.data.materials.append(material(image(alpha=np.zeros((2, 2))))[0])
    clear.data.polygons[0].material_index = 1
    bpy.data.objects.remove(bpy.data.objects["Leaf"])
    assert s.texel(bake_ground(native, tmp_path), 0.5, 0.5) == pytest.approx(0.1, rel=0.05)


def test_instances_have_their_holes(native, tmp_path):
    _, leaf = leaf_over_ground(tmp_path, material(image())[0])
    collection = bpy.data.collections.new("Leaves")
    collection.objects.link(leaf)
    bpy.context.scene.collection.objects.unlink(leaf)
    empty = bpy.data.objects.new("Empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    assert is_ring(bake_ground(native, tmp_path))


def test_large_images_are_averaged_and_keep_their_holes(addon, native, tmp_path):
    large = np.kron(RING, np.ones((375, 375)))
    made, _, _ = material(image(alpha=large))
    found = addon("scene.material_alpha").of_material(made)
    assert found.pixels.shape == (1024, 1024)
    leaf_over_ground(tmp_path, made)
    assert is_ring(bake_ground(native, tmp_path))


def test_an_opaque_image_changes_no_byte(tmp_path):
    leaf_over_ground(tmp_path / "plain", None)
    s.bake()
    bpy.data.objects["Leaf"].data.materials.append(material(image(alpha=np.full((4, 4), 0.6)))[0])
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "opaque")
    s.bake()
    assert s.files_of(tmp_path / "plain") == s.files_of(tmp_path / "opaque")


def test_equal_bakes_of_leaves_are_equal_bytes_and_resume_to_them(addon, tmp_path):
    leaf_over_ground(tmp_path / "whole", material(image())[0], receives=True)
    s.settings(tmp_path / "whole", (1, 6), noise_density=0.5, checkpoint_interval=2)
    s.bake()
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "parts")
    for names in (["Ground"], ["Leaf"]):
        assert s.bake_part(addon, 1, 3, names).error is None
    s.bake(resume=True)
    assert s.files_of(tmp_path / "parts") == s.files_of(tmp_path / "whole")


def test_a_changed_alpha_image_is_named(addon, tmp_path):
    picture = image()
    leaf_over_ground(tmp_path, material(picture)[0])
    s.bake()
    s.bake(resume=True)
    changes, scene = addon("bake.changes_since_bake"), bpy.context.scene
    scene.frame_set(2)
    assert changes.scene_changes(scene, bpy.context.evaluated_depsgraph_get()) == []
    picture.pixels.foreach_set(np.ones(64, np.float32))
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[0, 0, 3] = 0.0
    picture.pixels.foreach_set(pixels.reshape(-1))
    assert changes.scene_changes(scene, bpy.context.evaluated_depsgraph_get()) == [
        "Leaf: alpha image changed at frame 2"
    ]
    with pytest.raises(RuntimeError, match=r"\(Leaf: alpha image changed at frame 1\)"):
        s.bake(resume=True)


# -- unsupported node trees: opaque, with a warning ----------------------------------------------------


def missing(tree, texture, surface):
    texture.image = bpy.data.images.new("gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "//nowhere/gone.png"
    tree.links.new(texture.outputs["Alpha"], surface.inputs["Alpha"])


def procedural(tree, texture, surface):
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], surface.inputs["Alpha"])


def generated_coordinates(tree, texture, surface):
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Alpha"], surface.inputs["Alpha"])


def lost_uv_map(tree, texture, surface):
    uv = tree.nodes.new("ShaderNodeUVMap")
    uv.uv_map = "lost"
    tree.links.new(uv.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Alpha"], surface.inputs["Alpha"])


@pytest.mark.parametrize(
    "wire, reason",
    [
        (missing, "its alpha image 'gone' is missing"),
        (procedural, "cannot be followed to an image"),
        (generated_coordinates, "not from a UV map"),
        (lost_uv_map, "'Leaf' has no UV map 'lost'"),
    ],
)
def test_what_cannot_be_followed_is_opaque_and_told_before(addon, native, tmp_path, wire, reason):
    made, texture, surface = material(image(), output=None)
    wire(made.node_tree, texture, surface)
    leaf_over_ground(tmp_path, made)
    texts = s.warnings(addon)
    assert len(texts) == 1 and "treats the material 'Leaf' as opaque" in texts[0] and reason in texts[0]
    assert is_full_shadow(bake_ground(native, tmp_path))


def test_each_object_without_uvs_for_the_image_is_named(addon, native, tmp_path):
    made, _, _ = material(image())
    leaf_over_ground(tmp_path, made)
    for name in ("Bare", "Bald"):
        card = s.square(name, 0.2, z=0.25)
        card.data.uv_layers.remove(card.data.uv_layers[0])
        card.data.materials.append(made)
    texts = s.warnings(addon)
    assert [name in text for name, text in zip(("Bare", "Bald"), texts)] == [True, True] and len(texts) == 2
    assert s.texel(bake_ground(native, tmp_path), 0.5, 0.5) == 0


def test_a_leaf_that_can_be_followed_gives_no_warning(addon, tmp_path):
    leaf_over_ground(tmp_path, material(image())[0])
    assert s.warnings(addon) == []


# -- an imported tree ---------------------------------------------------------------------------------


@pytest.mark.parametrize("there", [0.0, 1.0])
def test_the_leaves_of_an_imported_tree_gather_by_their_texture(tmp_path, there):
    import test_import  # its tree with one leaf

    image(alpha=np.full((4, 4), there), path=tmp_path / "leaf.png")
    path = test_import._leafy(tmp_path, "leaf.png")
    bpy.ops.import_scene.xfrog_tree(filepath=str(path))
    tree = {obj.name: obj for obj in bpy.data.objects}
    tree["leafy_leaves"].rotation_euler.x = -0.8  # as the file has it, the leaf faces down
    s.receive(tree["leafy_leaves"], tree["leafy_bark"], resolution=256)
    s.settings(tmp_path / "cache", (1, 2), pixel_size=0.01)
    s.bake()
    volumes = {
        name: s.manifest_of(tmp_path / "cache", name)["frames"][-1]["volume"]
        for name in ("leafy_leaves", "leafy_bark")
    }
    assert volumes["leafy_bark"] > 0
    assert (volumes["leafy_leaves"] > 0) == (there == 1.0)
