# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports the baked snow of a tree's objects: surfaces as meshes in the tree's file, or textures beside it (snow_maps)
with the parameters that a shader needs."""

from pathlib import Path

import bpy
import numpy as np

from ..base import native
from ..base.names import SNOW_UV
from ..cache.files import SURFACE_FACES, SURFACE_POINTS, frame_file
from ..cache.folder import baked_frames
from ..cache.manifest import read_manifest
from ..result.baked_images import baked_uv_map
from ..scene import receivers
from ..surface.compute import read_summary
from ..surface.mesh_file import read_mesh
from ..surface.point_cache import read_point_cache
from . import snow_maps
from .thinning import clustered
from .tree_data import SnowMesh

# Number of the TEXCOORD set of the maps.
TEXCOORD = 1


def _baked_folder(scene, obj, warnings):
    """The folder of an object's bake. If there is none, returns None and adds the reason to the warnings."""
    receiver = receivers.find(scene, obj)
    folder = Path(bpy.path.abspath(receiver.folder)) if receiver is not None and receiver.folder else None
    if folder is None or not baked_frames(folder):
        warnings.append(f"'{obj.name}' has no baked snow: add it to the receivers and bake")
        return None
    return folder


def surfaces(scene, objects, to_file, cell, warnings):
    """[SnowMesh] of the baked surfaces of `objects` ({part's name: object}) in the baked frame nearest to the current
    one. to_file(object) -> (4, 4) from object space to the file's space in metres, Z up; cell: see thinning.clustered.
    Raises ValueError if no object has a surface.
    """
    snow_meshes, reasons = [], []
    for name, obj in objects.items():
        folder = _baked_folder(scene, obj, reasons)
        if folder is None:
            continue
        summary = read_summary(folder)
        if summary is None:
            reasons.append(f"the bake of '{obj.name}' has no surface: use Update Surface, or bake again")
            continue
        file = read_mesh(folder / SURFACE_FACES)
        # The first sample has no snow.
        index = min(max(scene.frame_current - summary["first"], 0), summary["frames"] - 1) + 1
        points = read_point_cache(folder / SURFACE_POINTS)[index].astype(np.float64)
        matrix = np.array(to_file(obj), dtype=np.float64)
        quads = file.quads[:, (0, 1, 2, 0, 2, 3)].reshape(-1, 3)
        triangles = np.concatenate([quads, file.triangles])
        if np.linalg.det(matrix[:3, :3]) < 0:
            triangles = triangles[:, ::-1]
        points = (points @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
        points, triangles = clustered(points, triangles, cell)
        if len(triangles):
            snow_meshes.append(SnowMesh(f"{name}_snow", points, triangles))
    _require_snow(objects, reasons)
    warnings += reasons
    return snow_meshes


def _require_snow(objects, reasons):
    """Raises ValueError if snow is asked for and none of the objects has any. reasons: one per object without snow."""
    if len(reasons) == len(objects):
        raise ValueError(f"There is no snow to export, so nothing was written: {'; '.join(reasons)}")


def _map_folder(scene, obj, warnings):
    """The folder of an object's baked maps. If they do not fit the exported UVs, or are missing, returns None and adds
    the reason to the warnings."""
    folder = _baked_folder(scene, obj, warnings)
    if folder is None:
        return None
    uv_map = baked_uv_map(str(folder))
    if uv_map not in ("", SNOW_UV):
        warnings.append(
            f"the snow of '{obj.name}' was baked on the UV map '{uv_map}', but only `{SNOW_UV}` is exported: "
            "choose that UV map in the receiver's settings, and bake again"
        )
        return None
    return folder


def chosen_frames(baked, options, current):
    """The frames to export: the baked frame nearest to the current one, or evenly spread frames for the atlas."""
    if options.snow == "FRAME":
        return [min(baked, key=lambda frame: abs(frame - current))]
    count = min(options.atlas_frames, len(baked))
    places = np.rint(np.linspace(0, len(baked) - 1, count)).astype(int)
    return [baked[place] for place in places]


def _read(module, folder, kind, frames, tile, empty):
    images = [module.read_exr(str(folder / frame_file(kind, frame)))[0] for frame in frames]
    return snow_maps.atlas([snow_maps.shrunk(image, tile) for image in images], empty), len(images[0])


def _write_heights(module, heights, stem, options, attributes):
    """Writes the height map. Returns (path, {scale, offset}): the conversion of its numbers to metres."""
    if options.snow_format == "EXR":
        path = stem.with_name(f"{stem.name}_snow_height.exr")
        module.write_exr(str(path), heights, attributes={"snowbough": attributes})
        return path, {"scale": 1.0, "offset": 0.0}
    samples, scale, offset = snow_maps.quantised(heights)
    path = stem.with_name(f"{stem.name}_snow_height.png")
    module.write_png(str(path), samples)
    return path, {"scale": scale, "offset": offset}


def _write_maps(scene, obj, folder, stem, options, warnings):
    """Writes the maps of an object. Returns (parameters for shaders, [paths])."""
    module = native.load()
    frames = chosen_frames(baked_frames(folder), options, scene.frame_current)
    tile = options.atlas_tile if options.snow == "ATLAS" else 0
    heights, baked_size = _read(module, folder, "height", frames, tile, 0.0)
    columns, rows = snow_maps.tile_layout(len(frames))
    side = heights.shape[1] // columns
    depths = {entry["frame"]: entry["depth"] for entry in read_manifest(folder)["frames"]}
    path, numbers = _write_heights(module, heights, stem, options, f"snow of {obj.name}")
    said = {
        "texCoord": TEXCOORD,
        "frames": frames,
        "framesPerSecond": scene.render.fps / scene.render.fps_base,
        "columns": columns,
        "rows": rows,
        "tile": side,
        "bakedResolution": baked_size,
        "openDepths": [depths[frame] for frame in frames],
        "lastDepth": max(depths.values()),
        "style": receivers.snow_style(scene, receivers.find(scene, obj)).sliders(),
        "height": {"uri": path.name, **numbers, "unit": "metres along the normal"},
    }
    paths = [path]
    if all((folder / frame_file("normal", frame)).is_file() for frame in frames):
        normals, _ = _read(module, folder, "normal", frames, tile, snow_maps.FLAT)
        path = stem.with_name(f"{stem.name}_snow_normal.png")
        module.write_png(str(path), snow_maps.eight_bits(normals))
        said["normal"] = {"uri": path.name, "space": "tangent, OpenGL (+Y up), of texCoord"}
        paths.append(path)
    else:
        warnings.append(f"the bake of '{obj.name}' has no normal maps: enable Normal Maps and bake again")
    return said, paths


def write(scene, objects, path, options, warnings):
    """Writes the maps of `objects` ({part's name: object}) beside the file `path`. Returns ({part's name: parameters
    for shaders}, [paths]). Heights are in metres, like the file. Raises ValueError if no object has maps."""
    folders, reasons = {}, []
    for name, obj in objects.items():
        folder = _map_folder(scene, obj, reasons)
        if folder is not None:
            folders[name] = folder
    _require_snow(objects, reasons)
    warnings += reasons
    said, paths = {}, []
    for name, folder in folders.items():
        obj = objects[name]
        stem = Path(path).with_name(f"{Path(path).stem}_{name}")
        said[name], written = _write_maps(scene, obj, folder, stem, options, warnings)
        paths += written
    return said, paths
