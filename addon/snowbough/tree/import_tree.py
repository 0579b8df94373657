# SPDX-License-Identifier: GPL-3.0-or-later
"""From OBJ files to rigged, weighted, unwrapped meshes in the scene, one collection a file.

First everything native is computed (:mod:`native_tree`; it can run on another thread and be stopped),
only then Blender's data-blocks are made (:func:`create_trees`): bad input or Esc leaves Blender as it was.
"""

import json
import time
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

from .. import compat, native
from ..names import BARK_UV, FAILURES, ORIGINAL_UV, SNOW_RESOLUTION_PROPERTY
from . import armature, kept_bark, kept_skeleton, materials, objects, textures, thumbnail, wind_attributes
from .import_options import BY_DETAIL, LOD_COUNT
from .native_tree import read_native

REPORT_PROPERTY = "snowbough_report"
LOD_PROPERTY = "snowbough_lod"
# The native module's reason for leaves that an option keeps out.
BY_OPTION = "left out by option"
# Several trees of one import stand in a row, this share of their widths apart.
ROW_GAP = 0.1


def _lod_suffix(lod, chain):
    # Game engines call the finest level LOD0; ours counts up from the four-sided base.
    return f"_LOD{LOD_COUNT - 1 - lod}" if chain else ""


def _used(sources, chosen, make):
    """Materials for `sources` and, last, for faces without (-1): None where no face has it.

    chosen: arrays of indices into sources; make(source or None) -> material.
    """
    used = set(np.unique(np.concatenate([np.asarray(c).reshape(-1) for c in chosen])).tolist())
    made = [make(source) if index in used else None for index, source in enumerate(sources)]
    return [*made, make(None) if -1 in used else None]


def _create_bark(name, tree, options, bone_names, check):
    """The bark objects, the finest first.

    check: textures.Check
    """
    meshes = tree.meshes
    uv_map = ORIGINAL_UV if meshes[0].original_uv is not None else BARK_UV
    slots = _used(
        check.readable(tree.skeleton.wood_materials),
        [made.face_material for made in meshes],
        lambda source: materials.bark_material(f"{name}_bark", source, uv_map),
    )
    barks = []
    for made in reversed(meshes):
        lod = made.fineness.lod
        bark = objects.create_bark(
            f"{name}_bark{_lod_suffix(lod, options.lod_chain)}",
            made.native,
            bone_names,
            slots,
            made.face_material,
            made.original_uv,
        )
        if lod != BY_DETAIL:
            bark[LOD_PROPERTY] = lod
        bark.data.snowbough.bark_vertices = len(bark.data.vertices)
        bark[SNOW_RESOLUTION_PROPERTY] = options.snow_resolution
        if options.wind_attributes:
            wind_attributes.add_to_bark(bark.data, tree.skeleton, made.native)
        barks.append(bark)
    return barks


def _create_leaves(name, tree, options, bone_names, check):
    foliage = tree.skeleton.foliage
    slots = _used(
        check.readable(foliage.materials),
        [foliage.face_material],
        lambda source: materials.leaf_material(source, f"{name}_leaf"),
    )
    leaves = objects.create_leaves(
        f"{name}_leaves", foliage, tree.leaf_layout["uv"], tree.leaf_bones, bone_names, slots
    )
    leaves[SNOW_RESOLUTION_PROPERTY] = int(tree.leaf_layout["resolution"])
    if options.wind_attributes:
        wind_attributes.add_to_leaves(leaves.data, tree.skeleton)
    return leaves


def _select(context, rig, barks, leaves):
    """The finest bark is active; with it are selected the leaves, and the armature, which moves them all."""
    for other in context.view_layer.objects.selected:
        other.select_set(False)
    for obj in (rig, barks[0], *leaves):
        obj.select_set(True)
    context.view_layer.objects.active = barks[0]


def create_tree(context, title, tree, options):
    """Makes collection, armature, bark and leaves; returns the collection. On an error nothing stays."""
    with objects.Ledger():
        if context.object is not None and context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        name = objects.file_title(title, len("_leaves_LOD0"))
        collection = bpy.data.collections.new(name)
        # The scene's own collection cannot be hidden or excluded: the armature needs edit mode there.
        context.scene.collection.children.link(collection)

        bones = armature.bone_arrays(tree.meshes[0].native)
        rig = armature.create_armature(context, name, bones, collection)
        kept_skeleton.keep(rig.data, tree, options)
        kept_bark.keep(rig.data, tree.base, tree.meshes[-1])
        check = textures.Check(tree.report["warnings"])
        barks = _create_bark(name, tree, options, bones.names, check)
        leaves = []
        if tree.leaf_bones is not None:
            leaves.append(_create_leaves(name, tree, options, bones.names, check))
        for obj in (*barks, *leaves):
            collection.objects.link(obj)
            objects.bind(obj, rig)
        # Of a chain only the finest is shown: the others lie in the same place.
        for bark in barks[1:]:
            bark.hide_render = True
            bark.hide_set(True)
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        _select(context, rig, barks, leaves)
        if not options.show_bones:
            compat.hide_bones(rig.data)
        if options.mark_asset:
            thumbnail.mark_asset(collection, summary(tree.report))
        return collection


def _reach(tree):
    """(least, largest) x of a native tree."""
    x = [made.native.vertices[:, 0] for made in tree.meshes]
    if tree.leaf_bones is not None:
        x.append(tree.skeleton.foliage.vertices[:, 0])
    x = np.concatenate(x)
    return float(x.min()), float(x.max())


def create_trees(context, trees, options):
    """Makes the trees of `trees`, [(path, NativeTree), ...], in a row along X, the first where its file has it;
    returns their collections. On an error none stays."""
    collections, made, end = [], [], None
    with objects.Ledger():
        for path, tree in trees:
            collections.append(create_tree(context, Path(path).stem, tree, options))
            made += context.view_layer.objects.selected
            low, high = _reach(tree)
            shift = 0.0 if end is None else end + ROW_GAP * (high - low) - low
            end = shift + high + ROW_GAP * (high - low)
            rig = next(obj for obj in collections[-1].objects if obj.type == "ARMATURE")
            # Blender's own precision is enough for one place, though not for the points around it.
            x, y, z = trees[0][1].skeleton.origin
            rig.location = (x + shift, y, z)
        for obj in made:
            obj.select_set(True)
    return collections


def metre_of(scene):
    """What a metre is in the scene's units."""
    return 1.0 / scene.unit_settings.scale_length


class Failure(NamedTuple):
    path: Path
    error: Exception

    def text(self):
        """What is told of it, with the file's name."""
        told = message(self.error)
        return told if self.path.name in told else f"{self.path.name}: {told}"


def read_files(paths, options, progress=None, metre=1.0):
    """([(path, NativeTree), ...], [Failure, ...]) of several files; see read_native."""
    native.load()  # what is missing for all is told once
    trees, failures = [], []
    for number, path in enumerate(paths):

        def step(share, before=number):
            return progress is None or progress((before + share) / len(paths))

        try:
            trees.append((Path(path), read_native(path, options, step, metre)))
        except FAILURES as error:
            failures.append(Failure(Path(path), error))
    return trees, failures


def import_files(context, paths, options, progress=None):
    """Imports `paths`; returns ([(collection, report), ...], [Failure, ...]). What is no tree keeps none of the
    others out."""
    started = time.perf_counter()
    trees, failures = read_files(paths, options, progress, metre_of(context.scene))
    collections = create_trees(context, trees, options)
    seconds = round(time.perf_counter() - started, 4)
    made = []
    for collection, (_path, tree) in zip(collections, trees):
        tree.report["seconds"] = seconds
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        made.append((collection, tree.report))
    return made, failures


def import_file(context, path, options, progress=None):
    """Imports `path` into the scene; returns (collection, report). ValueError for bad input."""
    made, failures = import_files(context, [path], options, progress)
    if failures:
        raise failures[0].error
    return made[0]


def chosen_files(filepath, directory="", names=()):
    """The OBJ files that a user chose, each once: `names` in `directory`, or else `filepath`. A folder stands for
    the OBJ files in it."""
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
    """The report in one line."""
    levels = "/".join(str(count) for count in report["branches_per_level"])
    faces = " + ".join(str(mesh["faces"]) for mesh in report["meshes"])
    text = (
        f"{report['file']}: {report['form']}, {report['up_axis']} up, {report['branches']} branches ({levels}), "
        f"{report['bones']} of {report['bones_found']} bones, {faces} faces, {report['leaves']} leaves"
    )
    for count, what in (
        (len(report["skipped_parts"]), "parts skipped"),
        (len(report["extra_roots"]), "extra roots"),
        (len(report["warnings"]), "warnings"),
    ):
        text += f", {count} {what}" if count else ""
    return text


def told(report):
    """What is told of a tree beside its summary, a line each: its warnings and the wood that was left out."""
    # What was left out because it was asked for surprises nobody.
    left_out = [part for part in report["skipped_parts"] if part["reason"] != BY_OPTION]
    return report["warnings"] + [f"{part['name']} was left out: {part['reason']}" for part in left_out]


def summary_of_all(reports, failures):
    """Several trees in one line."""
    faces = sum(report["meshes"][-1]["faces"] for report in reports)
    names = ", ".join(report["file"] for report in reports[:5])
    names += f" and {len(reports) - 5} more" if len(reports) > 5 else ""
    text = (
        f"{len(reports)} trees: {names}; {sum(r['branches'] for r in reports)} branches, {faces} faces, "
        f"{sum(r['leaves'] for r in reports)} leaves"
    )
    warnings = sum(len(report["warnings"]) for report in reports)
    text += f", {warnings} warnings" if warnings else ""
    return text + (f"; {len(failures)} files were no trees" if failures else "")


def message(error):
    """What is told of an error; a MemoryError says nothing of its own."""
    if isinstance(error, MemoryError):
        return "The tree does not fit into memory: choose a lower detail, or simplify it"
    return str(error)
