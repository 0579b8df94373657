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


def shown_objects(layer):
    """The objects in collections that a view layer renders."""
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
    """The frames of the scene's shot on which an object is hidden in renders, or has scale 0 along an axis, by its
    properties and keys. Drivers, parents and handlers are not followed."""
    curves = {
        (curve.data_path, curve.array_index): curve for curve in compat.curves_of(obj) if not curve.mute
    }

    def value(path, index, own, time):
        curve = curves.get((path, index))
        return own if curve is None else curve.evaluate(time)

    hidden = []
    for frame in range(scene.snowbough.frame_start, scene.snowbough.frame_end + 1):
        time = frame * compat.frame_length(scene)
        scales = [value("scale", axis, obj.scale[axis], time) for axis in range(3)]
        if value("hide_render", 0, obj.hide_render, time) >= 0.5 or 0.0 in scales:
            hidden.append(frame)
    return hidden


def frames_text(frames):
    """Sorted frames as text: ``3-5, 8``."""
    ranges = []
    for frame in frames:
        if ranges and ranges[-1][1] == frame - 1:
            ranges[-1][1] = frame
        else:
            ranges.append([frame, frame])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in ranges)
