# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked maps as Blender images: the sequence of a folder, with the frames that exist.

A frame outside the files renders magenta and gives extreme displacement, so the number of files determines the
duration. After the last file, Blender shows the last file. Before the first file, users of the sequence must show no
snow.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

import bpy

from ..base.map_kinds import BY_NAME
from ..cache.folder import baked_frames
from ..cache.manifest import read_head
from ..scene.libraries import stored_name

HEADER_BYTES = 4096
# Name, type and size of the attribute with the first and last pixels (OpenEXR File Layout).
DATA_WINDOW = b"dataWindow\0box2i\0\x10\0\0\0"


@dataclass
class BakedSequence:
    """An image sequence of one receiver: `duration` square files of `size` texels from frame `first` on."""

    image: bpy.types.Image
    first: int
    duration: int
    size: int

    @property
    def last(self):
        return self.first + self.duration - 1

    def configure(self, image_user):
        """Sets an image user so that scene frame n shows the file of frame n."""
        image_user.frame_duration = self.duration
        image_user.frame_start = self.first
        image_user.frame_offset = self.first - 1
        image_user.use_cyclic = False
        image_user.use_auto_refresh = True


def frames_on_disk(folder, kind):
    """Frame numbers of `<kind>_<frame>.exr` in `folder`: the first and all consecutive ones."""
    frames = baked_frames(folder, kind)
    return [frame for index, frame in enumerate(frames) if frame == frames[0] + index]


def _load(path, name, color_space):
    """The image of a file; it is reloaded if it was loaded before."""
    path = Path(path)
    endings = ("/".join(path.parts[-2:]), f"//{path.name}")
    for image in bpy.data.images:
        # Paths of thousands of images take long to compare.
        may_be = image.library is None and image.filepath.replace("\\", "/").endswith(endings)
        if may_be and Path(bpy.path.abspath(image.filepath)) == path:
            image.reload()
            break
    else:
        image = bpy.data.images.load(str(path))
        image.name = name
        if bpy.data.filepath:
            try:
                image.filepath = bpy.path.relpath(str(path))
            except ValueError:
                pass  # another drive on Windows: the path stays absolute
    image.colorspace_settings.name = color_space
    return image


def _width(path):
    """Width of an EXR file in texels, from its header; 0 if the header is not valid. Blender would read the whole file,
    and the image of a sequence is empty before the first frame."""
    with open(path, "rb") as stream:
        header = stream.read(HEADER_BYTES)
    at = header.find(DATA_WINDOW)
    if at < 0:
        return 0
    left, _, right, _ = struct.unpack_from("<4i", header, at + len(DATA_WINDOW))
    return right - left + 1


def load_sequence(folder, kind):
    """The BakedSequence of the files of a kind of map (its name) in `folder`, or None if there are none."""
    if not folder:
        return None
    folder = Path(bpy.path.abspath(folder))
    frames = frames_on_disk(folder, kind)
    if not frames:
        return None
    path = folder / f"{kind}_{frames[0]:04d}.exr"
    image = _load(path, f"{folder.name} {kind}", BY_NAME[kind].color_space)
    image.source = "SEQUENCE"
    return BakedSequence(image, frames[0], len(frames), _width(path))


def baked_uv_map(folder):
    """The UV map of the maps in `folder`; empty if unknown."""
    manifest = read_head(Path(bpy.path.abspath(folder))) if folder else None
    return manifest["settings"]["receiver"]["uv_map"] if manifest else ""


def folders_of_members(folder, instancer):
    """{(object, library): folder} of all objects that the empty `instancer` instances. folder: the folder of any of
    them. Its manifest contains the empty's name at the time of the bake, and the other folders are beside it."""
    one, found = read_head(Path(bpy.path.abspath(folder))) if folder else None, {}
    if one is not None:
        instancer = one["label"].removesuffix(f" / {one['object']}")
    for beside in sorted(Path(bpy.path.abspath(folder)).parent.iterdir()) if folder else ():
        manifest = read_head(beside) if beside.is_dir() else None
        if manifest and manifest["label"].startswith(f"{instancer} / "):
            found[manifest["object"], stored_name(manifest["library"])] = str(beside)
    return found
