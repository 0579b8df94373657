# SPDX-License-Identifier: GPL-3.0-or-later
"""Compresses vertices and triangles as the extension EXT_meshopt_compression of glTF 2.0 specifies. No ``bpy``.

Source: Khronos Group, EXT_meshopt_compression, appendix A (bitstream), modes 0 and 1.
"""

import numpy as np

# Elements whose deltas share a width, and most elements of a block.
GROUP, BLOCK = 16, 256
# Edges and vertices that a triangle can refer to.
EDGES, VERTICES = 15, 13


def _zigzag(deltas):
    """uint8 codes of int8 deltas: small numbers for deltas near 0."""
    return ((deltas << 1) ^ (deltas >> 7)).astype(np.uint8)


def _packed(groups, bits):
    """(uint8 (G, 16 + 16 * bits / 8), lengths (G,)): groups (G, 16) in `bits` bits each; larger codes follow as
    bytes."""
    most, per_byte = (1 << bits) - 1, 8 // bits
    small = np.minimum(groups, most).reshape(len(groups), -1, per_byte)
    shifts = np.arange(per_byte)[::-1] * bits
    head = (small << shifts).sum(axis=2).astype(np.uint8)
    large = groups >= most
    order = np.argsort(~large, axis=1, kind="stable")
    rest = np.take_along_axis(groups, order, axis=1)
    return np.concatenate([head, rest], axis=1), head.shape[1] + large.sum(axis=1)


def attributes(rows):
    """Compresses uint8 rows (N, S), S a multiple of 4 up to 256: mode ATTRIBUTES."""
    count, stride = rows.shape
    deltas = np.diff(rows, axis=0, prepend=rows[:1]).view(np.int8)
    block = min(8192 // stride & ~(GROUP - 1), BLOCK)
    parts = [b"\xa0"]
    for first in range(0, count, block):
        codes = _zigzag(deltas[first : first + block])
        codes = np.pad(codes, ((0, -len(codes) % GROUP), (0, 0)))
        groups = np.ascontiguousarray(codes.T).reshape(-1, GROUP)
        payload, length, kind = _narrowest(groups)
        number = len(codes) // GROUP
        kind = np.pad(kind.reshape(stride, number), ((0, 0), (0, -number % 4))).reshape(stride, -1, 4)
        header = (kind << (2 * np.arange(4))).sum(axis=2).astype(np.uint8)
        used = np.arange(payload.shape[1]) < length[:, None]
        lines = np.concatenate([header, payload.reshape(stride, -1)], axis=1)
        parts.append(lines[np.concatenate([header >= 0, used.reshape(stride, -1)], axis=1)].tobytes())
    return b"".join((*parts, bytes(max(32 - stride, 0)), rows[0].tobytes()))


def _narrowest(groups):
    """(payload (G, 16), length (G,), kind (G,)) of groups (G, 16) of codes, each in the shortest of four forms."""
    count = len(groups)
    two, two_length = _packed(groups, 2)
    four, four_length = _packed(groups, 4)
    lengths = np.stack([np.where(groups.any(axis=1), 99, 0), two_length, four_length, np.full(count, GROUP)])
    kind = lengths.argmin(axis=0)
    forms = np.stack([groups, two[:, :GROUP], four[:, :GROUP], groups])
    return forms[kind, np.arange(count)], lengths[kind, np.arange(count)], kind


def _number(value):
    """An integer of any size in bytes of seven bits."""
    made = bytearray()
    while value > 127:
        made.append(value & 127 | 128)
        value >>= 7
    made.append(value)
    return made


class _Recent:
    """The positions of the latest entries of a queue: 0 is the newest."""

    def __init__(self):
        self._numbers, self._count = {}, 0

    def push(self, entry):
        self._numbers[entry] = self._count
        self._count += 1

    def position(self, entry):
        """A large number for an entry that was never pushed."""
        return self._count - 1 - self._numbers.get(entry, -1 << 30)


class _Triangles:
    """The state of mode TRIANGLES while triangles are added."""

    def __init__(self):
        self._edges, self._vertices = _Recent(), _Recent()
        self._next, self._last = 0, 0
        self._codes, self._data = bytearray(), bytearray()

    def _explicit(self, vertex):
        delta = vertex - self._last
        self._data += _number(2 * delta if delta >= 0 else -2 * delta - 1)
        self._last = vertex

    def _add_at_edge(self, a, b, c, edge):
        """A triangle at the recent edge (a, b)."""
        position = self._vertices.position(c)
        if c == self._next:
            self._codes.append(edge << 4)
            self._next += 1
        elif 0 < position < VERTICES:
            self._codes.append(edge << 4 | position)
        else:
            self._codes.append(edge << 4 | 15)
            self._explicit(c)
            position = VERTICES
        if not 0 < position < VERTICES:
            self._vertices.push(c)
        self._edges.push((c, b))
        self._edges.push((a, c))

    def _add_alone(self, corners):
        """A triangle without a recent edge: 0 for the next new vertex, 15 for an explicit one, otherwise 1 + its
        position. A new vertex comes first: the byte 0 for the others after an explicit one would reset the numbers."""
        if self._next in corners:
            first = corners.index(self._next)
            corners = corners[first:] + corners[:first]
        kinds, explicit = [], []
        for vertex in corners:
            position = self._vertices.position(vertex)
            if vertex == self._next:
                kinds.append(0)
                self._next += 1
            elif len(kinds) and position < 14:
                kinds.append(1 + position)
            else:
                kinds.append(15)
                explicit.append(vertex)
        first, pair = kinds[0], kinds[1] << 4 | kinds[2]
        if kinds == [0, 0, 0]:
            self._codes.append(0xF0)  # the table's entry 0
        else:
            self._codes.append(0xFE if first == 0 else 0xFF)
            self._data.append(pair)
        for vertex in explicit:
            self._explicit(vertex)
        a, b, c = corners
        for edge in ((b, a), (c, b), (a, c)):
            self._edges.push(edge)
        for vertex, kind in zip(corners, (0, *kinds[1:])):
            if kind in (0, 15):
                self._vertices.push(vertex)

    def add(self, a, b, c):
        for corners in ((a, b, c), (b, c, a), (c, a, b)):
            edge = self._edges.position(corners[:2])
            if edge < EDGES:
                self._add_at_edge(*corners, edge)
                return
        self._add_alone((a, b, c))

    def finished(self):
        return b"".join((b"\xe1", self._codes, self._data, bytes(16)))


def triangles(indices):
    """Compresses indices (3 T,): mode TRIANGLES. The decoded triangles may begin at another corner."""
    state = _Triangles()
    for a, b, c in np.asarray(indices).reshape(-1, 3).tolist():
        state.add(a, b, c)
    return state.finished()
