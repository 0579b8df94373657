# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks of receivers, read from vertex groups and images.

Image sequences are loaded before a bake or a preview begins, since Blender only loads the frame that it shows, and
images cannot be added while it renders.
"""

import re
from pathlib import Path

import bpy
import numpy as np

from .libraries import library_name
from .material_alpha import LUMINANCE, block_means
from .pose import MaskSpec, SceneError

# (image's name, library) -> {number of the file: (H, W) float32}.
_sequences = {}


def mask_spec(entry):
    """The MaskSpec of an entry of the list; None without a mask."""
    if entry.mask == "NONE":
        return None
    image = entry.mask_image
    if entry.mask == "GROUP":
        return MaskSpec("GROUP", entry.mask_group, "", "", entry.mask_inverted)
    known = ("", "") if image is None else (image.name, library_name(image))
    return MaskSpec("IMAGE", *known, entry.mask_uv_map, entry.mask_inverted)


def _image(mask):
    """The image of a MaskSpec, or None."""
    for image in bpy.data.images:
        if image.name == mask.name and library_name(image) == mask.library:
            return image
    return None


def load_sequences(specs, first, last):
    """Loads the frames first to last of the image sequences among the masks. In the main thread. Raises SceneError."""
    _sequences.clear()
    for spec in specs:
        mask = spec.mask
        image = _image(mask) if mask is not None and mask.kind == "IMAGE" else None
        if image is not None and image.source == "SEQUENCE" and (mask.name, mask.library) not in _sequences:
            _sequences[mask.name, mask.library] = _load_sequence(image, first, last)


def _load_sequence(image, first, last):
    path = Path(bpy.path.abspath(image.filepath, library=image.library))
    digits = re.search(r"(\d+)\D*$", path.stem)
    if digits is None:
        raise SceneError(
            f"The files of the mask '{image.name}' have no numbers: name them mask_0001.png and so on"
        )
    begin, end = digits.span(1)
    numbers = {}
    for file in sorted(path.parent.glob(f"*{path.suffix}")):
        number = re.fullmatch(re.escape(path.stem[:begin]) + r"(\d+)" + re.escape(path.stem[end:]), file.stem)
        if number is not None:
            numbers[int(number[1])] = file
    if not numbers:
        raise SceneError(f"The mask '{image.name}' has no files: {path}")
    wanted = {_nearest(numbers, frame) for frame in range(first, last + 1)}
    values = {}
    for number in sorted(wanted):
        loaded = bpy.data.images.load(str(numbers[number]), check_existing=False)
        try:
            values[number] = _values(loaded)
        finally:
            bpy.data.images.remove(loaded)
    return values


def _nearest(numbers, frame):
    """The number of the file that a frame shows: the last one up to it, or else the first."""
    return max((number for number in numbers if number <= frame), default=min(numbers))


def _values(image):
    """(H, W) float32 of an image: the luminance of its stored colours, 0 to 1, row 0 = v 0."""
    width, height = image.size
    if not width or not height or not image.channels:
        raise SceneError(_missing(image))
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    channels = flat.reshape(height, width, image.channels)
    colour = channels[..., :3] @ np.array(LUMINANCE, np.float32) if image.channels >= 3 else channels[..., 0]
    return np.clip(np.nan_to_num(block_means(colour)), 0.0, 1.0).astype(np.float32)


def check(mask, obj):
    """Raises SceneError if a mesh object lacks what a MaskSpec names."""
    if mask.kind == "GROUP":
        _group(obj, mask, obj.name)
        return
    image = _required_image(mask, obj.name)
    if image.source in ("FILE", "GENERATED") and not image.has_data and not image.size[0]:
        raise SceneError(_missing(image))
    if mask.uv_map and mask.uv_map not in obj.data.uv_layers:
        raise SceneError(
            f"The mask of '{obj.name}' has no UV map '{mask.uv_map}': choose one, or set Mask to None"
        )


def _missing(image):
    return f"The mask image '{image.name}' is missing: {image.filepath or 'it has no file'}"


def _group(obj, mask, label):
    group = obj.vertex_groups.get(mask.name)
    if obj.type != "MESH" or group is None:
        missing = f"has no vertex group '{mask.name}'" if mask.name else "has no vertex group chosen"
        raise SceneError(f"The mask of '{label}' {missing}: choose one, or set Mask to None")
    return group


def _required_image(mask, label):
    image = _image(mask)
    if image is None:
        raise SceneError(f"The mask of '{label}' has no image: choose one, or set Mask to None")
    if image.source not in ("FILE", "GENERATED", "SEQUENCE"):
        raise SceneError(
            f"The mask '{image.name}' is a {image.source.lower()}: use an image or an image sequence"
        )
    return image


def vertex_weights(obj, mask, label, count):
    """(V,) float32 of an evaluated mesh object: the weights of the group of a MaskSpec. Raises SceneError."""
    group = _group(obj, mask, label)
    weights, index = np.zeros(count, dtype=np.float32), group.index
    vertices = obj.data.vertices
    if len(vertices) != count:
        raise SceneError(f"The mask of '{label}' has {len(vertices):,} weights, its mesh {count:,} vertices")
    for number, vertex in enumerate(vertices):
        for element in vertex.groups:
            if element.group == index:
                weights[number] = element.weight
                break
    return 1.0 - weights if mask.inverted else weights


class MaskImages:
    """The images of masks over the poses: a still image is read once, and again while it has unsaved changes."""

    def __init__(self):
        # (name, library) -> (values, whether it had unsaved changes).
        self._known = {}

    def values(self, mask, label, frame):
        """(H, W) float32 of a MaskSpec's image in a frame. Raises SceneError."""
        known = (mask.name, mask.library)
        image = _required_image(mask, label)
        if image.source == "SEQUENCE":
            numbers = _sequences.get(known)
            if numbers is None:
                raise SceneError(
                    f"The mask '{image.name}' is not loaded: start the bake or the preview again"
                )
            values = numbers[_nearest(numbers, frame)]
        else:
            before, was_dirty = self._known.get(known, (None, True))
            if was_dirty or image.is_dirty:
                now = _values(image)
                is_same = before is not None and np.array_equal(before, now)
                self._known[known] = (before if is_same else now, image.is_dirty)
            values = self._known[known][0]
        return 1.0 - values if mask.inverted else values
