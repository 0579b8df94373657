# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps that export an imported tree of the scene: find the tree, read its bones, meshes and motion, add levels of
detail, write the baked snow, write the tree in the format of the file's suffix.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..base.names import counted
from ..tree.import_tree import LOD_PROPERTY
from . import (
    images,
    impostor,
    levels,
    scene_materials,
    scene_motion,
    scene_snow,
    scene_tree,
    tree_data,
    tree_file,
)
from .thinning import thinned_leaves
from .triangle_mesh import transformed


def checked_path(path, suffixes):
    """The Path of the tree's file. Raises ValueError for a wrong suffix or a missing folder."""
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"{path.name} must end in {' or '.join(suffixes)}")
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    return path


def _stems(points, joints, rig):
    """float64 (V, 3): for each point the nearest position on its bone, in armature space."""
    heads, tails = scene_tree.bone_segments(rig)
    head, along = heads[joints], (tails - heads)[joints]
    t = ((points - head) * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-30)
    return head + np.clip(t, 0.0, 1.0)[:, None] * along


def _bark_part(tree, options, linear, maker):
    found = [scene_tree.surface_of(bark, tree.rig, scene_tree.BARK_MAPS) for bark in tree.barks]
    lods = [bark.get(LOD_PROPERTY) for bark in tree.barks]
    found = levels.complete(found, lods, options.levels, tree.rig, maker.warnings)
    materials = maker.of_object(tree.barks[0], scene_tree.BARK_MAPS, False)
    name = re.sub(r"_LOD\d+$", "", tree.barks[0].name)
    return tree_data.Part(name, [transformed(surface, linear) for surface in found], materials)


def _leaf_part(leaves, tree, count, options, linear, maker):
    surface = scene_tree.surface_of(leaves, tree.rig, scene_tree.LEAF_MAPS)
    stems = _stems(surface.points, surface.joints[:, 0], tree.rig)
    found = [thinned_leaves(surface, options.leaf_share**level, stems) for level in range(count)]
    materials = maker.of_object(leaves, scene_tree.LEAF_MAPS, True)
    return tree_data.Part(leaves.name, [transformed(one, linear) for one in found], materials)


def _cards(name, parts, snow_meshes, warnings):
    """The Cards of the finest level; None, with a warning, where the renderer does not work."""

    def pixels_of(material):
        return None if material.base is None else images.decoded(material.base.data)

    try:
        drawn = [(part.levels[0], part.materials, list(map(pixels_of, part.materials))) for part in parts]
        cards, pixels = impostor.draw(name, drawn, snow_meshes, scene_materials.srgb)
    except RuntimeError as error:
        warnings.append(f"the cards of the last level were not drawn: {error}")
        return None
    texture = tree_data.Texture(name, *images.encoded(pixels))
    cards.material = tree_data.Material(name, base=texture, cutoff=scene_materials.CUTOFF)
    return cards


def _one_level(tree, level):
    """A copy of the Tree with only one level of detail; the level after the last is that of the cards."""
    name = f"{tree.name}_LOD{level}"
    if level == len(tree.parts[0].levels):
        return replace(tree, name=name, joints=tree.joints[:1], parts=[], snow_meshes=[], motion=None)
    parts = [replace(part, levels=part.levels[level : level + 1]) for part in tree.parts]
    return replace(tree, name=name, parts=parts, cards=None)


def _write_gltf(tree, path, options):
    """Writes one file, or one file per level. Returns all paths."""

    def write(tree, path, first=0):
        form = options.vertices
        document = tree_file.build(tree, first, form != "FLOAT", form == "COMPRESSED")
        return document.write_glb(path) if path.suffix.lower() == ".glb" else document.write_separate(path)

    if not options.file_per_level:
        return write(tree, path)
    written = []
    for level in range(len(tree.parts[0].levels) + (tree.cards is not None)):
        file = path.with_name(f"{path.stem}_LOD{level}{path.suffix}")
        written += write(_one_level(tree, level), file, level)
    return written


# {suffix: writer}. A writer takes (Tree, path, options) and returns all paths that it has written.
GLTF = {".glb": _write_gltf, ".gltf": _write_gltf}


def export(context, obj, path, options, writers=GLTF):
    """Writes the tree that `obj` is part of to `path`, and additional files beside it. writers: see GLTF.

    Returns the report: ``tree``, ``files`` (all written files), ``levels`` (triangles of each part, the finest level
    first), ``heaps`` (triangles of each snow surface), ``bones``, ``keys`` (poses of the animation), ``snow`` (see
    scene_snow.write) and ``warnings``.
    Raises ValueError if `obj` is not part of a tree, RuntimeError if a file cannot be written.
    """
    path = checked_path(path, writers)
    tree = scene_tree.find(obj)
    scene, warnings = context.scene, []
    linear = scene_tree.linear_part(tree.rig, scene.unit_settings.scale_length)
    joints = scene_tree.joints_of(tree.rig, linear)
    circumference = 2 * np.pi * max(joint.radius for joint in joints)
    maker = scene_materials.Maker(context, circumference, options.texture_size, warnings)
    bark = _bark_part(tree, options, linear, maker)
    count = len(bark.levels)
    parts = [bark, *(_leaf_part(leaves, tree, count, options, linear, maker) for leaves in tree.leaves)]

    snow, files, snow_meshes = {}, [], []
    objects = {bark.name: tree.barks[0], **{leaves.name: leaves for leaves in tree.leaves}}
    if options.snow == "SURFACE":
        to_file = np.eye(4)
        to_file[:3, :3] = linear
        to_rig = tree.rig.matrix_world.inverted()
        snow_meshes = scene_snow.surfaces(
            scene,
            objects,
            lambda obj: to_file @ np.array(to_rig @ obj.matrix_world),
            options.snow_cell,
            warnings,
        )
    elif options.snow != "NONE":
        snow, files = scene_snow.write(scene, objects, path, options, warnings)
    branch_levels = 1 + max(int(surface.level.max()) for surface in bark.levels)
    extras = {"snow": snow} if snow else {}
    whole = tree_data.Tree(tree.rig.name, joints, parts, branch_levels, extras, snow_meshes)
    if options.cards:
        whole.cards = _cards(f"{tree.rig.name}_LOD{count}", parts, snow_meshes, warnings)
    if options.motion:
        whole.motion = scene_motion.motion_of(scene, tree.rig, options, warnings)
    files = [*writers[path.suffix.lower()](whole, path, options), *files]
    return {
        "tree": tree.rig.name,
        "files": [str(file) for file in files],
        "levels": [
            {part.name: len(part.levels[level].triangles) for part in parts} for level in range(count)
        ],
        "heaps": {mesh.name: len(mesh.triangles) for mesh in snow_meshes},
        "bones": len(joints),
        "keys": 0 if whole.motion is None else len(whole.motion.times),
        "snow": snow,
        "warnings": list(dict.fromkeys(warnings)),
    }


def summary(report):
    """A summary of the report in one line."""
    triangles = " / ".join(f"{sum(level.values()):,}" for level in report["levels"])
    count = len(report["warnings"])
    return (
        f"{report['tree']}: {counted(len(report['files']), 'file')}, {counted(report['bones'], 'bone')}, "
        f"{counted(len(report['levels']), 'level')} of {triangles} triangles"
        + (f", {counted(count, 'warning')}" if count else "")
    )
