# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for tests of the bake, and their maps read back."""

import hashlib
import json
import math
from pathlib import Path

import bpy
import numpy as np


def mesh_object(name, vertices, faces, uv=None):
    """A mesh object in the scene; uv: one pair a corner, in the order of the faces."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    if uv is not None:
        layer = mesh.uv_layers.new(name="snow")
        for corner, pair in zip(layer.data, uv):
            corner.uv = pair
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def square(name, size=2.0, z=0.0, x=0.0):
    """A level square facing up whose UV map fills the whole map: u along X, v along Y."""
    h = size / 2
    return mesh_object(
        name,
        [(x - h, -h, z), (x + h, -h, z), (x + h, h, z), (x - h, h, z)],
        [(0, 1, 2, 3)],
        [(0, 0), (1, 0), (1, 1), (0, 1)],
    )


def key(obj, path, *values):
    """Keyframes (frame, value) with linear interpolation."""
    for frame, value in values:
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)


def instance_of(collection, name="Empty"):
    """A new empty that instances a collection."""
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    return empty


def instanced(*objects, name="Empty"):
    """Moves objects into a collection of their own, and returns an empty that instances it."""
    collection = bpy.data.collections.new("Set")
    for obj in objects:
        collection.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    return instance_of(collection, name)


def receive(*objects, resolution=64):
    """Adds objects to the list of receivers."""
    for obj in objects:
        entry = bpy.context.scene.snowbough.receivers.add()
        entry.object = obj
        entry.resolution = resolution


def settings(folder, frames=(1, 4), **values):
    """The scene's snow settings for a quick, sharp bake into `folder`."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = frames
    own = scene.snowbough
    own.cache_directory = str(folder)
    own.pixel_size = 0.02
    own.flutter = 0.0
    own.blur_radius = 0.0
    own.repose = math.pi / 2  # snow stays where it fell, at rims too
    own.end_depth = 0.1
    for name, value in values.items():
        setattr(own, name, value)
    return own


def bake(**arguments):
    bpy.ops.snowbough.bake(**arguments)
    cache = bpy.path.abspath(bpy.context.scene.snowbough.cache_directory)
    for ledger in Path(cache).glob("*/v*/ledger.json"):
        assert_balanced(json.loads(ledger.read_text())["frames"])


def assert_balanced(rows):
    """All snow of a ledger that ever fell is somewhere, on every frame."""
    for row in rows:
        kept = math.fsum(row[name] for name in row.keys() - {"frame", "depth", "fallen", "stretched"})
        fallen = row["fallen"] + row["stretched"]
        assert abs(kept - fallen) <= 1e-6 * row["fallen"] + 1e-12, row


def bake_part(addon, first=None, last=None, objects=(), resume=False, on_frame=None, **options):
    """A bake of a part of the shot, with more options of make_request(); returns the RunningBake."""
    scene, from_scene = bpy.context.scene, addon("bake.from_scene")
    request = from_scene.make_request(scene, resume, first, last, objects, **options)
    running = from_scene.prepare_bake(scene, request, on_frame)
    addon("bake.engine").run(bpy.context, running)
    return running


def bake_twice(addon, folder, last):
    """The files of a whole bake, which one that stopped after frame `last` and was resumed has, too."""
    bake()
    whole = files_of(folder / "whole")
    bpy.context.scene.snowbough.cache_directory = str(folder / "parts")
    bake_part(addon, last=last)
    bake(resume=True)
    assert files_of(folder / "parts") == whole
    return whole


def warnings(addon, depsgraph=None):
    """The warnings that a bake on the command line prints."""
    scene, depsgraph = bpy.context.scene, depsgraph or bpy.context.evaluated_depsgraph_get()
    issues = addon("bake.preflight").of_bake(scene, depsgraph)
    return [issue.text for issue in issues if issue.severity == "WARNING"]


def folder_of(root, name, version=1, scene="Scene"):
    """The folder of the receiver `name`."""
    found = sorted(Path(root).glob(f"{scene}*/v{version:03d}/{name}-*"))
    assert len(found) == 1, found
    return found[0]


def manifest_of(root, name, version=1):
    """A receiver's object.json, with the entries of frames.tsv as ``frames``."""
    folder = folder_of(root, name, version)
    lines = (folder / "frames.tsv").read_text(encoding="utf-8").splitlines()[1:]
    return {
        **json.loads((folder / "object.json").read_text(encoding="utf-8")),
        "frames": [json.loads(line.split("\t")[1]) for line in lines],
    }


def height(native, root, name, frame, version=1):
    return native.read_exr(str(folder_of(root, name, version) / f"height_{frame:04d}.exr"))[0]


def files_of(root):
    """{relative path: digest of its bytes} of a cache, without the logs and the name of the .blend."""
    root = Path(root)
    return {
        path.relative_to(root).as_posix(): hashlib.blake2b(path.read_bytes(), digest_size=8).hexdigest()
        for path in sorted(root.rglob("*"))
        if path.is_file() and "logs" not in path.parts and path.name != "owner.json"
    }


def strip(name, cells, upright=False):
    """A row of quads from x = 0 to 1.5 at y = -1.5: level and 0.5 m wide, or upright and 0.2 m high."""
    step = (0.0, 0.0, 0.2) if upright else (0.0, 0.5, 0.0)
    points = [
        (1.5 * i / cells, -1.5 + step[1] * j, 0.5 + step[2] * j) for j in range(2) for i in range(cells + 1)
    ]
    faces = [(i, i + 1, i + cells + 2, i + cells + 1) for i in range(cells)]
    uv = [p for i in range(cells) for p in
          ((i / cells, 0), ((i + 1) / cells, 0), ((i + 1) / cells, 1), (i / cells, 1))]  # fmt: skip
    return mesh_object(name, points, faces, uv)


def bend(obj, cells, *keys):
    """Lets an armature bend and stretch a strip, which is therefore not rigid. keys: (frame, radians)."""
    bone = bpy.data.objects.new("Bone", bpy.data.armatures.new("Bone"))
    bpy.context.scene.collection.objects.link(bone)
    bpy.context.view_layer.objects.active = bone
    bpy.ops.object.mode_set(mode="EDIT")
    edit = bone.data.edit_bones.new("Bone")
    edit.head, edit.tail = (0, -1.5, 0.5), (1.5, -1.5, 0.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    group = obj.vertex_groups.new(name="Bone")
    for i in range(cells + 1):
        group.add([i, i + cells + 1], i / cells, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = bone
    pose = bone.pose.bones["Bone"]
    pose.rotation_mode = "XYZ"
    for frame, angle in keys:
        pose.rotation_euler = (0, angle, 0)
        pose.keyframe_insert("rotation_euler", frame=frame)


def moving_scene(folder, frames=(1, 12), **values):
    """A ground, a cart that drives over it, a flag, shaded smooth, that an armature bends: all three receive."""
    ground = square("Ground", 4.0)
    cart = square("Cart", 1.0, z=1.0)
    key(cart, "location", (frames[0], (-1.0, 0.0, 0.0)), (frames[1], (1.0, 0.0, 0.0)))
    cells = 4
    flag = strip("Flag", cells, upright=True)
    flag.data.polygons.foreach_set("use_smooth", [True] * cells)
    bend(flag, cells, (frames[0], 0.0), (frames[1], -1.0))
    receive(ground, cart, flag)
    settings(folder, frames, **{"checkpoint_interval": 4, "repose": math.radians(65.0), **values})
    return ground, cart, flag


def texel(map_, u, v):
    """Mean of 5 x 5 texels around (u, v), row 0 = v 0: single texels hold a whole number of pixels."""
    row, column = int(v * map_.shape[0]), int(u * map_.shape[1])
    return float(np.mean(map_[row - 2 : row + 3, column - 2 : column + 3]))


def open_ground(map_):
    """Mean height of a map away from its border."""
    return float(np.mean(map_[8:-8, 8:-8]))


def node_tree():
    """A tree with one geometry in and one out: (tree, input node, output node)."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        for in_out in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    return tree, tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")


def instance_geometry(tree, obj):
    """The output of a new node of the tree that has an object as an instance."""
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = obj
    info.inputs["As Instance"].default_value = True
    return info.outputs["Geometry"]


def issues(addon, severity):
    """The texts of the bake's check of the scene."""
    found = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    return "\n".join(issue.text for issue in found if issue.severity == severity)


def write_library(path, name):
    """Writes a square of that name into a file of its own, and removes it from the scene."""
    path.parent.mkdir(parents=True, exist_ok=True)
    obj = square(name)
    bpy.data.libraries.write(str(path), {obj})
    bpy.data.objects.remove(obj)


def link(library, name):
    """Links an object of a .blend into the scene."""
    with bpy.data.libraries.load(str(library), link=True, relative=True) as (_, linked):
        linked.objects = [name]
    bpy.context.scene.collection.objects.link(linked.objects[0])
    return linked.objects[0]
