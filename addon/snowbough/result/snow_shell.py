# SPDX-License-Identifier: GPL-3.0-or-later
"""A snow shell: an object of its own whose geometry nodes lay the baked height over a receiver (shell_nodes).

It stands at the world's origin, whatever the receiver does, and reads the receiver's mesh as the frame has it. An
instanced collection gets one shell for each mesh in it that has a map of its own.
"""

import math
from dataclasses import dataclass

import bpy
import numpy as np

from .. import compat, compat_nodes
from ..names import SHELL_MODIFIER
from ..scene.pose import metres_per_unit
from . import (
    baked_images,
    cushion_nodes,
    look,
    original_state,
    rest_position,
    shell_material,
    shell_nodes,
    shell_sliders,
    snow_material,
)
from .shell_nodes import ShellSource
from .shell_pieces import MOST_CORNERS

TREE_PREFIX = "Snowbough Shell"

# Faces are about as large as two texels of the map, but fine enough for relief (metres).
TEXELS_PER_FACE = 2.0
FINEST_RELIEF = 0.006
# Long faces are cut until their longer side is no more than so many times that.
LONGEST_SIDE = 3.0
# A layout fills about this share of its map.
FILLED_SHARE = 0.6
MAX_LEVEL = 11
MAX_FACES_RENDER = 1_000_000
MAX_FACES_VIEWPORT = 120_000
# Edges at which split normals that cannot be read are taken for sharp (radians).
USUAL_SHARP_ANGLE = math.radians(30.0)


@dataclass
class _Member:
    """A mesh that carries snow: the receiver itself, or one of the collection that it instances."""

    obj: bpy.types.Object
    folder: str
    instancer: bpy.types.Object = None


# --------------------------------------------------------------------------------------------------
# What the nodes need to know of a mesh


def _evaluated_mesh(obj):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return evaluated.data if evaluated.type == "MESH" else obj.data


def _area(mesh, scale):
    areas = np.empty(len(mesh.polygons), dtype=np.float32)
    mesh.polygons.foreach_get("area", areas)
    return float(areas.sum(dtype=np.float64)) * scale * scale


def _long_side(mesh, scale):
    """The longer side of the mesh's faces in metres, on average over its surface."""
    ends = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    positions = compat.read_positions(mesh)
    lengths = np.linalg.norm(positions[ends[:, 0]] - positions[ends[:, 1]], axis=1)
    of_corner = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("edge_index", of_corner)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    areas = np.empty(len(mesh.polygons), dtype=np.float32)
    mesh.polygons.foreach_get("area", areas)
    longest = np.maximum.reduceat(lengths[of_corner], starts)
    return float(np.average(longest, weights=areas + 1e-20)) * scale


def _corners(mesh):
    """How many corners the mesh's faces have with their collars."""
    sides = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_total", sides)
    return int(sides.sum() + 4 * sides[sides > MOST_CORNERS].sum())


def face_levels(corners, area, long_side, wanted):
    """((levels in the viewport, in renders), size of a face in renders in metres) of a mesh.

    area: m2; long_side: of its faces, wanted: size of a face, metres. The first subdivision gives a face for every
    corner, each further one four for one.
    """
    by_area = 1.5 + math.log(max(area / (wanted * wanted * max(corners, 1)), 1e-9), 4.0)
    by_side = 0.5 + math.log(max(long_side / (LONGEST_SIDE * wanted), 1e-9), 2.0)

    def level(most):
        affordable = 1 + int(math.log(max(most / max(corners, 1), 0.25), 4.0))
        return max(0, min(math.floor(max(by_area, by_side)), MAX_LEVEL, affordable))

    render = level(MAX_FACES_RENDER)
    size = math.sqrt(area / (max(corners, 1) * 4.0 ** (render - 1)))
    return (min(level(MAX_FACES_VIEWPORT), render), render), max(size, long_side / 2.0**render / 2.0)


def _sharp_angle(mesh):
    """The angle over which an edge is sharp; more than pi where only marks count."""
    if not getattr(mesh, "use_auto_smooth", False):  # from 4.1 on marks are all there is, and nodes read them
        return 4.0
    if mesh.has_custom_normals or any(edge.use_edge_sharp for edge in mesh.edges):
        return min(mesh.auto_smooth_angle, USUAL_SHARP_ANGLE)
    return mesh.auto_smooth_angle


def _are_needles(mesh, scale, depth):
    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges.ravel())
    return cushion_nodes.are_needles(compat.read_positions(mesh) * scale, edges, depth)


def _has_split_points(mesh):
    """Whether faces that meet have points of their own there, so that snow would tear."""
    positions = compat.read_positions(mesh)
    if not len(positions):
        return False
    grid = np.round(positions / max(1e-7, float(np.abs(positions).max()) * 1e-6)).astype(np.int64)
    return len(np.unique(grid, axis=0)) < len(grid)


def source_of(scene, obj, uv_map, image, size, material, relief=True, **more):
    """The ShellSource of an object with an image of `size` texels. relief: with faces that are fine enough for it."""
    mesh = _evaluated_mesh(obj)
    scale = metres_per_unit(scene)
    average = abs(obj.matrix_world.determinant()) ** (1.0 / 3.0)
    area = _area(mesh, average * scale)
    texel = math.sqrt(area / FILLED_SHARE) / size if size else FINEST_RELIEF
    wanted = min(TEXELS_PER_FACE * texel, FINEST_RELIEF) if relief else texel
    levels, face_size = face_levels(_corners(mesh), area, _long_side(mesh, average * scale), wanted)
    return ShellSource(
        obj=obj,
        uv_map=uv_map,
        image=image,
        texel=1.0 / size if size else 0.0,
        material=material,
        levels=levels,
        face_size=face_size if relief else math.inf,
        metres_per_unit=scale,
        sharp_angle=_sharp_angle(mesh),
        weld=_has_split_points(mesh),
        **more,
    )


# --------------------------------------------------------------------------------------------------
# The objects


def make_object(scene, name, tree, material, collection):
    """An object with that node tree as its modifier, in that collection; bakes leave it out."""
    shell = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    shell.snowbough.is_shell = True
    shell.snowbough.occlude = False
    shell.lock_location = shell.lock_rotation = shell.lock_scale = (True,) * 3  # the nodes count on it
    shell.data.materials.append(material)
    shell.modifiers.new(SHELL_MODIFIER, "NODES").node_group = tree
    look.set_shell_relief(shell, look.of(scene))
    collection.objects.link(shell)
    return shell


def delete_object(shell):
    """Deletes a shell with its mesh, nodes and material."""
    mesh = shell.data
    trees = [modifier.node_group for modifier in shell.modifiers if modifier.type == "NODES"]
    materials = [slot.material for slot in shell.material_slots]
    bpy.data.objects.remove(shell)
    bpy.data.meshes.remove(mesh)
    for tree in trees:
        if tree is not None:
            bpy.data.node_groups.remove(tree)
    for material in materials:
        if material is not None and material.users == 0:
            bpy.data.materials.remove(material)


def _home(scene, obj):
    homes = [collection for collection in obj.users_collection if collection.library is None]
    return homes[0] if homes else scene.collection


def _members(receiver):
    """The _Members of a receiver that have baked maps."""
    obj = receiver.object
    if obj.type == "MESH":
        return [_Member(obj, receiver.folder)]
    folders = baked_images.folders_of_members(receiver.folder, obj.name)
    found = []
    for member in obj.instance_collection.all_objects if obj.instance_collection else ():
        folder = folders.get((member.name, member.library.filepath if member.library else ""))
        if member.type == "MESH" and folder is not None:
            found.append(_Member(member, folder, obj))
    return found


def _wants_cushions(source, notes):
    """Whether snow shall bridge what the source is made of: needles, and not too many of them, which `notes` gets to
    know."""
    mesh = _evaluated_mesh(source.obj)
    metres = source.metres_per_unit * abs(source.obj.matrix_world.determinant()) ** (1.0 / 3.0)
    points = _corners(mesh) * 4.0 ** (source.levels[1] - 1)
    deepest = max(depth for _, depth in source.depths)
    if not _are_needles(mesh, metres, deepest):
        return False
    if points > cushion_nodes.MOST_POINTS:
        notes.append(
            f"{source.obj.name} has needles, but snow does not bridge them: its shell has "
            f"{points / 1e6:.1f} million points, and beyond {cushion_nodes.MOST_POINTS / 1e6:.1f} a frame would take "
            f"minutes. Split it, or raise the shell's slider {cushion_nodes.CUSHIONS_INPUT} all the same"
        )
        return False
    return True


def _make_one(scene, receiver, member, record, notes):
    """The shell of one member, or None where nothing is baked."""
    height = baked_images.load_sequence(member.folder, "height")
    if height is None:
        return None
    uv_map = baked_images.baked_uv_map(member.folder) or snow_material.uv_map_name(receiver)
    if not uv_map:
        raise ValueError(
            f"{member.obj.name} has no UV map: add one, or use Add Snow to Selected, which makes it"
        )
    name = f"{member.obj.name} snow"
    material = shell_material.make_material(scene, name)
    source = source_of(
        scene, member.obj, uv_map, height.image, height.size, material,
        rest=rest_position.keep(member.obj, record), frames=height,
        covered=baked_images.load_ever_covered(member.folder), instancer=member.instancer,
        depths=baked_images.baked_depths(member.folder),
    )  # fmt: skip
    tree = shell_nodes.build_tree(f"{TREE_PREFIX} {member.obj.name}", source)
    bridged = bool(source.depths) and _wants_cushions(
        source, notes
    )  # asked before there is a shell to evaluate
    shell = make_object(scene, name, tree, material, _home(scene, receiver.object))
    if bridged:
        compat_nodes.set_modifier_input(shell.modifiers[SHELL_MODIFIER], cushion_nodes.CUSHIONS_INPUT, 1.0)
    shell_sliders.note(shell)
    return shell


def make(scene, receiver, sliders=None, notes=None):
    """Makes the receiver's shells from its baked files and links them beside the receiver.

    sliders: what sliders_of said of those before. notes: a list that gets what the artist should know.
    Returns the shells, none where nothing is baked yet. Raises ValueError without a UV map.
    """
    record = original_state.read(receiver)
    notes = [] if notes is None else notes
    shells = [_make_one(scene, receiver, member, record, notes) for member in _members(receiver)]
    shells = [shell for shell in shells if shell is not None]
    for shell in shells:
        if sliders and shell.name in sliders:
            shell_sliders.put_back(shell, sliders[shell.name])
    record["shells"] = [shell.name for shell in shells]
    original_state.write(receiver, record)
    return shells


def find(receiver):
    """The receiver's shells that are still there."""
    record = original_state.read(receiver)
    # The first versions knew one shell a receiver.
    names = [*record.get("shells", ()), *([record["shell"]] if "shell" in record else [])]
    return [bpy.data.objects[name] for name in names if name in bpy.data.objects]


def sliders_of(receiver):
    """{name: its sliders that an artist has set} of the receiver's shells."""
    return {shell.name: shell_sliders.touched(shell) for shell in find(receiver)}


def remove(receiver):
    """Deletes the receiver's shells with their meshes, nodes and materials."""
    shells = find(receiver)
    record = original_state.read(receiver)
    for key in ("shell", "shells"):
        record.pop(key, None)
    rest_position.release(record)
    original_state.write(receiver, record)
    for shell in shells:
        delete_object(shell)


def freeze(scene, receiver, depsgraph):
    """The snow of the receiver as it is in the evaluated frame, as plain mesh objects.

    Works from whatever displacement the receiver has; a receiver without a shell gets one for the
    moment. Returns the new objects, linked beside the receiver; none where nothing is baked.
    """
    shells = find(receiver)
    temporary = not shells
    shells = shells or make(scene, receiver)
    depsgraph.update()
    frozen = []
    for shell in shells:
        evaluated = shell.evaluated_get(depsgraph)
        name = f"{shell.name} {scene.frame_current:04d}"
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)
        mesh.name = name
        plain = bpy.data.objects.new(name, mesh)
        for collection in shell.users_collection:
            collection.objects.link(plain)
        frozen.append(plain)
    if temporary:
        remove(receiver)
    return frozen
