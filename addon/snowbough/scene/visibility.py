# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a scene renders, and on which frames: view layers, collections and keys."""

from ..base import compat


def rendered_layers(scene):
    """The view layers that a render of the scene shows; the first one if all are off."""
    return [layer for layer in scene.view_layers if layer.use] or [scene.view_layers[0]]


def layer_collections(layer):
    """{names of collections from the root's child on: LayerCollection} of a view layer, parents first. Holdout and
    indirect-only collections are like others: their objects stop snow."""
    found = {}

    def walk(parent, path):
        for child in parent.children:
            found[(*path, child.name)] = child
            walk(child, (*path, child.name))

    walk(layer.layer_collection, ())
    return found


def excluded(layer):
    """The keys of layer_collections that are excluded from a view layer."""
    return {path for path, collection in layer_collections(layer).items() if collection.exclude}


def shown_objects(scene):
    """{name of each rendered view layer: the objects in the collections that it shows}."""
    return {layer.name: _shown_by(layer) for layer in rendered_layers(scene)}


def _shown_by(layer):
    shown = set()

    def walk(layer_collection):
        if layer_collection.collection.hide_render:  # its children are hidden, too
            return
        if not layer_collection.exclude:
            shown.update(layer_collection.collection.objects)
        for child in layer_collection.children:
            walk(child)

    walk(layer.layer_collection)
    return shown


def hidden_frames(scene, obj):
    """The frames of the scene's shot on which an object is hidden in renders, or it or a parent has scale 0 along an
    axis, by properties and keys. Drivers and handlers are not followed."""
    owners = [obj]
    while owners[-1].parent is not None:
        owners.append(owners[-1].parent)
    curves = {
        (owner, curve.data_path, curve.array_index): curve
        for owner in owners
        for curve in compat.curves_of(owner)
        if curve.data_path in ("hide_render", "scale") and not curve.mute
    }
    frames = range(scene.snowbough.frame_start, scene.snowbough.frame_end + 1)
    if not curves:
        return list(frames) if obj.hide_render or any(0.0 in owner.scale for owner in owners) else []

    def value(owner, path, index, own, time):
        curve = curves.get((owner, path, index))
        return own if curve is None else curve.evaluate(time)

    hidden = []
    for frame in frames:
        time = frame * compat.frame_length(scene)
        scales = [
            value(owner, "scale", axis, owner.scale[axis], time) for owner in owners for axis in range(3)
        ]
        if value(obj, "hide_render", 0, obj.hide_render, time) >= 0.5 or 0.0 in scales:
            hidden.append(frame)
    return hidden


def is_driven(obj):
    """Whether a driver hides an object in renders."""
    animation = obj.animation_data
    return animation is not None and any(driver.data_path == "hide_render" for driver in animation.drivers)


def frames_text(frames):
    """Sorted frames as text: ``3-5, 8``."""
    ranges = []
    for frame in frames:
        if ranges and ranges[-1][1] == frame - 1:
            ranges[-1][1] = frame
        else:
            ranges.append([frame, frame])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in ranges)
