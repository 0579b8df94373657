# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the export on wood and leaves: bought textures where their maker put them."""

import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from exported_tree import import_collection

SIDES, RINGS, HEIGHT = 6, 5, 4.0


def _picture(path, colour=(0.5, 0.3, 0.2, 1.0)):
    path.parent.mkdir(exist_ok=True)
    image = bpy.data.images.new("picture", 4, 4, alpha=True)
    image.pixels.foreach_set(np.tile(np.array(colour, np.float32), 16))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)


def _write_tree(path, coordinates=True, upper="upper", library=True, leaf_material="leaf"):
    """A trunk of two materials, the second from the middle on, and three leaves."""
    lines = ["mtllib pack.mtl" if library else "", "g trunk1"]
    for ring in range(RINGS):
        for k in range(SIDES):
            angle, radius = 2 * np.pi * k / SIDES, 0.3 - 0.05 * ring
            lines.append(
                f"v {radius * np.cos(angle)} {ring * HEIGHT / (RINGS - 1)} {-radius * np.sin(angle)}"
            )
        lines += [f"vt {2 * k / SIDES} {ring}" for k in range(SIDES + 1)]
    for ring in range(RINGS - 1):
        lines.append("usemtl lower" if ring < 2 else f"usemtl {upper}")
        for k in range(SIDES):
            corners = ((ring, k), (ring, k + 1), (ring + 1, k + 1), (ring + 1, k))
            lines.append(
                "f "
                + " ".join(
                    f"{r * SIDES + c % SIDES + 1}/{r * (SIDES + 1) + c + 1}"
                    if coordinates
                    else f"{r * SIDES + c % SIDES + 1}"
                    for r, c in corners
                )
            )
    lines += ["g leaves", f"usemtl {leaf_material}"]
    for leaf in range(3):
        x, y = 0.1, 2.0 + 0.5 * leaf
        lines += [f"v {x} {y} 0", f"v {x + 0.3} {y} 0.1", f"v {x + 0.3} {y + 0.3} 0.1", f"v {x} {y + 0.2} 0"]
        lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "f -4/-4 -3/-3 -2/-2 -1/-1"]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def pack(tmp_path):
    """A bought tree: textures in folders of other letter cases, all kinds of maps."""
    for name in ("Textures/bark.png", "MAPS/bark_b.png", "Textures/Leaf.png", "Textures/mask.png"):
        _picture(tmp_path / name)
    _picture(tmp_path / "bark_n.png", (0.5, 0.5, 1.0, 1.0))
    _picture(tmp_path / "bark_s.png", (0.2, 0.2, 0.2, 1.0))
    (tmp_path / "pack.mtl").write_text(
        "newmtl lower\nKd 0.8 0.8 0.8\nmap_Kd -s 2 3 1 C:\\shop\\Bark.PNG\nmap_bump -bm 0.5 bark_b.png\n"
        "norm bark_n.png\nmap_Ks bark_s.png\n"
        "newmtl upper\nKd 0.4 0.1 0.1\n"
        "newmtl leaf\nKd 1 1 1\nTf 0.5 0.9 0.3\nmap_Kd leaf.png\nmap_d mask.png\n"
        "newmtl unused\nmap_Kd nowhere.png\n"
    )
    _write_tree(tmp_path / "bought.obj")
    return tmp_path / "bought.obj"


def _warnings(collection):
    return json.loads(collection["snowbough_report"])["warnings"]


def _surface(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def _image_behind(socket):
    """(file's name, colour space, scale, UV map) of the image that a socket's value comes from.

    The name is in lower case: Windows finds a file by the name in the library, others by its own.
    """
    node = socket.links[0].from_node
    while node.type != "TEX_IMAGE":
        inputs = {"NORMAL_MAP": "Color", "BUMP": "Height", "MATH": 0}
        node = node.inputs[inputs[node.type]].links[0].from_node
    place, scale = node.inputs["Vector"].links[0].from_node, (1.0, 1.0)
    if place.type == "MAPPING":
        scale = tuple(place.inputs["Scale"].default_value)[:2]
        place = place.inputs["Vector"].links[0].from_node
    name = bpy.path.basename(node.image.filepath)
    return name.lower(), node.image.colorspace_settings.name, scale, place.uv_map


@pytest.mark.parametrize("settings", [{"detail": "BASE"}, {}, {"lod_chain": True}], ids=str)
def test_each_face_of_the_wood_has_its_own_material(pack, settings):
    collection = import_collection(pack, **settings)
    for bark in collection.objects:
        if bark.type != "MESH" or "bark" not in bark.name:
            continue
        assert [material.name for material in bark.data.materials] == ["lower", "upper"]
        for face in bark.data.polygons:
            if abs(face.center.z - HEIGHT / 2) > 0.2:
                assert face.material_index == (face.center.z > HEIGHT / 2)


def test_the_exports_own_coordinates_are_a_third_map(pack, addon):
    mesh = import_collection(pack).objects["bought_bark"].data
    assert [layer.name for layer in mesh.uv_layers] == ["bark", "snow", "original"]
    assert mesh.uv_layers.active.name == "bark"
    uv = addon("base.compat").read_uv(mesh.uv_layers["original"], len(mesh.loops))
    points = addon("base.compat").read_positions(mesh)[addon("base.compat").read_corner_vertices(mesh)]
    side = np.repeat([0.1 < face.center.z < HEIGHT - 0.1 for face in mesh.polygons], 4)
    assert np.abs(uv[:, 1] - points[:, 2] / HEIGHT * (RINGS - 1))[side].max() < 0.1
    angle = np.arctan2(points[:, 1], points[:, 0]) / np.pi
    off = (uv[:, 0] - angle + 1) % 2 - 1
    assert np.abs(off[side]).max() < 0.05


def test_textures_are_found_and_used_on_the_exports_coordinates(pack, addon):
    bark = import_collection(pack).objects["bought_bark"]
    surface = _surface(bark.data.materials["lower"])
    assert _image_behind(surface.inputs["Base Color"]) == ("bark.png", "sRGB", (2.0, 3.0), "original")
    bump = surface.inputs["Normal"].links[0].from_node
    assert bump.type == "BUMP" and bump.inputs["Strength"].default_value == 0.5
    assert _image_behind(bump.inputs["Height"]) == ("bark_b.png", "Non-Color", (1.0, 1.0), "original")
    normal = bump.inputs["Normal"].links[0].from_node
    assert normal.uv_map == "original"
    assert _image_behind(normal.inputs["Color"]) == ("bark_n.png", "Non-Color", (1.0, 1.0), "original")
    gloss = addon("base.compat").specular_input(surface)
    assert _image_behind(gloss) == ("bark_s.png", "Non-Color", (1.0, 1.0), "original")


def test_wood_without_a_texture_has_procedural_bark_in_its_colour(pack):
    material = import_collection(pack).objects["bought_bark"].data.materials["upper"]
    ramp = next(node for node in material.node_tree.nodes if node.type == "VALTORGB")
    assert tuple(ramp.color_ramp.elements[1].color)[:3] == pytest.approx((0.4, 0.1, 0.1))
    maps = {node.uv_map for node in material.node_tree.nodes if node.type == "UVMAP"}
    assert maps == {"bark"}


def test_leaves_let_light_through_and_are_cut(pack, addon):
    material = import_collection(pack).objects["bought_leaves"].data.materials[0]
    tree = material.node_tree
    back = next(node for node in tree.nodes if node.type == "BSDF_TRANSLUCENT")
    tint = back.inputs["Color"].links[0].from_node
    assert tuple(tint.inputs[1].default_value) == pytest.approx((0.5, 0.9, 0.3))
    end = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    cut = end.inputs["Surface"].links[0].from_node
    assert cut.inputs[1].links[0].from_node.type == "BSDF_TRANSPARENT"
    assert _image_behind(cut.inputs[0]) == ("mask.png", "Non-Color", (1.0, 1.0), "leaf")


def test_no_slot_and_no_material_is_left_unused(pack):
    collection = import_collection(pack)
    for name, slots in (("bought_bark", ["lower", "upper"]), ("bought_leaves", ["leaf"])):
        mesh = collection.objects[name].data
        assert [material.name for material in mesh.materials] == slots
        assert {face.material_index for face in mesh.polygons} == set(range(len(slots)))
    assert {material.name for material in bpy.data.materials} == {"lower", "upper", "leaf"}


def test_a_texture_that_only_an_unused_material_lacks_is_not_missed(pack):
    assert not [text for text in _warnings(import_collection(pack)) if "nowhere.png" in text]


def test_a_broken_texture_is_named_once_and_the_material_keeps_its_colour(pack):
    (pack.parent / "pack.mtl").write_text(
        "newmtl lower\nKd 0.6 0.2 0.1\nmap_Kd bark.png\nmap_bump bark_b.png\n"
        "newmtl upper\nKd 0.4 0.1 0.1\nmap_Kd bark.png\n"
        "newmtl leaf\nKd 0.1 0.5 0.2\nmap_Kd leaf.png\nmap_d leaf.png\n"
    )
    (pack.parent / "Textures" / "bark.png").write_text("<html>not found</html>")
    (pack.parent / "Textures" / "Leaf.png").write_bytes(b"")
    collection = import_collection(pack)
    assert [text.lower() for text in _warnings(collection)] == [
        "texture 'bark.png' of material 'lower' cannot be read",
        "texture 'leaf.png' of material 'leaf' cannot be read",
    ]
    lower, _upper = collection.objects["bought_bark"].data.materials[:2]
    images = [node.image for node in lower.node_tree.nodes if node.type == "TEX_IMAGE"]
    assert [Path(image.filepath).name for image in images] == ["bark_b.png"]
    leaf = bpy.data.materials["leaf"]
    assert not [node for node in leaf.node_tree.nodes if node.type == "TEX_IMAGE"]
    assert tuple(_surface(leaf).inputs["Base Color"].default_value)[:3] == pytest.approx((0.1, 0.5, 0.2))
    assert [(bpy.path.basename(image.filepath), image.users > 0) for image in bpy.data.images] == [
        ("bark_b.png", True)
    ]


def test_a_missing_texture_is_named_once_and_leaves_are_green(pack):
    (pack.parent / "Textures" / "Leaf.png").unlink()
    (pack.parent / "pack.mtl").write_text(
        "newmtl lower\nmap_Kd bark.png\nnewmtl upper\nmap_Kd BARK.png\nnewmtl leaf\nKd 1 1 1\n"
        "map_Kd leaf.png\nmap_d leaf.png\n"
    )
    collection = import_collection(pack)
    assert [text for text in _warnings(collection) if "leaf.png" in text] == [
        "texture 'leaf.png' of material 'leaf' is missing"
    ]
    red, green, blue, _ = (
        _surface(collection.objects["bought_leaves"].data.materials[0]).inputs["Base Color"].default_value
    )
    assert green > 2 * red and green > 2 * blue


def test_a_black_leaf_without_a_texture_is_green_and_one_of_no_opacity_is_seen(tmp_path):
    _write_tree(tmp_path / "plain.obj", library=False)
    (tmp_path / "plain.mtl").write_text("newmtl leaf\nKd 0 0 0\nd 0\n")
    surface = _surface(import_collection(tmp_path / "plain.obj").objects["plain_leaves"].data.materials[0])
    red, green, _, _ = surface.inputs["Base Color"].default_value
    assert green > red and surface.inputs["Alpha"].default_value == 1.0


@pytest.mark.parametrize("described", [True, False])
def test_leaves_without_a_material_are_green(tmp_path, described):
    _write_tree(tmp_path / "plain.obj", library=False)
    if described:
        (tmp_path / "plain.mtl").write_text("newmtl leaf\nKd 0.7 0.1 0.1\n")
    surface = _surface(import_collection(tmp_path / "plain.obj").objects["plain_leaves"].data.materials[0])
    red, green, _, _ = surface.inputs["Base Color"].default_value
    assert red > green if described else green > red


def test_a_file_without_coordinates_wears_its_texture_along_the_limb(pack):
    _write_tree(pack, coordinates=False)
    bark = import_collection(pack).objects["bought_bark"]
    assert [layer.name for layer in bark.data.uv_layers] == ["bark", "snow"]
    surface = _surface(bark.data.materials["lower"])
    assert _image_behind(surface.inputs["Base Color"])[3] == "bark"


def test_wood_without_any_material_keeps_the_procedural_bark(tmp_path):
    text = []
    _write_tree(tmp_path / "bare.obj", library=False)
    for line in (tmp_path / "bare.obj").read_text().splitlines():
        if not line.startswith("usemtl"):
            text.append(line)
    (tmp_path / "bare.obj").write_text("\n".join(text))
    objects = import_collection(tmp_path / "bare.obj").objects
    assert [material.name for material in objects["bare_bark"].data.materials] == ["bare_bark"]
    assert [material.name for material in objects["bare_leaves"].data.materials] == ["bare_leaf"]
