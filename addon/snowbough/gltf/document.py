# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a glTF 2.0 document from arrays and images, and writes it as one .glb file, or as a .gltf file with separate
files. No ``bpy``.

Source: Khronos Group, glTF 2.0 Specification, 2021, sections 3.6 (buffers, accessors), 3.8 (textures) and 4 (GLB).
"""

import json
import struct
from pathlib import Path
from urllib.parse import quote

import numpy as np

from ..cache.files import write_bytes
from . import compression

_KINDS = (np.int8, np.uint8, np.int16, np.uint16, None, np.uint32, np.float32)
COMPONENT_TYPES = {np.dtype(kind): 5120 + number for number, kind in enumerate(_KINDS) if kind is not None}
TYPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
# Targets of buffer views that vertex shaders fetch. Other views have none.
VERTICES, INDICES = 34962, 34963
MESHOPT = "EXT_meshopt_compression"
SUFFIXES = {"image/png": ".png", "image/jpeg": ".jpg"}
GLB_MAGIC, GLB_JSON, GLB_BINARY = b"glTF", 0x4E4F534A, 0x004E4942


class Document:
    """The tables of a document. Each add method returns the index of the new entry.

    `json` is the document itself: entries without a method here are added to it directly. Empty tables are not written,
    as the specification requires.
    """

    TABLES = ("scenes", "nodes", "meshes", "skins", "materials", "textures", "samplers", "images")
    TABLES += ("accessors", "animations", "bufferViews", "extensionsUsed", "extensionsRequired")

    def __init__(self, generator, compressed=False):
        """compressed: store accessors in compressed form only, with the extension EXT_meshopt_compression."""
        self._raw = 0 if compressed else None
        self.json = {"asset": {"version": "2.0", "generator": generator}}
        self.json.update({name: [] for name in self.TABLES})
        self._binary = bytearray()
        self._images = []
        self._known = {}
        if compressed:
            self.use_extension(MESHOPT, required=True)

    def add(self, table, entry):
        self.json[table].append(entry)
        return len(self.json[table]) - 1

    def use_extension(self, name, required=False):
        for table in ("extensionsUsed", "extensionsRequired")[: 2 if required else 1]:
            if name not in self.json[table]:
                self.json[table].append(name)

    def _add_packed(self, rows, target=None, stride=None):
        """Adds the buffer view of rows (N, ...), compressed if the document is. The decoded bytes of a compressed view
        belong to buffer 1, which has no data."""
        data = rows.tobytes()
        row = len(data) // len(rows)
        if self._raw is None or not (target == INDICES or row % 4 == 0):
            return self._add_view(data, target, stride)
        if target == INDICES:
            mode, packed = "TRIANGLES", compression.triangles(rows)
        else:
            mode, packed = (
                "ATTRIBUTES",
                compression.attributes(np.frombuffer(data, np.uint8).reshape(-1, row)),
            )
        number = self._add_view(packed, target, stride)
        view = self.json["bufferViews"][number]
        said = {key: view[key] for key in ("buffer", "byteOffset", "byteLength")}
        view.update(buffer=1, byteOffset=self._raw, byteLength=len(data))
        view["extensions"] = {MESHOPT: {**said, "byteStride": row, "mode": mode, "count": len(rows)}}
        self._raw += len(data) + -len(data) % 4
        return number

    def _set_buffers(self, buffer):
        """buffer: the properties of the buffer with all data."""
        self.json["buffers"] = [buffer]
        if self._raw:
            fallback = {"byteLength": self._raw, "extensions": {MESHOPT: {"fallback": True}}}
            self.json["buffers"].append(fallback)

    def _add_view(self, data, target=None, stride=None):
        """Adds a buffer view. It begins at a multiple of four bytes, the alignment of all component types."""
        self._binary += b"\0" * (-len(self._binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        if stride is not None:
            view["byteStride"] = stride
        self._binary += data
        return self.add("bufferViews", view)

    def add_accessor(self, values, target=None, normalized=False, bounds=False):
        """Adds an accessor. values: 8- or 16-bit integers, uint32 or float32 of shape (N,), (N, 2 to 4) or (N, 4, 4);
        rows of vertex attributes are padded to a multiple of four bytes; matrices are column-major. bounds: write min
        and max, which positions need. Equal arrays are stored once."""
        values = np.ascontiguousarray(values)
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            raise ValueError("the mesh has coordinates that are not finite: correct it, then export again")
        padded, stride = values, None
        spare = -values[:1].nbytes % 4 // values.itemsize if target == VERTICES else 0
        if spare:
            padded = np.pad(values.reshape(len(values), -1), ((0, 0), (0, spare)))
            stride = padded[:1].nbytes
        padded = padded.astype(values.dtype.newbyteorder("<"), copy=False)
        key = (padded.tobytes(), values.dtype.str, values.shape, target, normalized, bounds)
        if key in self._known:
            return self._known[key]
        accessor = {
            "bufferView": self._add_packed(padded, target, stride),
            "componentType": COMPONENT_TYPES[values.dtype],
            "count": len(values),
            "type": TYPES[values.shape[1:]],
        }
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor["min"] = [float(v) for v in np.atleast_1d(values.min(axis=0))]
            accessor["max"] = [float(v) for v in np.atleast_1d(values.max(axis=0))]
        self._known[key] = self.add("accessors", accessor)
        return self._known[key]

    def add_tracks(self, values):
        """Adds one accessor for each of the arrays values (B, K, 4), normalised int16, in one buffer view. Returns
        their indices."""
        data = np.ascontiguousarray(values).astype("<i2")
        view = self._add_packed(data.reshape(-1, data.shape[2]))
        track = {"bufferView": view, "componentType": 5122, "count": data.shape[1], "type": "VEC4"}
        size = data[0].nbytes
        return [
            self.add("accessors", {**track, "byteOffset": number * size, "normalized": True})
            for number in range(len(data))
        ]

    def add_texture(self, name, data, mime_type):
        """Adds a repeating texture. data: the bytes of an image file; equal bytes are stored once."""
        if (data, mime_type) not in self._known:
            sampler = {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}
            if not self.json["samplers"]:
                self.add("samplers", sampler)
            self._images.append(data)
            image = self.add("images", {"name": name, "mimeType": mime_type})
            self._known[data, mime_type] = self.add("textures", {"sampler": 0, "source": image})
        return self._known[data, mime_type]

    def _finished(self):
        """The document without its empty tables."""
        return {key: value for key, value in self.json.items() if value != []}

    def write_glb(self, path):
        """Writes one .glb file with all data. Returns its path in a list. Raises CacheError if the file cannot be
        written."""
        for image, data in zip(self.json["images"], self._images):
            image["bufferView"] = self._add_view(data)
        binary = bytes(self._binary) + b"\0" * (-len(self._binary) % 4)
        self._set_buffers({"byteLength": len(binary)})
        text = json.dumps(self._finished(), separators=(",", ":"), ensure_ascii=False).encode()
        text += b" " * (-len(text) % 4)
        parts = (
            struct.pack("<II", len(text), GLB_JSON),
            text,
            struct.pack("<II", len(binary), GLB_BINARY),
            binary,
        )
        length = 12 + sum(map(len, parts))
        write_bytes(path, b"".join((struct.pack("<4sII", GLB_MAGIC, 2, length), *parts)))
        return [Path(path)]

    def write_separate(self, path):
        """Writes a .gltf file, a .bin file of the same name, and the images as separate files. Returns all paths.
        Raises CacheError if a file cannot be written."""
        path = Path(path)
        written = []
        for number, (image, data) in enumerate(zip(self.json["images"], self._images)):
            file = path.with_name(f"{path.stem}_{number}{SUFFIXES[image['mimeType']]}")
            write_bytes(file, data)
            written.append(file)
            image["uri"] = quote(file.name)
            del image["mimeType"]
        binary = path.with_suffix(".bin")
        write_bytes(binary, bytes(self._binary))
        self._set_buffers({"byteLength": len(self._binary), "uri": quote(binary.name)})
        write_bytes(path, json.dumps(self._finished(), indent=1, ensure_ascii=False).encode() + b"\n")
        return [path, binary, *written]
