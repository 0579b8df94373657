# SPDX-License-Identifier: GPL-3.0-or-later
"""What has changed in the scene since its last bake, as texts.

settings_changes() is fast enough for panels. scene_changes() reads the meshes once and compares what the viewport's
evaluation shows: transforms, alpha images, and the shape of objects without modifiers. Resuming the finished bake
compares everything else, at every frame.
"""

from dataclasses import replace
from pathlib import Path

import bpy

from ..base import session
from ..base.names import unit_of, with_unit
from ..cache.errors import CacheError
from ..cache.files import LEDGER, MANIFEST
from ..cache.ledger import lost_text, read_ledger
from ..cache.manifest import read_head, read_inputs
from ..scene import inputs
from ..scene.masks import mask_spec
from ..scene.pose import metres_per_unit
from ..scene.reader import SceneReader
from ..scene.receivers import receiver_specs
from ..scene.uv_maps import choose_uv_map
from ..settings.objects import SIDES
from . import plan
from .continuing import is_longer, parts_of
from .from_scene import make_request


def _known(path, read):
    """read(its folder), once for each state of the file; None if it cannot be read."""
    try:
        changed = path.stat().st_mtime_ns
        known = session.manifests.get(path)
        if known is None or known[0] != changed:
            known = session.manifests[path] = (changed, read(path.parent))
    except (OSError, CacheError):
        return None
    return known[1]


def _manifest(folder):
    return _known(Path(bpy.path.abspath(folder)) / MANIFEST, read_head)


def lost_snow(scene):
    """Where the snow of the scene's bake is that no receiver shows, as a sentence; empty if there is none."""
    folders = [entry.folder for entry in scene.snowbough.receivers if entry.object and entry.folder]
    if not folders:
        return ""
    version = Path(bpy.path.abspath(folders[0])).parent
    return _known(version / LEDGER, lambda folder: lost_text(read_ledger(folder))) or ""


def _baked_entries(scene):
    """(entry of the list, manifest) of the baked receivers."""
    for entry in scene.snowbough.receivers:
        if entry.object is not None and entry.enabled and entry.folder:
            manifest = _manifest(entry.folder)
            if manifest is not None:
                yield entry, manifest


def _change(scene, name, now, before):
    """A text about the setting `name`, with the label of its field in the panel."""
    known = scene.snowbough.bl_rna.properties.get(name)
    label = known.name if known is not None and known.name else name.replace("_", " ")
    unit = unit_of(known.description) if known is not None else ""
    return f"{label}: {with_unit(now, unit)}, was {with_unit(before, unit)}"


def settings_changes(scene):
    """Texts such as ``End Depth: 0.1 m, was 0.2 m`` about settings that differ from the bake on display.

    Empty if nothing is baked, or if a bake would be refused.
    """
    entries = list(_baked_entries(scene))
    if not entries:
        return []
    try:
        request = make_request(scene)
        parts = parts_of(entries[0][1]["settings"]["snowfall"])
        if request.frame_end > max((last for last, _ in parts), default=request.frame_start - 1):
            request = replace(request, parts=parts)
        totals = None
        if request.rates is not None:
            totals = list(
                plan.plan_snowfall(
                    request.frame_start,
                    request.frame_end,
                    request.start_depth,
                    request.end_depth,
                    request.rates,
                    request.parts,
                ).totals
            )
    except (ValueError, CacheError):
        return []
    texts = []
    for entry, manifest in entries:
        before = {"time_stretching": 1.0, **manifest["settings"]["snowfall"]}
        for name, now in {"time_stretching": 1.0, **request.shot()}.items():
            if before.get(name) != now:
                texts.append(_change(scene, name, now, before.get(name)))
        if request.pixel_size and request.pixel_size != before["pixel_size"]:
            texts.append(_change(scene, "pixel_size", request.pixel_size, before["pixel_size"]))
        if not texts and totals is not None and totals != before["totals"]:
            texts.append("Rate: its animation changed")
        texts += _receiver_changes(entry, manifest["settings"]["receiver"])
    return list(dict.fromkeys(texts))


def can_continue(scene):
    """Whether frames were added to the shot since its finished bake, and nothing else that a panel can see changed."""
    entries = list(_baked_entries(scene))
    try:
        request = make_request(scene)
    except (ValueError, CacheError):
        return False
    return bool(entries) and all(
        manifest["complete"]
        and is_longer(
            {"time_stretching": 1.0, **manifest["settings"]["snowfall"], "pixel_size": 0.0},
            {"time_stretching": 1.0, **request.shot(), "pixel_size": 0.0},
        )
        and not list(_receiver_changes(entry, manifest["settings"]["receiver"]))
        for entry, manifest in entries
    )


def _receiver_changes(entry, before):
    obj = entry.object
    if entry.resolution and entry.resolution != before["resolution"]:
        yield f"{obj.name}: resolution {entry.resolution}, was {before['resolution']}"
    sides = before.get("sides", entry.sides)
    if entry.sides != sides:
        names = {name: label for name, label, _ in SIDES}
        yield f"{obj.name}: sides {names[entry.sides]}, was {names.get(sides, sides)}"
    mask = mask_spec(entry)
    mask, masked = "" if mask is None else mask.text, before.get("mask", "")
    if mask != masked:
        yield f"{obj.name}: mask {mask or 'none'}, was {masked or 'none'}"
    sheds, shed = entry.shed_half_life, before.get("shed_half_life", 0.0)
    if sheds != shed:
        yield f"{obj.name}: sheds in {sheds:g} s, was {shed:g} s"
    if obj.type == "MESH":
        names = [layer.name for layer in obj.data.uv_layers]
        active = obj.data.uv_layers.active
        uv_map = choose_uv_map(entry.uv_map, names, active.name if active else "")
        if uv_map != before["uv_map"]:
            yield f"{obj.name}: UV map '{uv_map}', was '{before['uv_map']}'"


def scene_changes(scene, depsgraph):
    """Texts such as ``Cart: transform changed at frame 12`` about the current frame, evaluated by depsgraph."""
    recorded = None
    for entry, _ in _baked_entries(scene):
        try:
            poses = read_inputs(bpy.path.abspath(entry.folder))
        except CacheError as error:
            return [str(error)]
        if poses is not None:
            recorded = inputs.SceneInputs(poses).at(inputs.pose_name(scene.frame_current, 0.0))
            break
    if recorded is None:
        return []
    specs = receiver_specs(scene, as_baked=True)
    names = {spec.known_as: spec.name for spec in specs}
    reader = SceneReader(specs, metres_per_unit(scene))
    try:
        pose = reader.read(depsgraph, scene.frame_current)
    except ValueError:  # a bake will report it
        return []
    texts = []
    for label in sorted(recorded.keys() - {inputs.SNOWFALL}):
        obj = scene.objects.get(names.get(label, label))
        now = next((own for own in pose.objects.values() if own.label == label and own.name == label), None)
        if obj is None and " / " not in label:
            texts.append(f"{label}: removed")
        elif obj is not None and now is not None:
            before, after = list(recorded[label]), list(now.prints)
            if obj.type != "MESH" or obj.modifiers:
                before[1:3] = after[1:3] = ("", "")
            text = inputs.difference(before, after)
            if text:
                texts.append(f"{obj.name}: {text} at frame {scene.frame_current}")
    return texts
