# SPDX-License-Identifier: GPL-3.0-or-later
"""Problems that can be found before a bake, as a list of issues, many with a one-click fix.

check() reads meshes as they are evaluated now, which is too slow for every redraw. So an operator runs it, and the
panel shows its findings (session.issues).
"""

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..base import compat, native, session
from ..base.names import FARTHEST, counted, sized
from ..cache import versions
from ..result import displacement, surface_files
from ..scene import (
    masks,
    material_alpha,
    mesh_record,
    physics_caches,
    receivers,
    uv_maps,
    uv_overlap,
    visibility,
)
from ..scene.libraries import library_name
from ..scene.pose import Topology, metres_per_unit, outliers, world_positions
from ..scene.reader import SURFACE_TYPES
from ..settings.preferences import preferred_engine
from . import baked_receiver, changes_since_bake, memory, plan
from .cache_place import cache_directory, existing_cache
from .from_scene import constant_rates
from .outcome import one_line
from .simulation import driver_text, probe_engine

# Names of objects in one message.
MAX_NAMED = 5
# Measured: packed size of smooth float maps as a share of their raw size.
PACKED_SHARE = 0.5


@dataclass(frozen=True)
class Issue:
    severity: str
    """ERROR (the bake would be refused or leave this receiver out), WARNING (the result would look wrong) or INFO."""
    text: str
    object_name: str = ""
    fix: str = ""
    """UNWRAP, SHOW_IN_RENDER, SAVE, BAKE_SIMULATIONS or empty."""


def check(scene, depsgraph):
    """All issues of the scene, the worst first."""
    issues = [*_environment(scene), *of_bake(scene, depsgraph)]
    issues += [Issue("WARNING", text) for text in surface_files.problems(scene)]
    for text in [
        *changes_since_bake.settings_changes(scene),
        *changes_since_bake.scene_changes(scene, depsgraph),
    ]:
        issues.append(Issue("WARNING", f"Changed since the bake that is shown: {text}. Bake again"))
    order = {"ERROR": 0, "WARNING": 1, "INFO": 2}
    return sorted(issues, key=lambda issue: order[issue.severity])


def of_bake(scene, depsgraph):
    """The issues of a bake that starts now, whichever engine runs it."""
    issues = [*_settings(scene), *_cache(scene)]
    specs = receivers.receiver_specs(scene)
    if not specs:
        issues.append(Issue("ERROR", "There are no receivers: select meshes and use Add Snow to Selected"))
    sizes = []
    shown = visibility.shown_objects(scene)
    for entry in scene.snowbough.receivers:
        if entry.object is not None and entry.enabled:
            issues += _hidden(scene, entry.object, shown)
            own, size = _receiver(scene, entry, depsgraph)
            issues += own
            if size:
                sizes.append(memory.MapSize(size, _triangle_count(entry.object, depsgraph)))
    issues += [*_amounts(scene, sizes), *_alpha(depsgraph), *_outliers(scene, depsgraph), *_layers(shown)]
    issues += _passed_by_wind(scene, depsgraph)
    return issues + [Issue(*issue) for issue in physics_caches.issues(scene)]


def _shown_meshes(depsgraph):
    """(object, world matrix) of the evaluated meshes that snow meets, each mesh once."""
    seen = set()
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type != "MESH" or obj.original.hide_render or not obj.original.snowbough.occlude:
            continue
        pointers = (obj.original.as_pointer(), obj.data.as_pointer())
        if obj.original.snowbough.is_shell or pointers in seen:
            continue
        seen.add(pointers)
        yield obj, np.array(instance.matrix_world)


def _outliers(scene, depsgraph):
    """Meshes whose vertices a bake leaves out."""
    for obj, matrix in _shown_meshes(depsgraph):
        lost = outliers(world_positions(compat.read_positions(obj.data), matrix, metres_per_unit(scene)))
        if lost is not None:
            text = (
                f"{lost.sum()} of {len(lost)} vertices of '{obj.name}' are not finite or beyond {FARTHEST / 1000:g} km "
                f"(the first is number {lost.argmax()}). They and their faces are left out: move or delete them"
            )
            yield Issue("WARNING", text, obj.name)


def _passed_by_wind(scene, depsgraph):
    """What makes no drifts, as imported trees: one might expect them."""
    if scene.snowbough.drift == 0.0:
        return
    names = {obj.name: None for obj, _ in _shown_meshes(depsgraph) if not obj.original.snowbough.blocks_wind}
    if names:
        more = f" and {counted(len(names) - 1, 'other object')}" if len(names) > 1 else ""
        text = (
            f"The wind passes '{next(iter(names))}'{more}: Blocks Wind is off, so that no drifts form behind"
        )
        yield Issue("INFO", text, next(iter(names)))


def _alpha(depsgraph):
    """Materials whose alpha a bake cannot use, and objects without the UV map of an alpha image."""
    alphas, issues = {}, []
    for obj, _ in _shown_meshes(depsgraph):
        for material in mesh_record.materials_of(obj, obj.data):
            if material is None:
                continue
            known = (material.name, library_name(material))
            try:
                if known not in alphas:
                    alphas[known] = None  # report each material once
                    alphas[known] = material_alpha.of_material(material)
                alpha = alphas[known]
                if alpha is not None and mesh_record.alpha_uv_map(alpha, obj.data) is None:
                    wanted = f" '{alpha.uv_map}'" if alpha.uv_map else ""
                    raise material_alpha.UnknownAlpha(f"'{obj.name}' has no UV map{wanted}")
            except material_alpha.UnknownAlpha as error:
                text = f"Snow treats the material '{material.name}' as opaque: {error}"
                issues.append(Issue("WARNING", text, obj.name))
    return issues


def _environment(scene):
    try:
        engine = probe_engine(native.load(), preferred_engine(), scene.snowbough.mapping)
    except (RuntimeError, ValueError) as error:
        yield Issue("ERROR", one_line(error))
    else:
        yield Issue("INFO", f"Snow is computed by engine {driver_text(engine)}: {engine['reason']}")
    if bpy.app.autoexec_fail:
        yield Issue(
            "ERROR", "Blender has disabled scripts in this file: allow Auto Run Python Scripts and reload"
        )


def _settings(scene):
    settings = scene.snowbough
    rates = constant_rates(scene, settings.frame_start, settings.frame_end)
    if rates is None:  # driven: known only by evaluating all frames
        rates = (1.0,) * (settings.frame_end - settings.frame_start + 1)
    try:
        plan.plan_snowfall(
            settings.frame_start, settings.frame_end, settings.start_depth, settings.end_depth, rates
        )
        displacement.require_frames(scene)
    except ValueError as error:
        yield Issue("ERROR", str(error))
    for text in _without_effect(settings):
        yield Issue("WARNING", text)


def _without_effect(settings):
    """Settings of thaw, water, dust and drifts that cannot work."""
    thaws, stays = settings.end_depth < settings.start_depth, not memory.has_repose(settings.repose)
    if settings.sun is not None and not thaws and not settings.wet:
        yield "The Sun thaws nothing: set End Depth below Start Depth, or switch Wet Ground on"
    elif settings.sun is not None and settings.sun.matrix_world.col[2].z <= 0.0:
        yield f"The Sun '{settings.sun.name}' shines from below the horizon at the current frame: turn it"
    if settings.wet and not thaws and settings.rain == 0.0:
        yield "Wet Ground has no water: set Rain, or End Depth below Start Depth"
    if settings.rain > 0.0 and not settings.wet:
        yield "Rain wets nothing: switch Wet Ground on"
    if settings.adhesion > 0.0 and not stays:
        yield "Adhesion needs a Repose of 90°: below it, walls shed what sticks to them"
    if settings.rising > 0.0 and settings.adhesion == 0.0:
        yield "What is Rising sticks to no underside: set Adhesion"
    if settings.drift > 0.0 and stays:
        yield "Drifts keep steep sides with a Repose of 90°: lower it"
    if settings.points and (stays or not settings.landing):
        yield "Flying Snow has no points: switch Landing on, and set Repose below 90°"
    if settings.granular and stays:
        yield "Granular needs a Repose below 90°: at 90° nothing moves"


def _cache(scene):
    try:
        folder = Path(cache_directory(scene))
    except ValueError as error:
        yield Issue("ERROR", str(error), fix="SAVE" if not bpy.data.filepath else "")
        return
    existing = next(parent for parent in (folder, *folder.parents) if parent.exists())
    if not existing.is_dir() or not _is_writable(existing):
        yield Issue("ERROR", f"The cache folder {folder} cannot be written: choose another one")
    root = existing_cache(scene)
    numbers = versions.versions(root) if root is not None else []
    if numbers:
        yield Issue(
            "INFO",
            f"There are bakes already; the newest is v{numbers[-1]:03d}. Finished bakes are never overwritten",
        )
    lost = changes_since_bake.lost_snow(scene)
    if lost:
        yield Issue("INFO", f"{lost}. Snow on objects is shown if they are receivers")


def _is_writable(folder):
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _receiver(scene, entry, depsgraph):
    """(issues, map size in texels per side or None) of one receiver."""
    obj = entry.object
    name = obj.name
    issues = []
    if obj.type != "MESH":
        for names, text, severity in (
            (receivers.members_without_map(obj), "have no UV map and get no snow: unwrap them", "WARNING"),
            (receivers.hidden_members(obj), "are hidden in renders and get no snow", "INFO"),
        ):
            if names:
                listed = ", ".join(f"'{own}'" for own in names[:MAX_NAMED])
                more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
                issues.append(Issue(severity, f"Members of '{name}' {text}: {listed}{more}", name))
        return issues, entry.resolution or None
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.data
    if not len(mesh.polygons):
        scatters = any(modifier.type == "NODES" for modifier in obj.modifiers)
        hint = ": if it scatters instances, end its geometry nodes with Realize Instances" if scatters else ""
        return [*issues, Issue("ERROR", f"'{name}' has no faces{hint}", name)], None
    layers = [layer.name for layer in mesh.uv_layers]
    active = mesh.uv_layers.active.name if mesh.uv_layers.active else ""
    uv_map = uv_maps.choose_uv_map(entry.uv_map, layers, active)
    if uv_map is None:
        lost = f"has no UV map '{entry.uv_map}'" if layers else "has no UV map"
        return [*issues, Issue("ERROR", f"'{name}' {lost}", name, "UNWRAP")], None
    uv = uv_maps.corner_uv(mesh, uv_map)
    outside = uv_overlap.outside_share(uv)
    if outside:
        tiles = uv_overlap.tiles_text(uv)
        text = (
            f"'{name}'s UV map '{uv_map}' {tiles}"
            if tiles
            else (f"{outside:.0%} of '{name}'s UV map '{uv_map}' is outside 0 to 1")
        )
        issues.append(Issue("ERROR", text, name, "UNWRAP"))
    overlap = uv_overlap.overlap_share(uv, enough=0.9)  # cards on one place cover nearly all of it
    if overlap > uv_overlap.TOLERANCE:
        issues.append(
            Issue(
                "WARNING",
                f"{overlap:.0%} of '{name}'s UV map '{uv_map}' overlaps: snow on one place also shows on the others",
                name,
                "UNWRAP",
            )
        )
    mask = masks.mask_spec(entry)
    if mask is not None:
        try:
            masks.check(mask, obj)
        except ValueError as error:
            issues.append(Issue("ERROR", str(error), name))
    if entry.shed_half_life and not scene.snowbough.landing:
        text = f"'{name}' sheds its snow, but Landing is off: what lets go lands nowhere"
        issues.append(Issue("WARNING", text, name))
    if min(obj.matrix_world.to_scale()) <= 0 or obj.matrix_world.determinant() < 0:
        issues.append(
            Issue(
                "WARNING", f"'{name}' has a negative scale: apply it (Ctrl+A), or use the snow surface", name
            )
        )
    elif displacement.uniform_scale(obj) is None:
        issues.append(
            Issue(
                "WARNING",
                f"'{name}' is scaled unevenly: apply the scale (Ctrl+A), or use the snow surface",
                name,
            )
        )
    size = receivers.receiver_resolution(entry)
    if not size:
        size, texel = _automatic_size(scene, obj, mesh, uv)
        wanted = scene.snowbough.texel_size
        if texel > wanted:
            text = (
                f"'{name}' is too large for texels of {1000 * wanted:.3g} mm: its map of {size} texels a side has "
                f"texels of {1000 * texel:.3g} mm. Set a higher resolution, split it, or raise Texel Size"
            )
            issues.append(Issue("WARNING", text, name))
    return issues, size


def _hidden(scene, obj, shown):
    """The frames on which a receiver is hidden. shown: visibility.shown_objects."""
    name, frames = obj.name, visibility.hidden_frames(scene, obj)
    if not any(obj in objects for objects in shown.values()):
        text = f"'{name}' is in no collection that a view layer renders: it keeps its snow and gets none"
        yield Issue("WARNING", text, name)
    if len(frames) == scene.snowbough.frame_end - scene.snowbough.frame_start + 1:
        if obj.hide_render:
            yield Issue("ERROR", f"'{name}' is hidden in renders", name, "SHOW_IN_RENDER")
        else:
            yield Issue("ERROR", f"'{name}' has scale 0 along an axis: apply the scale (Ctrl+A)", name)
        return
    kept = "there it keeps its snow, gets none, and its surface is empty"
    if frames:
        text = f"'{name}' is hidden, or its scale is 0, in frames {visibility.frames_text(frames)}: {kept}"
        yield Issue("INFO", text, name)
    for own in (obj, *receivers.members(obj)):
        if visibility.is_driven(own):
            yield Issue("INFO", f"A driver hides '{own.name}' in renders on some frames: {kept}", name)
        shown_frames = visibility.frames_text(visibility.hidden_frames(scene, own)) if own != obj else ""
        if shown_frames and own.animation_data is not None:
            text = f"'{own.name}' in '{name}' is hidden, or its scale is 0, in frames {shown_frames}: {kept}"
            yield Issue("INFO", text, name)


def _layers(shown):
    """Objects that only some of the rendered view layers show. shown: visibility.shown_objects."""
    by_layers = {}
    for obj in sorted(set.union(*shown.values()), key=lambda obj: obj.name):
        names = tuple(layer for layer, objects in shown.items() if obj in objects)
        if len(names) < len(shown) and obj.snowbough.occlude and obj.type in SURFACE_TYPES:
            by_layers.setdefault(names, []).append(obj.name)
    for names, objects in by_layers.items():
        listed = ", ".join(f"'{name}'" for name in objects[:MAX_NAMED])
        more = f" and {len(objects) - MAX_NAMED} more" if len(objects) > MAX_NAMED else ""
        yield Issue(
            "INFO",
            f"Only in {counted(len(names), 'view layer')} of {len(shown)} ({', '.join(names)}): {listed}{more}. Snow "
            "meets the objects of all layers that render",
        )


def _triangle_count(obj, depsgraph):
    if obj.type != "MESH":
        return 0
    mesh = obj.evaluated_get(depsgraph).data
    return len(mesh.loops) - 2 * len(mesh.polygons)


def _automatic_size(scene, obj, mesh, uv):
    """(automatic resolution, metres of a texel) of a mesh; (None, 0.0) without an area."""
    compat.ensure_triangles(mesh)
    triangles = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    positions = world_positions(
        compat.read_positions(mesh), np.array(obj.matrix_world), metres_per_unit(scene)
    )
    topology = Topology(triangles.reshape(-1, 3), uv, len(positions), "")
    try:
        areas = baked_receiver.surface_and_uv_area(topology, positions)
        size = plan.automatic_resolution(*areas, scene.snowbough.texel_size)
        return size, plan.metres_per_map(*areas) / size
    except ValueError:
        return None, 0.0


def _amounts(scene, maps):
    """Disk and memory that the maps need; maps: memory.MapSize."""
    if not maps:
        return
    needs = (maps, scene.snowbough.repose, scene.snowbough.write_normals)
    shortage = memory.shortage(*needs)
    if shortage:
        yield Issue("ERROR", shortage)
    sizes = [size.resolution for size in maps]
    texels = sum(size * size for size in sizes)
    frames = scene.snowbough.frame_end - scene.snowbough.frame_start + 1
    disk = texels * 4 * PACKED_SHARE * frames
    yield Issue(
        "INFO",
        f"{counted(len(sizes), 'map')}, up to {max(sizes)} texels a side: at most about {sized(disk)} on disk for "
        f"{counted(frames, 'frame')}, {sized(memory.estimate(*needs))} of memory",
    )
    try:
        folder = Path(cache_directory(scene))
        existing = next(parent for parent in (folder, *folder.parents) if parent.exists())
        free = shutil.disk_usage(existing).free
    except (ValueError, OSError):
        return
    if free < disk:
        text = (
            f"Only {sized(free)} are free in {existing}, and the bake may need {sized(disk)}: free disk space"
        )
        yield Issue("WARNING", text)


@bpy.app.handlers.persistent
def _forget(*_):
    """The findings belong to another file, or to a scene that was undone or redone."""
    session.issues.clear()


def register():
    for name in ("load_pre", "undo_post", "redo_post"):
        getattr(bpy.app.handlers, name).append(_forget)


def unregister():
    session.issues.clear()
    for name in ("load_pre", "undo_post", "redo_post"):
        getattr(bpy.app.handlers, name).remove(_forget)
