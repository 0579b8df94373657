# SPDX-License-Identifier: GPL-3.0-or-later
"""From an OBJ file to one rigged, weighted, unwrapped mesh in the scene.

First everything native is computed (:func:`read_native`; it can run on another thread and be stopped),
only then Blender's data-blocks are made (:func:`create_tree`): bad input or Esc leaves Blender as it was.
"""

import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import bpy

from .. import native
from ..names import SNOW_RESOLUTION_PROPERTY
from . import armature, materials, objects
from .import_options import BY_DETAIL, LOD_COUNT

REPORT_PROPERTY = "snowbough_report"
LOD_PROPERTY = "snowbough_lod"


@dataclass(frozen=True)
class Fineness:
    """How fine a mesh is: a level of the chain, counted from the four-sided base, or a detail."""

    lod: int = BY_DETAIL
    detail: str = ""

    def settings(self):
        """As build_tree_mesh takes it."""
        return {"detail": self.detail} if self.lod == BY_DETAIL else {"lod": self.lod}


def wanted(options):
    """The Fineness of each mesh that an import makes, the coarsest first."""
    if options.lod_chain:
        return [Fineness(lod) for lod in range(LOD_COUNT)]
    return [Fineness(options.lod) if options.lod != BY_DETAIL else Fineness(detail=options.detail)]


@dataclass
class NativeTree:
    """Everything an import needs, before Blender hears of it. Meshes share their bones."""

    skeleton: object
    meshes: list  # (Fineness, native mesh with reduced bones)
    leaf_bones: object
    leaf_layout: dict  # the leaves' UV map `snow` and the resolution it is for; None without leaves
    report: dict


def _build_meshes(module, skeleton, options, progress):
    """(the first mesh with all bones, [(Fineness, mesh with reduced bones), ...]).

    progress(share 0..1) -> False stops: KeyboardInterrupt. The native module works outside Python's
    lock: the finest level of a chain takes as long as all others together, which a second thread makes
    meanwhile.
    """
    meshes = wanted(options)
    shares = dict.fromkeys(meshes, 0.0)
    stopped = threading.Event()

    def build(fineness):
        def step(share):
            shares[fineness] = share
            return not stopped.is_set() and progress(sum(shares.values()) / len(shares))

        whole = module.build_tree_mesh(
            skeleton,
            options.width,
            options.species,
            **fineness.settings(),
            snow_resolution=options.snow_resolution,
            progress=step,
        )
        reduced = module.reduce_bones(whole, options.max_bones, options.max_bone_level)
        return (whole if fineness == meshes[0] else None), (fineness, reduced)

    if len(meshes) == 1:
        whole, mesh = build(meshes[0])
        return whole, [mesh]
    built = {}
    with ThreadPoolExecutor(2, "snowbough-lod") as workers:
        futures = {workers.submit(build, fineness): fineness for fineness in reversed(meshes)}
        try:
            for future in as_completed(futures):
                built[futures[future]] = future.result()
        except BaseException:
            stopped.set()
            workers.shutdown(wait=True, cancel_futures=True)
            raise
    return built[meshes[0]][0], [built[fineness][1] for fineness in meshes]


def _lay_out_leaves(module, skeleton, options, stopped):
    """The leaves' UV map `snow`; None without leaves. stopped: an event that ends it."""
    if not len(skeleton.foliage.vertices):
        return None

    def go_on(_share):
        return not stopped.is_set()

    return module.layout_leaf_uvs(skeleton, options.snow_resolution, progress=go_on)


def read_native(path, options, progress=None):
    """Reads `path` and computes the tree. Touches no Blender data; raises ValueError for bad input.

    progress(share 0..1) -> False stops: KeyboardInterrupt.
    """
    path = Path(path)
    if not path.name or path.is_dir():
        raise ValueError(f"{path} is a folder: choose an OBJ file")
    if not path.is_file():
        raise ValueError(f"{path} was not found")
    module = native.load()
    started = time.perf_counter()

    def part(begin, end):
        """Reports the shares of a stage as those of the whole."""
        return lambda share: progress is None or progress(begin + (end - begin) * share)

    skeleton = module.read_tree(
        str(path),
        up_axis=options.up_axis,
        levels=options.levels,
        simplify=options.simplify,
        tolerance=options.tolerance,
        foliage=(options.foliage_names or "AUTO") if options.foliage else "NONE",
        progress=part(0.0, 0.4),
    )
    if not skeleton.branches:
        raise ValueError(f"{path} holds no branches: there is no tree to import")
    # The leaves' charts need the skeleton alone: a second thread lays them out beside the mesh.
    stopped = threading.Event()
    with ThreadPoolExecutor(1, "snowbough-leaves") as worker:
        try:
            leaf_charts = worker.submit(_lay_out_leaves, module, skeleton, options, stopped)
            whole, meshes = _build_meshes(module, skeleton, options, part(0.4, 0.95))
            leaf_layout = leaf_charts.result()
        except BaseException:
            stopped.set()
            raise
    warnings = list(whole.warnings)
    leaf_bones = None
    if leaf_layout is not None:
        bone_map = meshes[0][1].bone_map
        leaf_bones = module.leaf_bones(skeleton, whole)
        leaf_bones = leaf_bones if bone_map is None else bone_map[leaf_bones]
        if leaf_layout["resolution"] > options.snow_resolution:
            warnings.append(
                f"the leaves' snow UV map needs a resolution of {leaf_layout['resolution']}, "
                f"not {options.snow_resolution}"
            )
    if part(0.95, 1.0)(1.0) is False:
        raise KeyboardInterrupt("cancelled")

    report = dict(skeleton.report)
    report["file"] = path.name
    report["height"] = float(skeleton.height)
    report["branches"] = len(skeleton.branches)
    report["bones_found"] = len(whole.bone_parents)
    report["bones"] = len(meshes[0][1].bone_parents)
    report["meshes"] = [
        {**fineness.settings(), "vertices": len(mesh.vertices), "faces": len(mesh.quads)}
        for fineness, mesh in meshes
    ]
    report["leaves"] = 0 if leaf_bones is None else len(leaf_bones)
    report["surface"] = {key: whole.report[key] for key in ("components", "closed", "crossing_junctions")}
    report["warnings"] = list(report["warnings"]) + warnings
    report["native_seconds"] = round(time.perf_counter() - started, 4)
    return NativeTree(skeleton, meshes, leaf_bones, leaf_layout, report)


def _lod_suffix(lod, chain):
    # Game engines call the finest level LOD0; ours counts up from the four-sided base.
    return f"_LOD{LOD_COUNT - 1 - lod}" if chain else ""


def create_tree(context, title, tree, options):
    """Makes collection, armature, bark and leaves; returns the collection. On an error nothing stays."""
    with objects.Ledger():
        if context.object is not None and context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        name = objects.file_title(title, len("_leaves_LOD0"))
        collection = bpy.data.collections.new(name)
        # The scene's own collection cannot be hidden or excluded: the armature needs edit mode there.
        context.scene.collection.children.link(collection)

        bones = armature.bone_arrays(tree.meshes[0][1])
        rig = armature.create_armature(context, name, bones, collection)
        made = [rig]
        bark_material = materials.bark_material(f"{name}_bark")
        for fineness, mesh in reversed(tree.meshes):
            lod = fineness.lod
            bark_name = f"{name}_bark{_lod_suffix(lod, options.lod_chain)}"
            bark = objects.create_bark(bark_name, mesh, bones.names, bark_material)
            if lod != BY_DETAIL:
                bark[LOD_PROPERTY] = lod
            bark[SNOW_RESOLUTION_PROPERTY] = options.snow_resolution
            made.append(bark)
        if tree.leaf_bones is not None:
            foliage = tree.skeleton.foliage
            leaf_materials = [materials.leaf_material(source) for source in foliage.materials]
            leaf_materials.append(materials.leaf_material(name=f"{name}_leaf"))
            leaves = objects.create_leaves(
                f"{name}_leaves",
                foliage,
                tree.leaf_layout["uv"],
                tree.leaf_bones,
                bones.names,
                leaf_materials,
            )
            leaves[SNOW_RESOLUTION_PROPERTY] = int(tree.leaf_layout["resolution"])
            made.append(leaves)
        for obj in made[1:]:
            collection.objects.link(obj)
            objects.bind(obj, rig)
            # Of a chain only the finest is shown: the others lie in the same place.
            if options.lod_chain and obj.get(LOD_PROPERTY, LOD_COUNT - 1) != LOD_COUNT - 1:
                obj.hide_render = True
                obj.hide_set(True)
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        for other in context.view_layer.objects.selected:
            other.select_set(False)
        for obj in made:
            if not obj.hide_get():
                obj.select_set(True)
        context.view_layer.objects.active = rig
        return collection


def import_file(context, path, options, progress=None):
    """Imports `path` into the scene; returns (collection, report). ValueError for bad input."""
    started = time.perf_counter()
    tree = read_native(path, options, progress)
    collection = create_tree(context, Path(path).stem, tree, options)
    tree.report["seconds"] = round(time.perf_counter() - started, 4)
    collection[REPORT_PROPERTY] = json.dumps(tree.report)
    return collection, tree.report


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


def message(error):
    """What is told of an error; a MemoryError says nothing of its own."""
    if isinstance(error, MemoryError):
        return "The tree does not fit into memory: choose a lower level of detail, or simplify it"
    return str(error)
