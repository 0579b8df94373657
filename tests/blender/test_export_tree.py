# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees for game engines (export_scene.snowbough_tree) as glTF: what is written is read back (tests/support/glb.py) and
compared with the scene."""

import json

import bpy
import numpy as np
import pytest
from exported_tree import LEAVES, PLAIN, export, glb, import_tree, rest_points, rows, y_up
from mathutils.kdtree import KDTree
from synthetic_tree import evaluated_vertices

# -- levels of detail -----------------------------------------------------------------------------------


def test_the_finest_level_is_the_mesh_in_the_scene(tmp_path):
    _rig, bark = import_tree()
    read = export(tmp_path / "tree.glb")
    places, _triangles = read.welded(read.node("small_maple_bark_LOD0"))
    assert len(places) == len(bark.data.vertices)
    assert rows(places) == rows(y_up(rest_points(bark)))


def test_every_level_is_closed_and_has_clearly_fewer_triangles(tmp_path):
    import_tree()
    read = export(tmp_path / "tree.glb", levels=6)
    nodes = read.lods(read.node("small_maple_bark_LOD0"))
    assert [node["name"] for node in nodes] == [f"small_maple_bark_LOD{k}" for k in range(6)]
    counts = []
    for node in nodes:
        places, triangles = read.welded(node)
        counts.append(len(triangles))
        assert glb.is_closed(triangles), node["name"]
        # Four sides instead of sixteen, and in the end fewer branches: never more wood, never inside out.
        assert 0.015 < glb.volume(places, triangles) < 0.035
    assert all(later <= 0.7 * before for before, later in zip(counts, counts[1:]))


def test_the_trunk_is_as_wide_in_every_level(tmp_path):
    import_tree()
    read = export(tmp_path / "tree.glb", levels=5)
    directions = np.linspace(0, np.pi, 90, endpoint=False)
    directions = np.stack([np.cos(directions), np.sin(directions)])
    widths = []
    for node in read.lods(read.node("small_maple_bark_LOD0")):
        places, triangles = read.welded(node)
        height = 0.1 * places[:, 1].max()  # below all branches
        corners = places[triangles].astype(float)
        begin, end = corners, np.roll(corners, -1, axis=1)
        cut = (begin[..., 1] > height) != (end[..., 1] > height)
        begin, end = begin[cut], end[cut]
        share = (height - begin[:, 1]) / (end[:, 1] - begin[:, 1])
        section = (begin + (end - begin) * share[:, None])[:, (0, 2)]
        widths.append(np.ptp(section @ directions, axis=0).mean())
    assert widths == pytest.approx([widths[0]] * len(widths), rel=0.03)


def test_one_baked_map_fits_every_level(tmp_path):
    import_tree()
    read = export(tmp_path / "tree.glb", levels=5)
    given = [
        read.attributes(primitive)
        for node in read.lods(read.node("small_maple_bark_LOD0"))
        for primitive in read.primitives(node)
    ]
    # Where a chart ends lie two; on it the nearest vertex of the finest level has nearly the same place.
    finest = given[0]
    vertices = KDTree(len(finest["POSITION"]))
    for number, point in enumerate(finest["POSITION"].tolist()):
        vertices.insert(point, number)
    vertices.balance()
    for level in given[1:]:
        nearest = [vertices.find(point)[1] for point in level["POSITION"][::7].tolist()]
        uv = np.linalg.norm(level["TEXCOORD_1"][::7] - finest["TEXCOORD_1"][nearest], axis=1)
        assert np.median(uv) < 4 / 1024


def test_an_imported_chain_goes_out_as_it_is(tmp_path):
    import_tree(lod_chain=True)
    read = export(tmp_path / "tree.glb", levels=4)
    counts = [len(read.welded(node)[1]) for node in read.lods(read.node("small_maple_bark_LOD0"))]
    there = [bpy.data.objects[f"small_maple_bark_LOD{k}"] for k in range(4)]
    assert counts == [2 * len(bark.data.polygons) for bark in there]


def test_one_file_a_level(tmp_path):
    import_tree()
    assert bpy.ops.export_scene.snowbough_tree(
        filepath=str(tmp_path / "tree.gltf"), levels=3, file_per_level=True, **PLAIN
    ) == {"FINISHED"}
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"tree_LOD{k}.{suffix}" for k in range(3) for suffix in ("bin", "gltf")
    ]
    for level in range(3):
        path = tmp_path / f"tree_LOD{level}.gltf"
        assert glb.errors(path) == []
        read = glb.Gltf(path)
        assert "extensionsUsed" not in read.json
        assert "mesh" in read.node(f"small_maple_bark_LOD{level}")


def test_a_tree_whose_bones_were_moved_says_why_there_is_but_one_level(tmp_path, addon):
    rig, bark = import_tree()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones[3].head.x += 0.1
    bpy.ops.object.mode_set(mode="OBJECT")
    options = addon("gltf.export_options").ExportOptions(**PLAIN)
    report = addon("gltf.export_tree").export(bpy.context, bark, tmp_path / "tree.glb", options)
    assert len(report["levels"]) == 1
    assert any("its rest bones were moved" in text for text in report["warnings"])
    assert glb.errors(tmp_path / "tree.glb") == []


def test_a_tree_of_an_older_import_has_the_level_that_is_there(tmp_path, addon):
    rig, bark = import_tree()
    rig.data.snowbough_skeleton = ""
    options = addon("gltf.export_options").ExportOptions(**PLAIN)
    report = addon("gltf.export_tree").export(bpy.context, bark, tmp_path / "tree.glb", options)
    assert len(report["levels"]) == 1
    assert any("stores no skeleton" in text for text in report["warnings"])


def test_levels_can_be_built_from_a_saved_file_without_its_obj(tmp_path, leafy):
    import_tree(leafy)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "tree.blend"), check_existing=False)
    leafy.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "tree.blend"))
    read = export(tmp_path / "tree.glb", levels=4)
    assert len(read.lods(read.node("leafy_bark_LOD0"))) == 4


def test_a_tree_of_a_version_that_counted_levels_gets_coarser_ones(addon, tmp_path):
    rig, _bark = import_tree()
    text = addon("tree.skeleton_text")
    branches, built = text.from_text(rig.data.snowbough_skeleton)
    del built["detail"]
    rig.data.snowbough_skeleton = text.to_text(branches, {**built, "fineness": {"lod": 3, "detail": ""}})
    read = export(tmp_path / "tree.glb", levels=3)
    assert len(read.lods(read.node("small_maple_bark_LOD0"))) == 3


# -- skin and attributes --------------------------------------------------------------------------------


def test_the_skin_at_rest_leaves_every_vertex_where_it_is(tmp_path):
    import_tree()
    read = export(tmp_path / "tree.glb")
    for node in read.lods(read.node("small_maple_bark_LOD0")):
        for rest, primitive in zip(read.skinned(node), read.primitives(node), strict=True):
            place = read.array(primitive["attributes"]["POSITION"])
            assert np.abs(rest - place).max() < 1e-5


def test_joints_bend_the_mesh_as_bones_do_in_blender(tmp_path):
    rig, bark = import_tree()
    read = export(tmp_path / "tree.glb", levels=1)
    nodes = {node["name"]: node for node in read.json["nodes"]}
    from mathutils import Quaternion

    for number, axis, angle in ((0, (1, 0, 0), 0.3), (5, (0, 0, 1), -0.4), (40, (0, 1, 0), 0.8)):
        bone = rig.pose.bones[number]
        turn = Quaternion(axis, angle)
        bone.rotation_mode, bone.rotation_quaternion = "QUATERNION", turn
        node = nodes[bone.name]
        x, y, z, w = node["rotation"]
        both = Quaternion((w, x, y, z)) @ turn
        node["rotation"] = [both.x, both.y, both.z, both.w]
    bpy.context.view_layer.update()
    inside = y_up(evaluated_vertices(bark))
    assert np.linalg.norm(inside - y_up(rest_points(bark)), axis=1).max() > 0.1
    (outside,) = read.skinned(read.node("small_maple_bark_LOD0"))
    away = np.array([np.linalg.norm(inside - place, axis=1).min() for place in outside[::11]])
    assert away.max() < 1e-3


def test_every_bone_is_a_joint_under_its_parent(tmp_path):
    rig, _bark = import_tree()
    read = export(tmp_path / "tree.glb")
    nodes = read.json["nodes"]
    parents = {nodes[c]["name"]: node["name"] for node in nodes for c in node.get("children", ())}
    assert parents == {bone.name: bone.parent.name if bone.parent else rig.name for bone in rig.data.bones}


def test_the_trunks_foot_does_not_lean_towards_its_cap(tmp_path):
    """Shaders that round limbs by their normals would inflate it."""
    import_tree()
    read = export(tmp_path / "tree.glb")
    for node in read.lods(read.node("small_maple_bark_LOD0")):
        given = read.attributes(read.primitives(node)[0])
        foot = given["POSITION"][:, 1] < given["POSITION"][:, 1].min() + 0.06
        down = given["NORMAL"][foot, 1]
        cap = down < -0.8
        assert 4 <= cap.sum() and 4 <= (~cap).sum()
        assert np.abs(down[~cap]).max() < 0.2, node["name"]


def test_both_uv_maps_go_out_with_v_downwards(tmp_path):
    _rig, bark = import_tree()
    read = export(tmp_path / "tree.glb", levels=1)
    (primitive,) = read.primitives(read.node("small_maple_bark_LOD0"))
    given = read.attributes(primitive)
    corner = np.array([loop.vertex_index for loop in bark.data.loops])
    layers = []
    for name in ("bark", "snow"):
        uv = np.array([entry.uv for entry in bark.data.uv_layers[name].data], np.float32)
        layers.append(np.stack([uv[:, 0], 1 - uv[:, 1]], axis=1).astype(np.float32))
    expected = rows(y_up(rest_points(bark))[corner], *layers)
    assert rows(given["POSITION"], given["TEXCOORD_0"], given["TEXCOORD_1"]) == expected


def test_branch_levels_and_what_tessellation_makes_of_them(tmp_path):
    _rig, bark = import_tree()
    read = export(tmp_path / "tree.glb")
    assert read.json["scenes"][0]["extras"]["snowbough"]["branch_levels"] == 2
    at = [entry.value for entry in bark.data.attributes["_BRANCH_LEVEL"].data]
    expected = rows(y_up(rest_points(bark)), np.array(at)[:, None])
    for node in read.lods(read.node("small_maple_bark_LOD0"))[:3]:
        (primitive,) = read.primitives(node)
        given = read.attributes(primitive)
        level = given["_BRANCH_LEVEL"]
        assert set(level[:, 0]) == {0.0, 1.0}
        assert np.abs(given["COLOR_0"][:, 3:] / 255 - (1 - level / 2)).max() < 1 / 255
        if node["name"].endswith("_LOD0"):
            assert rows(given["POSITION"], level) == expected


def test_scale_and_units_go_into_the_vertices(tmp_path):
    rig, bark = import_tree()
    rig.scale = (2, 2, 2)
    rig.location = (5, 0, 0)
    bpy.context.scene.unit_settings.scale_length = 0.5
    bpy.context.view_layer.update()
    read = export(tmp_path / "tree.glb", levels=2)
    places, _triangles = read.welded(read.node("small_maple_bark_LOD0"))
    assert rows(places) == rows(y_up(rest_points(bark)))  # 2 * 0.5, and the tree's own origin
    assert all("scale" not in node for node in read.json["nodes"])


def test_wind_attributes_go_out_in_every_level(tmp_path, leafy):
    _rig, bark = import_tree(leafy, wind_attributes=True)
    read = export(tmp_path / "tree.glb", levels=3)
    pivots = np.array([entry.vector for entry in bark.data.attributes["_PIVOT"].data])
    phases = np.array([entry.value for entry in bark.data.attributes["_PHASE"].data])
    expected = rows(y_up(pivots), phases[:, None])
    for node in read.lods(read.node("leafy_bark_LOD0")):
        given = read.attributes(read.primitives(node)[0])
        there = rows(given["_PIVOT"], given["_PHASE"])
        assert there <= expected and len(there) > 3
        assert np.abs(np.linalg.norm(given["_AXIS"], axis=1) - 1).max() < 1e-5
    lengths = [
        read.attributes(read.primitives(node)[0])["_LENGTH"].mean()
        for node in read.lods(read.node("leafy_leaves_LOD0"))
    ]
    assert lengths[1] == pytest.approx(lengths[0] * 2**0.5, rel=0.02)  # fewer leaves, and larger


# -- leaves ---------------------------------------------------------------------------------------------


def test_leaves_are_a_mesh_of_their_own_with_a_mask(tmp_path, leafy):
    import_tree(leafy)
    read = export(tmp_path / "tree.glb", levels=3)
    node = read.node("leafy_leaves_LOD0")
    (primitive,) = read.primitives(node)
    material = read.json["materials"][primitive["material"]]
    assert (material["alphaMode"], material["alphaCutoff"], material["doubleSided"]) == ("MASK", 0.5, True)
    bark = read.json["materials"][read.primitives(read.node("leafy_bark_LOD0"))[0]["material"]]
    assert "alphaMode" not in bark and "doubleSided" not in bark
    data, kind = read.image(material["pbrMetallicRoughness"]["baseColorTexture"]["index"])
    (tmp_path / "out.png").write_bytes(data)
    image = bpy.data.images.load(str(tmp_path / "out.png"))
    pixels = np.array(image.pixels[:]).reshape(8, 8, 4)
    assert kind == "image/png" and ((pixels[..., 3] > 0.5) == (np.arange(8) < 4)).all()
    # The white of the texture does not shine through at the mask's edge.
    assert np.abs(pixels[..., :3] - np.array((40, 120, 20)) / 255).max() < 0.01


def test_each_level_has_half_the_leaves_and_as_much_shade(tmp_path, leafy):
    import_tree(leafy)
    read = export(tmp_path / "tree.glb", levels=3, leaf_share=0.5)
    nodes = read.lods(read.node("leafy_leaves_LOD0"))
    assert len(nodes) == len(read.lods(read.node("leafy_bark_LOD0"))) == 3
    areas = []
    for number, node in enumerate(nodes):
        (primitive,) = read.primitives(node)
        place = read.array(primitive["attributes"]["POSITION"]).astype(float)
        corner = place[read.array(primitive["indices"]).reshape(-1, 3)]
        assert len(corner) == 2 * LEAVES / 2**number
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        areas.append(np.linalg.norm(across, axis=1).sum() / 2)
    assert areas == pytest.approx([LEAVES * 0.04 * 0.04] * 3, rel=1e-3)


def test_a_leaf_follows_one_joint(tmp_path, leafy):
    import_tree(leafy)
    read = export(tmp_path / "tree.glb", levels=1)
    (primitive,) = read.primitives(read.node("leafy_leaves_LOD0"))
    given = read.attributes(primitive)
    assert (given["WEIGHTS_0"] == (1, 0, 0, 0)).all() and "_BRANCH_LEVEL" not in given
    assert len(np.unique(given["JOINTS_0"][:, 0])) > 3


# -- small vertices, textures, motion, cards ------------------------------------------------------------


def test_small_vertices_take_less_than_two_thirds_and_are_where_the_large_are(tmp_path, leafy):
    import_tree(leafy)
    large, small = (
        export(tmp_path / f"{name}.glb", levels=2, vertices=name.upper()) for name in ("float", "small")
    )
    assert (tmp_path / "small.glb").stat().st_size < 0.67 * (tmp_path / "float.glb").stat().st_size
    for name in ("leafy_bark_LOD0", "leafy_bark_LOD1", "leafy_leaves_LOD0"):
        (found,), (expected,) = small.skinned(small.node(name)), large.skinned(large.node(name))
        assert np.abs(found - expected).max() < 1e-4
        _, triangles = small.welded(small.node(name))
        assert "leaves" in name or glb.is_closed(triangles)


def test_joints_sway_in_the_file_as_bones_do_in_blender(tmp_path):
    rig, bark = import_tree()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.snowbough.add_sway(loop_frames=48, strength=2.0, seed=5)
    bpy.context.scene.frame_set(20)
    read = export(tmp_path / "tree.glb", levels=1, loop_keys=16, vertices="SMALL")
    assert bpy.context.scene.frame_current == 20
    (animation,) = read.json["animations"]
    moments = read.array(animation["samplers"][0]["input"])[:, 0]
    assert len(moments) == 17 and moments[-1] == pytest.approx(48 / 24)
    for key in (0, 5, 11):
        for channel in animation["channels"]:
            turns = read.values(animation["samplers"][channel["sampler"]]["output"])
            read.json["nodes"][channel["target"]["node"]]["rotation"] = turns[key].tolist()
        bpy.context.scene.frame_set(1 + 3 * key)
        expected = y_up(evaluated_vertices(bark))
        (found,) = read.skinned(read.node("small_maple_bark_LOD0"))
        away = np.linalg.norm(expected - y_up(rest_points(bark)), axis=1)
        nearest = np.linalg.norm(expected[::37, None] - found[None], axis=2).min(axis=1)
        assert away.max() > 0.02 and nearest.max() < 1e-3


def test_a_chosen_loop_replaces_that_of_the_keys(tmp_path):
    rig, _bark = import_tree()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.snowbough.add_sway(loop_frames=48)
    read = export(tmp_path / "tree.glb", levels=1, loop_start=13, loop_frames=24, loop_keys=4)
    clock = read.array(read.json["animations"][0]["samplers"][0]["input"])[:, 0]
    assert clock == pytest.approx(np.arange(5) / 4)
    assert "animations" not in export(tmp_path / "still.glb", levels=1, motion=False).json


def test_motion_that_is_not_exported_is_named(tmp_path, addon):
    rig, bark = import_tree()
    rig.pose.bones[3].keyframe_insert("location", frame=1)
    rig.pose.bones[3].keyframe_insert("location", frame=9)
    options = addon("gltf.export_options").ExportOptions(**PLAIN, levels=1)
    report = addon("gltf.export_tree").export(bpy.context, bark, tmp_path / "tree.glb", options)
    assert report["keys"] == 0 and "animations" not in glb.Gltf(tmp_path / "tree.glb").json
    assert any("only rotations of bones were exported" in text for text in report["warnings"])


def test_procedural_bark_is_baked_to_textures_that_repeat(tmp_path):
    import_tree()
    read = export(tmp_path / "tree.glb", levels=1, texture_size=64)
    (material,) = read.json["materials"]
    for info, mean in (
        (material["pbrMetallicRoughness"]["baseColorTexture"], None),
        (material["normalTexture"], (0.5, 0.5, 0.9)),
    ):
        data, kind = read.image(info["index"])
        (tmp_path / "bark.jpg").write_bytes(data)
        image = bpy.data.images.load(str(tmp_path / "bark.jpg"))
        pixels = np.array(image.pixels[:]).reshape(64, 64, -1)[..., :3]
        bpy.data.images.remove(image)
        assert kind == "image/jpeg" and pixels.std(axis=(0, 1)).max() > 0.02
        # Rows and columns at the ends differ as neighbours do.
        for axis in (0, 1):
            steps = np.abs(np.diff(pixels, axis=axis)).mean()
            seam = np.abs(pixels.take(0, axis=axis) - pixels.take(-1, axis=axis)).mean()
            assert seam < 2.0 * steps
        assert mean is None or pixels.mean(axis=(0, 1)) == pytest.approx(mean, abs=0.1)
    assert len(bpy.data.scenes) == 1 and not [i for i in bpy.data.images if "snowbough" in i.name]


def test_the_last_level_is_cards_with_pictures_of_the_tree(tmp_path, leafy):
    import_tree(leafy)
    read = export(tmp_path / "tree.glb", levels=2, cards=True)
    bark = read.lods(read.node("leafy_bark_LOD0"))
    assert bark[2]["name"] == "leafy_LOD2"
    (primitive,) = read.primitives(bark[2])
    given = read.attributes(primitive)
    low, high = given["POSITION"].min(axis=0), given["POSITION"].max(axis=0)
    whole = read.attributes(read.primitives(bark[0])[0])["POSITION"]
    assert (low[1] <= whole[:, 1].min()) and (high[1] >= whole[:, 1].max()) and len(given["POSITION"]) == 32
    material = read.json["materials"][primitive["material"]]
    data, _kind = read.image(material["pbrMetallicRoughness"]["baseColorTexture"]["index"])
    (tmp_path / "cards.png").write_bytes(data)
    image = bpy.data.images.load(str(tmp_path / "cards.png"))
    pixels = np.array(image.pixels[:]).reshape(512, 1024, 4)
    leaves = []
    for tile in (t for row in np.split(pixels, 2) for t in np.split(row, 4, axis=1)):
        seen = tile[tile[..., 3] >= 0.5]
        assert 0.01 < len(seen) / tile[..., 0].size < 0.5
        leaf = np.abs(seen[:, :3] - np.array((40, 120, 20)) / 255).max(axis=1) < 0.1
        leaves.append(leaf.mean())
    # The leaves are upright and face one direction: pictures from the side do not show them.
    assert max(leaves) > 0.02 and min(leaves) < 0.002


def test_the_cards_have_a_file_of_their_own_if_levels_have(tmp_path):
    import_tree()
    options = {**PLAIN, "levels": 1, "cards": True, "file_per_level": True, "vertices": "COMPRESSED"}
    assert bpy.ops.export_scene.snowbough_tree(filepath=str(tmp_path / "tree.glb"), **options) == {"FINISHED"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["tree_LOD0.glb", "tree_LOD1.glb"]
    for level in range(2):
        assert glb.errors(tmp_path / f"tree_LOD{level}.glb") == []
    read = glb.Gltf(tmp_path / "tree_LOD1.glb")
    assert "skins" not in read.json and len(read.json["nodes"]) == 3  # a joint, its root, the cards


# -- calls ----------------------------------------------------------------------------------------------


def test_what_is_no_tree_is_refused(tmp_path):
    bpy.ops.mesh.primitive_cube_add()
    assert not bpy.ops.export_scene.snowbough_tree.poll()
    with pytest.raises(RuntimeError, match="select the armature, bark or leaves"):
        bpy.ops.export_scene.snowbough_tree(filepath=str(tmp_path / "tree.glb"))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name, complaint", [("tree.fbx", "must end in .glb or .gltf"), ("no/tree.glb", "no folder")]
)
def test_a_file_that_cannot_be_written_is_named(tmp_path, name, complaint):
    import_tree()
    with pytest.raises(RuntimeError, match=complaint):
        bpy.ops.export_scene.snowbough_tree(filepath=str(tmp_path / name))


def test_any_object_of_the_tree_will_do(tmp_path, leafy):
    rig, bark = import_tree(leafy)
    sizes = set()
    for obj in (rig, bark, bpy.data.objects["leafy_leaves"]):
        bpy.context.view_layer.objects.active = obj
        export(tmp_path / "tree.glb", levels=1)
        sizes.add((tmp_path / "tree.glb").stat().st_size)
    assert len(sizes) == 1


def test_the_command_line_exports_the_only_tree(tmp_path, addon, capsys):
    import_tree()
    run = addon("cli").run
    report, fast = tmp_path / "report.json", ["--cards", "--texture-size", "0"]
    assert run(["export", str(tmp_path / "tree.glb"), *fast, "--levels", "2", "--json", str(report)]) == 0
    assert len(json.loads(report.read_text())["levels"]) == 2
    assert glb.errors(tmp_path / "tree.glb") == []
    assert run(["export", str(tmp_path / "tree.glb"), "--tree", "oak"]) == 1
    assert "there is no tree 'oak'; imported trees in the scene: small_maple" in capsys.readouterr().err
    assert run(["export", str(tmp_path / "tree.glb"), "--leaf-share", "7"]) == 2


def test_blenders_own_importer_reads_it(tmp_path, leafy, monkeypatch):
    if not hasattr(np, "bool"):
        monkeypatch.setattr(
            np, "bool", bool, raising=False
        )  # the importer of 3.4 was written for an older numpy
    _rig, bark = import_tree(leafy)
    count, reach = len(bark.data.polygons), rest_points(bark).max(axis=0)
    uv = np.array([entry.uv for entry in bark.data.uv_layers["snow"].data])
    export(tmp_path / "tree.glb", levels=2)
    bpy.ops.wm.read_homefile(use_empty=True)
    if not hasattr(bpy.types, "IMPORT_SCENE_OT_gltf"):
        pytest.skip("this Blender has no glTF importer")
    bpy.ops.import_scene.gltf(filepath=str(tmp_path / "tree.glb"))
    bark = bpy.data.objects["leafy_bark_LOD0"]
    assert len(bark.data.polygons) == 2 * count
    assert len(bark.find_armature().data.bones) == 120
    assert rest_points(bark).max(axis=0) == pytest.approx(reach, abs=1e-4)
    read = np.array([entry.uv for entry in bark.data.uv_layers[1].data])
    assert read.min(axis=0) == pytest.approx(uv.min(axis=0), abs=1e-5)
    assert read.mean(axis=0) == pytest.approx(uv.mean(axis=0), abs=0.05)
