# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain meshes of baked snow, which bakes no longer change: of one frame, or of the whole shot.

The snow of a shot stays a child of its receiver and moves through absolute shape keys, one a frame, or through a Mesh
Cache modifier with a file of its own. Neither needs this add-on or the baked surface.
"""

import re
from pathlib import Path

import bpy
import numpy as np

from ..base import compat
from ..base.names import SURFACE_BARE_ATTRIBUTE, SURFACE_MODIFIER
from ..surface.point_cache import PointCacheWriter, collapsed
from . import snow_surface, surface_files

# Shape keys lie in the .blend file; more bytes than this in one mesh are refused.
MAX_KEY_BYTES = 1 << 30


def _move_bare_points(mesh, before, matrix):
    """After the mesh has been transformed: lets its material see the same heights. before: earlier points (V, 3)."""
    bare = mesh.attributes.get(SURFACE_BARE_ATTRIBUTE)
    if bare is None:
        return
    values = np.empty((len(before), 3), np.float32)
    bare.data.foreach_get("vector", values.ravel())
    # The material multiplies the difference by the scale of the receiver.
    raised = (before - values) @ matrix.T / np.linalg.norm(matrix, axis=0)
    bare.data.foreach_set("vector", (compat.read_positions(mesh) - raised).astype(np.float32).ravel())


def at_frame(scene, receiver, depsgraph):
    """Makes mesh objects without modifiers of the receiver's snow in the evaluated frame, in every displacement mode.
    Returns the new objects, which are in the collections of the surface; an empty list if no surface was computed."""
    surfaces = snow_surface.find(receiver)
    temporary = not surfaces
    surfaces = surfaces or snow_surface.make(scene, receiver)
    depsgraph.update()
    applied = []
    for surface in surfaces:
        evaluated = surface.evaluated_get(depsgraph)
        name = f"{surface.name} {scene.frame_current:04d}"
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)
        mesh.name = name
        before = compat.read_positions(mesh)
        mesh.transform(evaluated.matrix_world)
        _move_bare_points(mesh, before, np.array(evaluated.matrix_world)[:3, :3])
        if evaluated.matrix_world.determinant() < 0:
            mesh.flip_normals()
        plain = bpy.data.objects.new(name, mesh)
        for collection in surface.users_collection:
            collection.objects.link(plain)
        applied.append(plain)
    if temporary:
        snow_surface.remove(receiver)
    return applied


def _copy(surface):
    """The surface as another object with its own mesh, child of the same receiver, without modifiers."""
    mesh = surface.data.copy()
    plain = bpy.data.objects.new(f"{surface.name} Applied", mesh)
    mesh.name = plain.name
    plain.parent, plain.parent_type = surface.parent, surface.parent_type
    plain.matrix_parent_inverse = surface.matrix_parent_inverse
    plain.matrix_basis = surface.matrix_basis
    plain.snowbough.occlude = False
    for collection in surface.users_collection:
        collection.objects.link(plain)
    return plain


def _animate_keys(obj, points, start, length):
    """Gives an object a shape key for each sample of points (samples, V, 3). Sample 0 belongs to rendered frame
    `start`; a rendered frame has `length` frames of keys (compat.frame_length)."""
    for number, sample in enumerate(points):
        key = obj.shape_key_add(name=f"Snow {number}", from_mix=False)
        key.data.foreach_set("co", np.ascontiguousarray(sample, np.float32).ravel())
        key.interpolation = "KEY_LINEAR"
    keys = obj.data.shape_keys
    keys.use_relative = False
    _, new_curve = compat.action_curves(keys, obj.name)
    curve = new_curve("eval_time", 0, "Snow")
    frames = [key.frame for key in keys.key_blocks]
    shown = {0: ("LINEAR", 0), len(points) - 1: ("LINEAR", len(points) - 1)}
    # Between samples of which the receiver is hidden in one, the nearer one shows (snow_surface.jump_where_hidden).
    for sample in np.flatnonzero(np.diff(collapsed(points))).tolist():
        shown.update({sample: ("CONSTANT", sample), sample + 0.5: ("CONSTANT", sample + 1)})
        shown.setdefault(sample + 1, ("LINEAR", sample + 1))
    for time, (interpolation, sample) in sorted(shown.items()):
        curve.keyframe_points.insert((start + time) * length, frames[sample]).interpolation = interpolation
    curve.update()


def _own_file(folder, name):
    """A path in a folder for a point cache that does not exist yet."""
    stem = re.sub(r"[^\w. -]", "_", name)
    for number in range(10_000):
        path = Path(folder, f"{stem}{f'.{number:03d}' if number else ''}.pc2")
        if not path.exists():
            return path
    raise ValueError(f"{folder} has 10,000 files named {stem}: choose another folder")


def _copy_cache(points, path):
    with PointCacheWriter(path, points.shape[1]) as cache:
        for sample in points:
            cache.add(sample)
        cache.publish()


def of_shot(receiver, folder=None):
    """Makes mesh objects that show the receiver's snow on all baked frames, hides its surfaces and returns the objects.

    folder: for the files of Mesh Cache modifiers; None makes shape keys. Raises ValueError if the receiver shows no
    surface or the keys would be too large, and CacheError for files that are missing or cannot be written.
    """
    surfaces = [surface for surface in snow_surface.find(receiver) if SURFACE_MODIFIER in surface.modifiers]
    points = [surface_files.points_of(surface) for surface in surfaces]
    if folder is None:
        for surface, samples in zip(surfaces, points, strict=True):
            if samples.nbytes > MAX_KEY_BYTES:
                raise ValueError(
                    f"{surface.name} has {samples.shape[1]:,} points on {len(samples) - 1} frames, "
                    f"{samples.nbytes / 2**30:.1f} GiB of shape keys: use Mesh Cache"
                )
    else:
        try:
            Path(folder).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ValueError(f"The folder {folder} cannot be made: {error.strerror or error}") from error
        files = [_own_file(folder, surface.name) for surface in surfaces]
        for path, samples in zip(files, points, strict=True):
            _copy_cache(samples, path)
    applied = []
    for number, surface in enumerate(surfaces):
        shown = surface.modifiers[SURFACE_MODIFIER]
        plain = _copy(surface)
        if folder is None:
            _animate_keys(plain, points[number], shown.frame_start, 1.0 / shown.frame_scale)
        else:
            modifier = plain.modifiers.new("Snow", "MESH_CACHE")
            modifier.cache_format, modifier.interpolation = "PC2", "LINEAR"
            modifier.filepath = snow_surface.blend_path(files[number])
            modifier.frame_start, modifier.frame_scale = shown.frame_start, shown.frame_scale
            snow_surface.jump_where_hidden(plain, modifier, points[number])
        surface.hide_render = True
        surface.hide_set(True)
        applied.append(plain)
    return applied
