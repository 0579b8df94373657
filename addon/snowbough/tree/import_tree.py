# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports OBJ files as rigged, weighted, unwrapped meshes in the scene, one collection per file.

The native part is computed first (:mod:`native_tree`); it can run in another thread and be stopped. Then the
data-blocks are made (:func:`create_trees`). So invalid input or Esc leaves Blender unchanged.
"""

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

from ..base import compat, native
from ..base.names import BARK_UV, FAILURES, LEAF_UV, ORIGINAL_UV, SNOW_RESOLUTION_PROPERTY, counted
from ..base.options import options_of
from . import armature, kept_bark, kept_skeleton, materials, objects, textures, thumbnail, wind_attributes
from .import_options import LOD_CHAIN, ImportOptions
from .native_tree import ORIGINAL, read_native

REPORT_PROPERTY = "snowbough_report"
# Share of the file's wood that the limbs represent, for the panel.
COVERAGE_PROPERTY = "snowbough_coverage"
# As in the native module: below this, the report says what is missing.
LOW_COVERAGE = 0.75
LOD_PROPERTY = "snowbough_lod"
# The native module's reason for leaves that an option excludes.
BY_OPTION = "left out by option"
# Trees of one import stand in a row; gap as a share of their widths.
ROW_GAP = 0.1


def _used(sources, chosen, make):
    """Materials for `sources`, and a last one for faces without (-1); None for materials that no face has.

    chosen: arrays of indices into sources; make(source or None) -> material.
    """
    used = {int(index) - 1 for c in chosen for index in objects.used_indices(np.asarray(c) + 1)}
    made = [make(source) if index in used else None for index, source in enumerate(sources)]
    return [*made, make(None) if -1 in used else None]


def _create_bark(name, tree, options, bone_names, check, own):
    """The bark objects, the finest first.

    check: textures.Check; own: materials.OwnMaterials
    """
    meshes = tree.meshes
    uv_map = ORIGINAL_UV if meshes[0].original_uv is not None else BARK_UV
    barks_made = {}
    slots = _used(
        check.readable(tree.skeleton.wood_materials),
        [made.face_material for made in meshes],
        lambda source: (
            own.copy(source, uv_map) or materials.bark_material(f"{name}_bark", source, uv_map, barks_made)
        ),
    )
    barks = []
    for level, made in enumerate(reversed(meshes)):
        bark = objects.create_bark(
            f"{name}_bark{f'_LOD{level}' if options.lod_chain else ''}",
            made.native,
            bone_names,
            slots,
            made.face_material,
            made.original_uv,
        )
        if options.lod_chain:
            bark[LOD_PROPERTY] = LOD_CHAIN.index(made.detail)
        bark.data.snowbough.bark_vertices = len(bark.data.vertices)
        bark[SNOW_RESOLUTION_PROPERTY] = options.snow_resolution
        if options.wind_attributes:
            wind_attributes.add_to_bark(bark.data, tree.skeleton, made.native)
        barks.append(bark)
    return barks


def _create_kept(name, tree, options, bone_names, check, own):
    """The bark object of a tree that keeps its surface."""
    surface, branches = tree.skeleton.kept, tree.skeleton.branches
    uv_map = ORIGINAL_UV if surface.textured else BARK_UV
    barks_made = {}
    slots = _used(
        check.readable(surface.materials),
        [surface.face_material],
        lambda source: (
            own.copy(source, uv_map) or materials.bark_material(f"{name}_bark", source, uv_map, barks_made)
        ),
    )
    levels = [branch.level for branch in branches]
    bark = objects.create_kept(f"{name}_bark", surface, levels, tree.kept, bone_names, slots)
    bark[SNOW_RESOLUTION_PROPERTY] = int(tree.kept.layout["resolution"])
    if options.wind_attributes:
        wind_attributes.add_to_points(bark.data, branches, surface.vertex_branch)
    return bark


def _create_leaves(name, tree, options, bone_names, check, own):
    foliage = tree.skeleton.foliage
    slots = _used(
        check.readable(foliage.materials),
        [foliage.face_material],
        lambda source: own.copy(source, LEAF_UV) or materials.leaf_material(source, f"{name}_leaf"),
    )
    leaves = objects.create_leaves(
        f"{name}_leaves", foliage, tree.leaf_layout["uv"], tree.leaf_bones, bone_names, slots
    )
    leaves[SNOW_RESOLUTION_PROPERTY] = int(tree.leaf_layout["resolution"])
    if options.wind_attributes:
        wind_attributes.add_to_leaves(leaves.data, tree.skeleton)
    return leaves


def _select(context, rig, barks, leaves):
    """Selects the tree: the finest bark, which becomes active, the leaves, and the armature, which moves them all."""
    for other in context.view_layer.objects.selected:
        other.select_set(False)
    for obj in (rig, barks[0], *leaves):
        obj.select_set(True)
    context.view_layer.objects.active = barks[0]


def create_tree(context, title, tree, options, own):
    """Makes collection, armature, bark and leaves; returns the collection. After an error nothing remains."""
    with objects.Ledger():
        if context.object is not None and context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        name = objects.file_title(title, len("_leaves_LOD0"))
        collection = bpy.data.collections.new(name)
        # The armature needs edit mode, which hidden collections prevent; only the scene's own cannot be hidden.
        context.scene.collection.children.link(collection)

        bones = armature.bone_arrays(tree.meshes[0].native)
        rig = armature.create_armature(context, name, bones, collection)
        kept_skeleton.keep(rig.data, tree, options)
        check = textures.Check(tree.report["warnings"])
        if tree.kept is not None:
            barks = [_create_kept(name, tree, options, bones.names, check, own)]
        else:
            kept_bark.keep(rig.data, tree.base, tree.meshes[-1])
            barks = _create_bark(name, tree, options, bones.names, check, own)
        leaves = []
        if tree.leaf_bones is not None:
            leaves.append(_create_leaves(name, tree, options, bones.names, check, own))
        for obj in (*barks, *leaves):
            collection.objects.link(obj)
            objects.bind(obj, rig)
            obj.snowbough.blocks_wind = False
        # Only the finest level of a chain is visible: all levels are in the same place.
        for bark in barks[1:]:
            bark.hide_render = True
            bark.hide_set(True)
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        collection[COVERAGE_PROPERTY] = tree.report["coverage"]
        _select(context, rig, barks, leaves)
        if not options.show_bones:
            compat.hide_bones(rig.data)
        if options.mark_asset:
            thumbnail.mark_asset(collection, summary(tree.report))
        return collection


def _reach(tree):
    """(minimum, maximum) x of a native tree."""
    x = [made.native.vertices[:, 0] for made in tree.meshes]
    if tree.leaf_bones is not None:
        x.append(tree.skeleton.foliage.vertices[:, 0])
    x = np.concatenate(x)
    return float(x.min()), float(x.max())


def create_trees(context, trees, options, own=None):
    """Makes the trees of `trees`, [(Path or name, NativeTree), ...], in a row along X, the first at its place in the
    file; returns their collections. After an error none remains. own: the materials that exist already."""
    collections, made, end = [], [], None
    with objects.Ledger():
        for path, tree in trees:
            title = path.stem if isinstance(path, Path) else path
            collections.append(create_tree(context, title, tree, options, own or materials.OwnMaterials()))
            made += context.view_layer.objects.selected
            low, high = _reach(tree)
            shift = 0.0 if end is None else end + ROW_GAP * (high - low) - low
            end = shift + high + ROW_GAP * (high - low)
            rig = next(obj for obj in collections[-1].objects if obj.type == "ARMATURE")
            # Single precision suffices for this offset, but not for the points around it.
            x, y, z = trees[0][1].skeleton.origin
            rig.location = (x + shift, y, z)
        for obj in made:
            obj.select_set(True)
    return collections


def options_from(operator):
    """The ImportOptions of an operator, with absolute paths."""
    options = options_of(ImportOptions, operator)
    return replace(options, bones=bpy.path.abspath(options.bones))


def units_per_metre(scene):
    """Blender units of a metre."""
    return 1.0 / scene.unit_settings.scale_length


class Failure(NamedTuple):
    path: Path
    error: Exception

    def text(self):
        """The error message, with the name of the file."""
        text = message(self.error)
        return text if self.path.name in text else f"{self.path.name}: {text}"


def read_files(paths, options, progress=None, units_per_metre=1.0):
    """([(path, NativeTree), ...], [Failure, ...]) of several files; see read_native."""
    native.load()  # report a missing module once, not for each file
    trees, failures = [], []
    for number, path in enumerate(paths):

        def step(share, before=number):
            return progress is None or progress((before + share) / len(paths))

        try:
            trees.append((Path(path), read_native(path, options, step, units_per_metre)))
        except FAILURES as error:
            failures.append(Failure(Path(path), error))
    return trees, failures


def import_files(context, paths, options, progress=None):
    """Imports `paths`; returns ([(collection, report), ...], [Failure, ...]). If some files are not trees, the others
    are imported."""
    started = time.perf_counter()
    trees, failures = read_files(paths, options, progress, units_per_metre(context.scene))
    collections = create_trees(context, trees, options)
    seconds = round(time.perf_counter() - started, 4)
    made = []
    for collection, (_path, tree) in zip(collections, trees):
        tree.report["seconds"] = seconds
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        made.append((collection, tree.report))
    return made, failures


def chosen_files(filepath, directory="", names=()):
    """The chosen OBJ files, each once: `names` in `directory`, or else `filepath`. A folder stands for its OBJ
    files."""
    given = [Path(directory) / name for name in names if name] or [Path(filepath)]
    files = []
    for path in given:
        if path.is_dir() and path.name:
            inside = sorted(entry for entry in path.iterdir() if entry.suffix.lower() == ".obj")
            if not inside and len(given) == 1:
                raise ValueError(f"{path} is a folder without OBJ files")
            files += [entry for entry in inside if entry.is_file()]
        else:
            files.append(path)
    return list(dict.fromkeys(files))


def summary(report):
    """The report as one line."""
    levels = "/".join(str(count) for count in report["branches_per_level"])
    faces = " + ".join(str(mesh["faces"]) for mesh in report["meshes"])
    text = (
        f"{report['file']}: {report['form']}, {report['up_axis']} up, "
        f"{counted(report['branches'], 'branch', 'branches')} ({levels}), {report['bones']} of "
        f"{counted(report['bones_found'], 'bone')}, {faces} faces, {counted(report['leaves'], 'leaf', 'leaves')}, "
        f"{report['coverage']:.0%} of the wood"
    )
    for count, noun in (
        (len(report["skipped_parts"]), "skipped part"),
        (len(report["extra_roots"]), "extra root"),
        (len(report["warnings"]), "warning"),
    ):
        text += f", {counted(count, noun)}" if count else ""
    return text


def is_incomplete(report):
    """Whether a rebuilt tree lacks parts of the file's wood. A tree that keeps its surface has them all."""
    return report["coverage"] < LOW_COVERAGE and report["meshes"][0]["detail"] != ORIGINAL


def warning_lines(report):
    """The warnings about a tree, one line each, including parts that were left out without being asked for."""
    left_out = [part for part in report["skipped_parts"] if part["reason"] != BY_OPTION]
    return report["warnings"] + [f"{part['name']} was left out: {part['reason']}" for part in left_out]


def summary_of_all(reports, failures):
    """Several trees in one line."""
    faces = sum(report["meshes"][-1]["faces"] for report in reports)
    branches, leaves = (sum(report[name] for report in reports) for name in ("branches", "leaves"))
    names = ", ".join(report["file"] for report in reports[:5])
    names += f" and {len(reports) - 5} more" if len(reports) > 5 else ""
    text = (
        f"{counted(len(reports), 'tree')}: {names}; {counted(branches, 'branch', 'branches')}, {faces} faces, "
        f"{counted(leaves, 'leaf', 'leaves')}"
    )
    warnings = sum(len(report["warnings"]) for report in reports)
    text += f", {counted(warnings, 'warning')}" if warnings else ""
    return text + (f"; could not import {counted(len(failures), 'file')}" if failures else "")


def message(error):
    """The text of an error for the user; a MemoryError has no text."""
    if isinstance(error, MemoryError):
        return "The tree does not fit into memory: choose a lower detail"
    return str(error)
