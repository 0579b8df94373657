# SPDX-License-Identifier: GPL-3.0-or-later
"""The export to glTF without Blender (snowbough.gltf): surfaces, and files that conform to the specification
(tests/support/glb.py reads them back)."""

import json
from dataclasses import replace

import glb
import meshopt
import numpy as np
import pytest
from gltf_trees import PNG, TOWER, cube, leaves_surface, some_tree
from snowbough.gltf import (
    compression,
    quantise,
    tangents,
    tree_data,
    tree_file,
    triangle_mesh,
)

# -- surfaces -------------------------------------------------------------------------------------------


def test_the_four_strongest_influences_sum_to_one():
    joints, weights = triangle_mesh.strongest([[7, 8, 9, 10, 11]], [[0.1, 0.4, 0.0, 0.3, 0.2]])
    assert joints.tolist() == [[8, 10, 11, 7]]
    assert weights[0] == pytest.approx([0.4, 0.3, 0.2, 0.1])
    joints, weights = triangle_mesh.strongest([[3, 5]], [[0.0, 2.0]])
    assert joints.tolist() == [[5, 0, 0, 0]] and weights.tolist() == [[1, 0, 0, 0]]


def test_points_are_split_where_uvs_differ_and_only_there():
    assert len(triangle_mesh.split(cube(), np.ones(12, bool)).point) == 8
    assert len(triangle_mesh.split(cube(uv_seam=True), np.ones(12, bool)).point) == 24


def test_smooth_normals_point_from_the_middle_of_a_cube():
    given = cube()
    vertices = triangle_mesh.split(given, np.ones(12, bool))
    outwards = given.points[vertices.point] / np.sqrt(0.75)
    assert np.abs(vertices.normals - outwards).max() < 1e-6


def test_flat_faces_have_their_own_normals():
    given = cube()
    given.smooth[:] = False
    vertices = triangle_mesh.split(given, np.ones(12, bool))
    assert len(vertices.point) == 24 and np.abs(vertices.normals).max(axis=1) == pytest.approx(1.0)


def test_a_mirrored_surface_stays_outside_out():
    mirrored = triangle_mesh.transformed(cube(), np.diag((-2.0, 1.0, 1.0)))
    triangles = mirrored.corner_point[mirrored.triangles].astype(np.int64)
    assert glb.volume(mirrored.points, triangles) == pytest.approx(2.0)


def test_custom_normals_replace_those_of_faces_and_turn_with_them():
    given = cube()
    given.normals = np.tile(np.float32((0, 0.6, 0.8)), (24, 1))
    stretched = triangle_mesh.transformed(given, np.diag((-1.0, 2.0, 1.0)))
    found = triangle_mesh.split(stretched, np.ones(12, bool)).normals
    across = np.array((0, 0.3, 0.8)) / np.hypot(0.3, 0.8)  # still at right angles to its plane
    assert np.abs(found - across).max() < 1e-6


def bent_sheet():
    """Two quads that meet at x = 1, the second with a mirrored texture and rising. Smooth."""
    points = np.array([(x, y, max(x - 1, 0)) for x in (0, 1, 2) for y in (0, 1)], np.float32)
    quads = np.array([(0, 2, 3, 1), (2, 4, 5, 3)])
    uv = np.float32([[(0, 0), (1, 0), (1, 1), (0, 1)], [(1, 0), (0, 0), (0, 1), (1, 1)]])
    joints, weights = triangle_mesh.strongest(np.zeros((6, 1), int), np.ones((6, 1)))
    return triangle_mesh.from_quads(points, quads, [uv, uv], joints, weights, np.zeros(2), np.zeros(6, int))


def test_tangents_follow_u_and_tell_a_mirrored_texture():
    given = bent_sheet()
    signs = tangents.orientations(given.corner_uvs[0][given.triangles])
    assert signs.tolist() == [1, 1, -1, -1]
    vertices = triangle_mesh.split(given, np.ones(4, bool), signs)
    assert len(vertices.point) == 8  # the two points of the fold twice
    points = given.points[vertices.point]
    made = tangents.tangents(points, vertices.normals, vertices.uvs[0], vertices.triangles)
    assert np.abs((made[:, :3] * vertices.normals).sum(axis=1)).max() < 1e-6
    assert np.linalg.norm(made[:, :3], axis=1) == pytest.approx(1.0, abs=1e-6)
    assert made[points[:, 0] == 0] == pytest.approx(np.tile((1, 0, 0, 1), (2, 1)), abs=1e-6)
    falling = np.array((-1, 0, -1, -np.sqrt(2))) / np.sqrt(2)
    assert made[points[:, 0] == 2] == pytest.approx(np.tile(falling, (2, 1)), abs=1e-6)
    folds = made[points[:, 0] == 1]
    assert sorted(folds[:, 3].tolist()) == [-1, -1, 1, 1]
    assert np.sign(folds[:, 0]).tolist() == folds[:, 3].tolist()


@pytest.mark.parametrize("quantised", [False, True])
def test_files_with_a_normal_texture_have_tangents(tmp_path, quantised):
    bumps = tree_data.Texture("bumps", PNG, "image/png")
    tree = some_tree(normal=bumps)
    tree.parts[0].levels = [bent_sheet()]
    tree_file.build(tree, quantised=quantised).write_glb(tmp_path / "t.glb")
    assert glb.errors(tmp_path / "t.glb") == []
    read = glb.Gltf(tmp_path / "t.glb")
    (primitive,) = read.primitives(read.node("cube_LOD0"))
    tangent, normal = (read.values(primitive["attributes"][name]) for name in ("TANGENT", "NORMAL"))
    level = normal[:, 1] > 0.99  # the edge x = 0, which no other face bends
    assert tangent[level] == pytest.approx(np.tile((1, 0, 0, 1), (2, 1)), abs=1e-6)
    tree_file.build(some_tree()).write_glb(tmp_path / "plain.glb")
    (primitive,) = (plain := glb.Gltf(tmp_path / "plain.glb")).primitives(plain.node("cube_LOD0"))
    assert "TANGENT" not in primitive["attributes"]


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_the_width_of_a_limb_is_that_of_a_circle_with_its_circumference(scale):
    turns = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) / 4  # once around the walls: 4 m
    uv = turns + np.array([(k / 4, 0) for k in range(4)], np.float32)[:, None]
    given = cube()
    walls = triangle_mesh.from_quads(
        given.points, TOWER[:4], [uv, uv], given.joints, given.weights, np.zeros(4), given.level
    )
    widths = triangle_mesh.limb_widths(triangle_mesh.transformed(walls, scale * np.eye(3)))
    assert widths == pytest.approx(np.full(8, scale * 4 / np.pi), rel=1e-6)


def test_files_with_a_map_tell_the_width_of_limbs(tmp_path):
    for name, extras in (("plain", {}), ("snowy", {"snow": {"cube": {}}})):
        tree_file.build(replace(some_tree(), extras=extras)).write_glb(tmp_path / f"{name}.glb")
        read = glb.Gltf(tmp_path / f"{name}.glb")
        (primitive,) = read.primitives(read.node("cube_LOD0"))
        assert ("_LIMB_WIDTH" in primitive["attributes"]) == bool(extras)


def test_what_wind_needs_is_scaled_and_turned_with_the_surface():
    given = cube()
    pivot, axis = np.full((8, 3), 1.0, np.float32), np.tile(np.float32((0, 1, 0)), (8, 1))
    given.wind = (pivot, axis, np.full(8, 0.5, np.float32), np.full(8, 0.25, np.float32))
    turned = np.array([(0, -2, 0), (2, 0, 0), (0, 0, 2)])  # a quarter round Z, twice as large
    pivot, axis, length, phase = triangle_mesh.transformed(given, turned).wind
    assert pivot[0].tolist() == [-2, 2, 2] and axis[0].tolist() == [-1, 0, 0]
    assert (length[0], phase[0]) == (1.0, 0.25)


# -- files ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_files_keep_the_rules_and_read_back(tmp_path, suffix):
    picture = PNG
    texture = tree_data.Texture(
        "a leaf", picture, "image/png", texcoord=1, scale=(2.0, 3.0), offset=(0.1, 0.2)
    )
    built = tree_file.build(some_tree(base=texture, cutoff=0.5, double_sided=True))
    path = tmp_path / f"a tree{suffix}"
    files = built.write_glb(path) if suffix == ".glb" else built.write_separate(path)
    assert sorted(files) == sorted(tmp_path.iterdir())
    assert glb.errors(path) == []
    read = glb.Gltf(path)
    assert read.image(0)[0] == picture
    (material,) = read.json["materials"]
    info = material["pbrMetallicRoughness"]["baseColorTexture"]
    # A point's v' in glTF is 1 - v: there the texture has to be looked up at 1 - (3 v + 0.2).
    offset, scale = (info["extensions"]["KHR_texture_transform"][key] for key in ("offset", "scale"))
    assert offset[1] + scale[1] * (1 - 0.25) == pytest.approx(1 - (3 * 0.25 + 0.2))
    assert (material["alphaMode"], material["doubleSided"], info["texCoord"]) == ("MASK", True, 1)


def test_the_skin_at_rest_leaves_every_point_where_it_is(tmp_path):
    tree_file.build(some_tree()).write_glb(tmp_path / "t.glb")
    read = glb.Gltf(tmp_path / "t.glb")
    node = read.node("cube_LOD0")
    (rest,) = read.skinned(node)
    (primitive,) = read.primitives(node)
    assert np.abs(rest - read.array(primitive["attributes"]["POSITION"])).max() < 1e-6
    places, triangles = read.welded(node)
    assert glb.is_closed(triangles) and glb.volume(places, triangles) == pytest.approx(1.0)


def test_y_points_up(tmp_path):
    tree_file.build(some_tree()).write_glb(tmp_path / "t.glb")
    read = glb.Gltf(tmp_path / "t.glb")
    world = read.world_matrices()
    tip = next(k for k, node in enumerate(read.json["nodes"]) if node["name"] == "tip")
    assert world[tip][:3, 3] == pytest.approx((0, 0.5, 0), abs=1e-7)
    # Blender's X, along which the tip's Y runs backwards, stays X.
    assert world[tip][:3, 1] == pytest.approx((-1, 0, 0), abs=1e-7)


def test_branch_levels_and_their_share_of_tessellation_are_on_every_vertex(tmp_path):
    tree_file.build(some_tree()).write_glb(tmp_path / "t.glb")
    read = glb.Gltf(tmp_path / "t.glb")
    (primitive,) = read.primitives(read.node("cube_LOD0"))
    given = read.attributes(primitive)
    level = np.where(given["POSITION"][:, 1] > 0, 1.0, 0.0)
    assert np.array_equal(given["_BRANCH_LEVEL"][:, 0], level)
    assert (given["COLOR_0"][:, :3] == 255).all()
    assert np.abs(given["COLOR_0"][:, 3] / 255 - (1 - level / 3)).max() < 1 / 255
    assert read.json["scenes"][0]["extras"]["snowbough"]["branch_levels"] == 3


def test_levels_of_detail_hang_on_the_finest(tmp_path):
    tree_file.build(some_tree()).write_glb(tmp_path / "t.glb")
    read = glb.Gltf(tmp_path / "t.glb")
    finest = read.node("cube_LOD0")
    assert [node["name"] for node in read.lods(finest)] == ["cube_LOD0", "cube_LOD1"]
    assert finest["extras"]["MSFT_screencoverage"] == [0.25, 0.0]
    assert "MSFT_lod" in read.json["extensionsUsed"]


def test_many_vertices_take_wide_indices(tmp_path):
    tree = some_tree()
    tree.parts[0].levels[:] = [leaves_surface(16384)]  # 65,536 vertices
    tree_file.build(tree).write_glb(tmp_path / "t.glb")
    read = glb.Gltf(tmp_path / "t.glb")
    (primitive,) = read.primitives(read.node("cube_LOD0"))
    assert read.json["accessors"][primitive["indices"]]["componentType"] == 5125
    assert glb.errors(tmp_path / "t.glb") == []


# -- small vertices, motion, cards ----------------------------------------------------------------------


def small(tmp_path, tree):
    """The Gltf of a tree in small vertices, and of the same tree in floats."""
    read = []
    for name, quantised in (("small.glb", True), ("large.glb", False)):
        tree_file.build(tree, quantised=quantised).write_glb(tmp_path / name)
        assert glb.errors(tmp_path / name) == []
        read.append(glb.Gltf(tmp_path / name))
    return read


def test_small_vertices_are_where_the_large_ones_are(tmp_path):
    read, large = small(tmp_path, some_tree())
    assert read.json["extensionsRequired"] == ["KHR_mesh_quantization"]
    for name in ("cube_LOD0", "cube_LOD1"):
        (found,), (expected,) = read.skinned(read.node(name)), large.skinned(large.node(name))
        assert np.abs(found - expected).max() <= 0.51 / 32767  # half a step of a metre
        _, triangles = read.welded(read.node(name))
        assert glb.is_closed(triangles)
    (primitive,) = read.primitives(read.node("cube_LOD0"))
    kinds = {name: array.dtype for name, array in read.attributes(primitive).items()}
    assert kinds["POSITION"] == np.int16 and kinds["NORMAL"] == np.int8
    assert kinds["TEXCOORD_0"] == np.uint16 and kinds["WEIGHTS_0"] == kinds["JOINTS_0"] == np.uint8
    assert read.array(primitive["attributes"]["WEIGHTS_0"]).sum(axis=1).tolist() == [255] * 24


def test_the_decoder_reads_the_specifications_example():
    data = bytes.fromhex("175ff0bc77a9210034b5")
    codes, end = meshopt._group(data, 0, 2)
    deltas = [~(code >> 1) if code & 1 else code >> 1 for code in codes]
    assert deltas == [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0] and end == 10


@pytest.mark.parametrize("count, stride", [(1, 4), (16, 4), (257, 8), (600, 16), (300, 64), (40, 256)])
@pytest.mark.parametrize("spread", [0, 1, 4, 40, 255])
def test_compressed_rows_come_back(count, stride, spread):
    rng = np.random.default_rng(count + spread)
    rows = np.cumsum(rng.integers(0, spread + 1, (count, stride)) - spread // 2, axis=0).astype(np.uint8)
    packed = compression.attributes(rows)
    assert meshopt.decoded(packed, "ATTRIBUTES", count, stride) == rows.tobytes()
    assert spread > 0 or len(packed) <= 1 + max(32, stride) + stride * (2 + count // 64)


def same_triangles(a, b):
    """Whether triangles (T, 3) are equal up to cyclic order of corners."""
    turned = [np.array([np.roll(t, -t.argmin()) for t in one]) for one in (a, b)]
    return np.array_equal(*turned)


@pytest.mark.parametrize("seed", range(4))
def test_compressed_triangles_come_back(seed):
    rng = np.random.default_rng(seed)
    strip = np.array([(k, k + 1, k + 2) if k % 2 == 0 else (k + 1, k, k + 2) for k in range(500)])
    corners = {
        0: strip,  # one byte each
        1: np.sort(rng.choice(2000, (800, 3)), axis=1),
        2: rng.permutation(strip)[:, rng.permutation(3)],
        3: np.concatenate([rng.permutation(40)[None, :3] for _ in range(900)]),
    }[seed]
    packed = compression.triangles(corners.astype(np.uint32).reshape(-1))
    found = np.frombuffer(meshopt.decoded(packed, "TRIANGLES", corners.size, 4), np.uint32).reshape(-1, 3)
    assert same_triangles(found.astype(int), corners)
    assert seed != 0 or len(packed) < 1.1 * len(corners) + 20


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_compressed_file_has_the_same_meshes(tmp_path, suffix):
    tree = some_tree()
    for name, compressed in (("small", False), ("packed", True)):
        document = tree_file.build(tree, quantised=True, compressed=compressed)
        path = tmp_path / (name + suffix)
        document.write_glb(path) if suffix == ".glb" else document.write_separate(path)
        assert glb.errors(path) == []
    small, packed = (glb.Gltf(tmp_path / (name + suffix)) for name in ("small", "packed"))
    assert packed.json["buffers"][1]["extensions"] == {"EXT_meshopt_compression": {"fallback": True}}
    assert "EXT_meshopt_compression" in packed.json["extensionsRequired"]
    for name in ("cube_LOD0", "cube_LOD1"):
        for one, other in zip(small.primitives(small.node(name)), packed.primitives(packed.node(name))):
            given, found = small.attributes(one), packed.attributes(other)
            assert all(np.array_equal(given[key], found[key]) for key in given)
            corners = [g.array(p["indices"]).reshape(-1, 3) for g, p in ((small, one), (packed, other))]
            assert same_triangles(*corners)


def test_weights_of_eight_bits_sum_to_one():
    shares = np.random.default_rng(1).dirichlet(np.ones(4), 1000)
    found = quantise.weights(shares)
    assert (found.sum(axis=1, dtype=int) == 255).all()
    assert np.abs(found / 255 - shares).max() < 2.5 / 255


def test_tiling_coordinates_stay_floats():
    assert quantise.texture_coordinates(np.float32([(0, 1), (0.5, 0)])).dtype == np.uint16
    assert quantise.texture_coordinates(np.float32([(0, 1.5)])).dtype == np.float32


@pytest.mark.parametrize("quantised", [False, True])
def test_motion_turns_the_joints_that_move(tmp_path, quantised):
    tree = some_tree()
    turns = np.zeros((5, 2, 4))
    turns[..., 3] = 1.0
    # The tip turns about its own Z axis, by up to 0.4 radians.
    angle = 0.4 * np.sin(np.linspace(0, 2 * np.pi, 5))
    turns[:, 1, 2], turns[:, 1, 3] = np.sin(angle / 2), np.cos(angle / 2)
    tree.motion = tree_data.Motion(np.linspace(0, 2, 5), turns)
    path = tmp_path / "t.glb"
    tree_file.build(tree, quantised=quantised).write_glb(path)
    assert glb.errors(path) == []
    read = glb.Gltf(path)
    (animation,) = read.json["animations"]
    (channel,) = animation["channels"]  # the root does not move
    tip = read.node("tip")
    assert read.json["nodes"][channel["target"]["node"]] is tip
    assert read.array(animation["samplers"][0]["input"])[:, 0].tolist() == [0, 0.5, 1, 1.5, 2]
    keys = read.values(animation["samplers"][0]["output"])
    for key, by in zip(keys, angle):
        tip["rotation"] = key.tolist()
        world = read.world_matrices()[read.json["nodes"].index(tip)]
        # At rest its X axis is Blender's Y, which is -Z in the file; it turns towards Blender's -X.
        assert world[:3, 0] == pytest.approx((-np.sin(by), 0, -np.cos(by)), abs=1e-4)


def some_cards():
    points = np.float32([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)])
    texture = tree_data.Texture("cards", PNG, "image/png")
    material = tree_data.Material("cards", base=texture, cutoff=0.5)
    normals = np.tile(np.float32((0, -1, 0)), (4, 1))
    uv, triangles = np.clip(points[:, (0, 2)], 0, 1), np.array([(0, 1, 2), (0, 2, 3)])
    return tree_data.Cards("tree_LOD2", points, normals, uv, triangles, material)


def test_cards_replace_the_parts_and_the_snow(tmp_path):
    tree = some_tree()
    tree.parts.append(tree_data.Part("leaves", [leaves_surface(4)] * 2, [tree_data.Material("leaf")]))
    tree.snow_meshes.append(tree_data.SnowMesh("snow", np.eye(3, dtype=np.float32), np.array([(0, 1, 2)])))
    tree.cards = some_cards()
    for read in small(tmp_path, tree):
        bark, leaves, snow = (read.lods(read.node(name)) for name in ("cube_LOD0", "leaves_LOD0", "snow"))
        assert [node["name"] for node in bark] == ["cube_LOD0", "cube_LOD1", "tree_LOD2"]
        assert "mesh" in bark[2] and "skin" not in bark[2]
        assert leaves[2] == {"name": "leaves_LOD2"} and "mesh" not in snow[1]
        # All change to the cards at the same size on the screen.
        ends = [nodes[0]["extras"]["MSFT_screencoverage"] for nodes in (bark, leaves, snow)]
        assert ends[0] == ends[1] and ends[0][1:] == ends[2]
        world = read.world_matrices()[read.json["nodes"].index(bark[2])]
        place = read.array(read.primitives(bark[2])[0]["attributes"]["POSITION"])
        found = place @ world[:3, :3].T + world[:3, 3]
        assert found == pytest.approx(tree.cards.points[:, (0, 2, 1)] * (1, 1, -1), abs=1e-3)


def test_equal_input_gives_equal_bytes(tmp_path):
    for name in ("a.glb", "b.glb"):
        tree_file.build(some_tree()).write_glb(tmp_path / name)
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_what_is_no_number_is_refused():
    tree = some_tree()
    tree.parts[0].levels[0].points[3] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        tree_file.build(tree)


def test_the_reader_sees_what_is_wrong(tmp_path):
    """Each rule detects errors: a file with one changed number breaks it."""
    path = tmp_path / "t.gltf"
    tree_file.build(some_tree()).write_separate(path)

    def broken(change):
        whole = json.loads(path.read_text())
        change(whole)
        other = tmp_path / "broken.gltf"
        other.write_text(json.dumps(whole))
        return " ".join(glb.errors(other))

    def position(whole):
        return whole["accessors"][whole["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]

    assert "3.6.2.5: max" in broken(lambda w: position(w).update(max=[9, 9, 9]))
    assert "without bounds" in broken(lambda w: position(w).pop("min"))
    assert "not aligned" in broken(lambda w: w["bufferViews"][position(w)["bufferView"]].update(byteOffset=2))
    assert "two parents" in broken(lambda w: w["nodes"][0]["children"].append(2))
    assert "MSFT_lod" in broken(lambda w: w.pop("extensionsUsed"))
    assert "not of unit length" in broken(lambda w: w["nodes"][1].update(rotation=[0, 0, 0, 2]))
