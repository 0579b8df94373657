# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps that export an imported tree of the scene for a game engine: find the tree, read its bones and meshes, add
levels of detail, write the baked snow, write the tree.
"""

import re
from pathlib import Path

import numpy as np

from ..base.names import counted
from ..tree.import_options import BY_DETAIL
from ..tree.import_tree import LOD_PROPERTY
from . import levels, scene_materials, scene_snow, scene_tree, tree_file
from .surface import transformed
from .thinning import thinned_leaves

SUFFIXES = (".glb", ".gltf")


def checked_path(path):
    """The Path of the tree's file. Raises ValueError for a wrong suffix or a missing folder."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{path.name} must end in {' or '.join(SUFFIXES)}")
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    return path


def _stems(points, joints, rig):
    """float64 (V, 3): for each point the nearest position on its bone, in armature space."""
    heads, tails = scene_tree.bone_segments(rig)
    head, along = heads[joints], (tails - heads)[joints]
    t = ((points - head) * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-30)
    return head + np.clip(t, 0.0, 1.0)[:, None] * along


def _bark_part(tree, options, linear, warnings):
    found = [scene_tree.surface_of(bark, tree.rig, scene_tree.BARK_MAPS) for bark in tree.barks]
    lods = [int(bark.get(LOD_PROPERTY, BY_DETAIL)) for bark in tree.barks]
    found = levels.complete(found, lods, options.levels, tree.rig, warnings)
    materials = scene_materials.of_object(tree.barks[0], scene_tree.BARK_MAPS, False, warnings)
    name = re.sub(r"_LOD\d+$", "", tree.barks[0].name)
    return tree_file.Part(name, [transformed(surface, linear) for surface in found], materials)


def _leaf_part(leaves, tree, count, options, linear, warnings):
    surface = scene_tree.surface_of(leaves, tree.rig, scene_tree.LEAF_MAPS)
    stems = _stems(surface.points, surface.joints[:, 0], tree.rig)
    found = [thinned_leaves(surface, options.leaf_share**level, stems) for level in range(count)]
    materials = scene_materials.of_object(leaves, scene_tree.LEAF_MAPS, True, warnings)
    return tree_file.Part(leaves.name, [transformed(one, linear) for one in found], materials)


def _one_level(tree, level):
    """A copy of the Tree with only one level of detail."""
    parts = [tree_file.Part(p.name, p.levels[level : level + 1], p.materials) for p in tree.parts]
    name = f"{tree.name}_LOD{level}"
    return tree_file.Tree(name, tree.joints, parts, tree.branch_levels, tree.extras, tree.heaps)


def _write(document, path):
    return document.write_glb(path) if path.suffix.lower() == ".glb" else document.write_separate(path)


def _write_tree(tree, path, options):
    """Writes one file, or one file per level. Returns all paths."""
    if not options.file_per_level:
        return _write(tree_file.build(tree), path)
    written = []
    for level in range(len(tree.parts[0].levels)):
        file = path.with_name(f"{path.stem}_LOD{level}{path.suffix}")
        written += _write(tree_file.build(_one_level(tree, level), level), file)
    return written


def export(context, obj, path, options):
    """Writes the tree that `obj` is part of to `path` (.glb or .gltf), and additional files beside it.

    Returns the report: ``tree``, ``files`` (all written files), ``levels`` (triangles of each part, the finest level
    first), ``heaps`` (triangles of each snow surface), ``bones``, ``snow`` (see scene_snow.write) and ``warnings``.
    Raises ValueError if `obj` is not part of a tree, RuntimeError if a file cannot be written.
    """
    path = checked_path(path)
    tree = scene_tree.find(obj)
    scene, warnings = context.scene, []
    linear = scene_tree.linear_part(tree.rig, scene.unit_settings.scale_length)
    joints = scene_tree.joints_of(tree.rig, linear)
    bark = _bark_part(tree, options, linear, warnings)
    count = len(bark.levels)
    parts = [bark, *(_leaf_part(leaves, tree, count, options, linear, warnings) for leaves in tree.leaves)]

    snow, files, heaps = {}, [], []
    objects = {bark.name: tree.barks[0], **{leaves.name: leaves for leaves in tree.leaves}}
    if options.snow == "SURFACE":
        to_file = np.eye(4)
        to_file[:3, :3] = linear
        to_rig = tree.rig.matrix_world.inverted()
        heaps = scene_snow.surfaces(
            scene, objects, lambda obj: to_file @ np.array(to_rig @ obj.matrix_world), warnings
        )
    elif options.snow != "NONE":
        snow, files = scene_snow.write(scene, objects, path, options, warnings)
    branch_levels = 1 + max(int(surface.level.max()) for surface in bark.levels)
    extras = {"snow": snow} if snow else {}
    whole = tree_file.Tree(tree.rig.name, joints, parts, branch_levels, extras, heaps)
    files = [*_write_tree(whole, path, options), *files]
    return {
        "tree": tree.rig.name,
        "files": [str(file) for file in files],
        "levels": [
            {part.name: len(part.levels[level].triangles) for part in parts} for level in range(count)
        ],
        "heaps": {heap.name: len(heap.triangles) for heap in heaps},
        "bones": len(joints),
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
