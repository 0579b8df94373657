# SPDX-License-Identifier: GPL-3.0-or-later
"""Decodes EXT_meshopt_compression of glTF. Written from the text alone, independent of our encoder: Khronos Group,
EXT_meshopt_compression, appendix A, modes 0 and 1."""

import numpy as np

NAME = "EXT_meshopt_compression"


def _group(data, at, kind):
    """(16 codes, next position) of a group of deltas."""
    if kind == 0:
        return [0] * 16, at
    if kind == 3:
        return list(data[at : at + 16]), at + 16
    bits = 2 * kind
    codes = [data[at + k * bits // 8] >> (8 - bits - k * bits % 8) & (1 << bits) - 1 for k in range(16)]
    at += 2 * bits
    for k, code in enumerate(codes):
        if code == (1 << bits) - 1:
            codes[k], at = data[at], at + 1
    return codes, at


def _attributes(data, count, stride):
    assert data[0] == 0xA0
    before = np.frombuffer(data[-stride:], np.uint8).astype(np.int64)
    block, at, rows = min((8192 // stride) & ~15, 256), 1, []
    for first in range(0, count, block):
        size = min(block, count - first)
        groups = -(-size // 16)
        columns = np.zeros((groups * 16, stride), np.int64)
        for byte in range(stride):
            head, at = data[at : at + -(-groups // 4)], at + -(-groups // 4)
            for group in range(groups):
                kind = head[group // 4] >> (2 * (group % 4)) & 3
                columns[16 * group : 16 * group + 16, byte], at = _group(data, at, kind)
        deltas = np.where(columns & 1, ~(columns >> 1), columns >> 1)[:size]
        rows.append((before + np.cumsum(deltas, axis=0)) & 255)
        before = rows[-1][-1]
    assert at == len(data) - max(32, stride)
    return np.concatenate(rows).astype(np.uint8).tobytes()


class _Reader:
    def __init__(self, data, count):
        assert data[0] == 0xE1
        self.codes, self.data = data[1 : 1 + count // 3], data[1 + count // 3 : -16]
        self.table, self.at, self.next, self.last = data[-16:], 0, 0, 0
        self.edges, self.vertices = [], []

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def explicit(self):
        value, shift = 0, 0
        while True:
            byte = self.byte()
            value, shift = value | (byte & 127) << shift, shift + 7
            if byte < 128:
                self.last += ~(value >> 1) if value & 1 else value >> 1
                return self.last

    def new(self):
        self.next += 1
        return self.next - 1

    def vertex(self, kind):
        return self.new() if kind == 0 else self.explicit() if kind == 15 else self.vertices[-kind]

    def triangle(self, code):
        high, low = code >> 4, code & 15
        if high < 15:
            a, b = self.edges[-1 - high]
            if low in (13, 14):
                c = self.last = self.last + 2 * low - 27
            else:
                c = self.new() if low == 0 else self.explicit() if low == 15 else self.vertices[-1 - low]
            self.edges += [(c, b), (a, c)]
            self.vertices += [c] if low == 0 or low > 12 else []
            return a, b, c
        pair = self.byte() if low >= 14 else self.table[low]
        if low >= 14 and pair == 0:
            self.next = 0
        a = self.explicit() if low == 15 else self.new()
        b, c = self.vertex(pair >> 4), self.vertex(pair & 15)
        self.edges += [(b, a), (c, b), (a, c)]
        self.vertices += [a, *([b] if pair >> 4 in (0, 15) else []), *([c] if pair & 15 in (0, 15) else [])]
        return a, b, c


def _triangles(data, count, stride):
    reader = _Reader(data, count)
    corners = [reader.triangle(code) for code in reader.codes]
    assert reader.at == len(reader.data)
    return np.array(corners, np.uint16 if stride == 2 else np.uint32).tobytes()


def decoded(data, mode, count, stride):
    """The bytes of a buffer view."""
    return {"ATTRIBUTES": _attributes, "TRIANGLES": _triangles}[mode](data, count, stride)
