# SPDX-License-Identifier: GPL-3.0-or-later
"""The native part of an import: from an OBJ file to arrays, without Blender's data. It can run in another thread and be
stopped.
"""

import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from ..base import native
from .import_options import BASE, JOINTS, LOD_CHAIN, METRES_OF_UNIT

# A dead trunk or a stump may be intended, but a pole rarely is.
BARE_TRUNK = "nothing in the file has branches or leaves: it was imported as a bare trunk, but may be a pole"

# In reports: the detail of a tree that keeps the surface of its file.
ORIGINAL = "ORIGINAL"

# The tallest living tree has 116 m.
TALLEST = 150.0


class BarkMesh(NamedTuple):
    detail: str
    native: object  # with reduced bones
    original_uv: object  # float32 (F, 4, 2) of the export, or None
    face_material: object  # int32 (F,): index into the skeleton's wood_materials, -1 for none


class BaseBark(NamedTuple):
    """The last two of BarkMesh, of the four-sided base."""

    original_uv: object
    face_material: object


class KeptBark(NamedTuple):
    """What a kept surface, skeleton.kept, gets: the native results of kept_weights and layout_kept_uvs."""

    bones: object
    weights: object
    layout: dict


@dataclass
class NativeTree:
    """All native data of an import. The meshes share their bones."""

    skeleton: object
    meshes: list  # of BarkMesh, the coarsest first
    base: BaseBark | None  # None without original_uv
    leaf_bones: object
    leaf_layout: dict  # the leaves' UV map `snow` and its resolution; None without leaves
    report: dict
    kept: KeptBark | None = None  # replaces the meshes in the scene


def _build_meshes(module, skeleton, options, progress):
    """(the first mesh with all bones, [BarkMesh, ...]).

    progress(share 0..1) -> False stops: KeyboardInterrupt. The native module releases Python's lock. The finest level
    of a chain takes as long as all others together, so a second thread makes the others.
    """
    meshes = LOD_CHAIN if options.lod_chain else (options.detail,)
    if options.keep_surface:
        meshes = (BASE,)  # only for its bones
    shares = dict.fromkeys(meshes, 0.0)
    stopped = False

    def build(detail):
        def step(share):
            shares[detail] = share
            return not stopped and progress(sum(shares.values()) / len(shares))

        whole = module.build_tree_mesh(
            skeleton,
            options.width,
            options.species,
            detail,
            snow_resolution=options.snow_resolution,
            progress=step,
        )
        reduced = module.reduce_bones(whole, options.max_bones, options.max_bone_level)
        made = BarkMesh(detail, reduced, *module.original_uvs(skeleton, reduced))
        return (whole if detail == meshes[0] else None), made

    if len(meshes) == 1:
        whole, mesh = build(meshes[0])
        return whole, [mesh]
    built = {}
    with ThreadPoolExecutor(2, "snowbough-lod") as workers:
        futures = {workers.submit(build, detail): detail for detail in reversed(meshes)}
        try:
            for future in as_completed(futures):
                built[futures[future]] = future.result()
        except BaseException:
            stopped = True
            workers.shutdown(wait=True, cancel_futures=True)
            raise
    return built[meshes[0]][0], [built[detail][1] for detail in meshes]


def _base_of(module, mesh):
    """The BaseBark of a BarkMesh; None if the export has no coordinates."""
    if mesh.original_uv is None:
        return None
    of_mesh = mesh.original_uv, mesh.face_material
    return BaseBark(*of_mesh if mesh.detail == BASE else module.base_uvs(mesh.native, *of_mesh))


def _keep_surface(module, skeleton, whole, reduced, options, progress):
    bones, weights = module.kept_weights(skeleton, whole, reduced)
    return KeptBark(
        bones, weights, module.layout_kept_uvs(skeleton, options.snow_resolution, progress=progress)
    )


def size_settings(options, units_per_metre):
    """The arguments of read_tree for the tree's size. units_per_metre: Blender units of a metre."""
    unit = METRES_OF_UNIT[options.unit]
    return {
        "unit": 1.0 if unit is None else unit * units_per_metre,
        "height": options.height * units_per_metre,
    }


def _lay_out_leaves(module, skeleton, options, go_on):
    """The leaves' UV map `snow`; None without leaves. go_on(share 0..1) -> False stops it."""
    if not len(skeleton.foliage.vertices):
        return None
    return module.layout_leaf_uvs(skeleton, options.snow_resolution, progress=go_on)


def read_native(path, options, progress=None, units_per_metre=1.0):
    """Reads `path` and computes the tree, without Blender's data. Raises ValueError for invalid input.

    units_per_metre: Blender units of a metre. progress(share 0..1) -> False stops: KeyboardInterrupt.
    """
    path = Path(path)
    if not path.name or path.is_dir():
        raise ValueError(f"{path} is a folder: choose a file")
    if not path.is_file():
        raise ValueError(f"{path} was not found")

    def read(module, **settings):
        return module.read_tree(str(path), outside_files=options.outside_files, **settings)

    return _build(path.name, read, options, progress, units_per_metre)


def read_polygons(polygons, options, units_per_metre=1.0):
    """As read_native, for selected_meshes.Polygons."""

    def read(module, **settings):
        return module.read_tree_mesh(*polygons, **settings)

    return _build(polygons.name, read, options, None, units_per_metre)


def _build(name, read, options, progress, units_per_metre):
    """The NativeTree of the skeleton that read(module, **settings) returns."""
    module = native.load()
    started = time.perf_counter()
    if options.bones:  # bones are for the surface that they were made with
        options = replace(options, keep_surface=True)

    def part(begin, end):
        """Converts the progress of a stage to that of the whole."""
        return lambda share: progress is None or progress(begin + (end - begin) * share)

    simplify, tolerance = options.simplify, options.tolerance
    if simplify == "DETAIL":
        simplify, tolerance = JOINTS[options.detail]
    skeleton = read(
        module,
        up_axis=options.up_axis,
        levels=options.levels,
        simplify=simplify,
        tolerance=tolerance,
        **size_settings(options, units_per_metre),
        foliage=(options.foliage_names or "AUTO") if options.foliage else "NONE",
        progress=part(0.0, 0.4),
        keep_surface=options.keep_surface,
        bones=options.bones,
    )
    if not skeleton.branches:
        raise ValueError(f"{name} has no branches: there is no tree to import")
    # The leaves' charts need only the skeleton: a second thread packs them while the mesh is built.
    stopped = False
    with ThreadPoolExecutor(1, "snowbough-leaves") as worker:
        try:
            leaf_charts = worker.submit(
                _lay_out_leaves, module, skeleton, options, lambda _share: not stopped
            )
            built = 0.6 if options.keep_surface else 0.95
            whole, meshes = _build_meshes(module, skeleton, options, part(0.4, built))
            kept = None
            if options.keep_surface:
                reduced = meshes[0].native
                kept = _keep_surface(module, skeleton, whole, reduced, options, part(built, 0.95))
            base = _base_of(module, meshes[0])
            leaf_layout = leaf_charts.result()
        except BaseException:
            stopped = True
            raise
    warnings = list(whole.warnings)
    leaf_bones = None
    if leaf_layout is not None:
        bone_map = meshes[0].native.bone_map
        leaf_bones = module.leaf_bones(skeleton, whole)
        leaf_bones = leaf_bones if bone_map is None else bone_map[leaf_bones]
    for noun, layout in (("leaves", leaf_layout), ("wood", kept and kept.layout)):
        if layout and layout["resolution"] > options.snow_resolution:
            warnings.append(
                f"the UV map for snow of the {noun} needs a resolution of {layout['resolution']} texels, not "
                f"{options.snow_resolution}"
            )
    if part(0.95, 1.0)(1.0) is False:
        raise KeyboardInterrupt("cancelled")

    report = dict(skeleton.report)
    report["file"] = name
    report["height"] = float(skeleton.height)
    report["branches"] = len(skeleton.branches)
    report["bones_found"] = len(whole.bone_parents)
    report["bones"] = len(meshes[0].native.bone_parents)
    report["meshes"] = [
        {"detail": made.detail, "vertices": len(made.native.vertices), "faces": len(made.native.quads)}
        for made in meshes
    ]
    if kept is not None:
        surface = skeleton.kept
        sizes = {"vertices": len(surface.vertices), "faces": len(surface.face_material)}
        report["meshes"] = [{"detail": ORIGINAL, **sizes}]
    report["leaves"] = 0 if leaf_bones is None else len(leaf_bones)
    report["surface"] = (
        {}
        if kept is not None
        else {key: whole.report[key] for key in ("components", "closed", "crossing_junctions")}
    )
    if all(branch.parent < 0 for branch in skeleton.branches) and leaf_layout is None:
        warnings.append(BARE_TRUNK)
    metres = report["height"] / units_per_metre
    if metres > TALLEST:
        warnings.append(
            f"the tree is {metres:,.0f} m high: set Units or Height, if it is in another unit than metres"
        )
    report["warnings"] = list(report["warnings"]) + warnings
    report["native_seconds"] = round(time.perf_counter() - started, 4)
    return NativeTree(skeleton, meshes, base, leaf_bones, leaf_layout, report, kept)
