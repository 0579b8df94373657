# SPDX-License-Identifier: GPL-3.0-or-later
"""read_exr, write_exr, encode_png and write_png of snowbough_native."""

import io
import os
import struct
import zlib

import numpy as np
import pytest

snowbough_native = pytest.importorskip("snowbough_native")


def test_heights_come_back_bit_for_bit_with_row_0_first(tmp_path):
    height = np.array([[0.0, 1e-30, 0.1], [1 / 3, 123.456, 2.5e-7]], np.float32)
    snowbough_native.write_exr(str(tmp_path / "h.exr"), height, attributes={"snowboughUnit": "metre"})
    pixels, header = snowbough_native.read_exr(str(tmp_path / "h.exr"))
    assert pixels.dtype == np.float32
    assert np.array_equal(pixels, height)
    assert header == {"channels": ["Y"], "half": False, "attributes": {"snowboughUnit": "metre"}}


def test_colours_are_named_and_sorted_as_the_format_demands(tmp_path):
    pixels = np.arange(12, dtype=np.float32).reshape(2, 2, 3)
    snowbough_native.write_exr(str(tmp_path / "n.exr"), pixels, half=True)
    read, header = snowbough_native.read_exr(str(tmp_path / "n.exr"))
    assert header["channels"] == ["B", "G", "R"]
    assert header["half"]
    assert np.array_equal(read[..., ::-1], pixels)


def test_arrays_of_other_layouts_are_taken(tmp_path):
    height = np.arange(20, dtype=np.float64).reshape(4, 5)
    snowbough_native.write_exr(str(tmp_path / "t.exr"), height.T)
    assert np.array_equal(snowbough_native.read_exr(str(tmp_path / "t.exr"))[0], height.T.astype(np.float32))


def test_nothing_is_left_when_the_disk_refuses(tmp_path):
    with pytest.raises(RuntimeError, match="no such folder.*No such file or directory"):
        snowbough_native.write_exr(str(tmp_path / "no such folder" / "h.exr"), np.zeros((2, 2), np.float32))
    (tmp_path / "h.exr").mkdir()
    with pytest.raises(RuntimeError, match="h.exr"):
        snowbough_native.write_exr(str(tmp_path / "h.exr"), np.zeros((2, 2), np.float32))
    assert os.listdir(tmp_path) == ["h.exr"]


def test_wrong_input_is_a_value_error(tmp_path):
    path = str(tmp_path / "x.exr")
    with pytest.raises(ValueError, match="shape"):
        snowbough_native.write_exr(path, np.zeros(4, np.float32))
    with pytest.raises(ValueError, match="channels"):
        snowbough_native.write_exr(path, np.zeros((2, 2, 2), np.float32))


def test_a_damaged_file_is_refused_by_name(tmp_path):
    (tmp_path / "bad.exr").write_bytes(b"this is no image")
    with pytest.raises(RuntimeError, match="bad.exr"):
        snowbough_native.read_exr(str(tmp_path / "bad.exr"))


def test_a_png_holds_its_rows_from_the_top(tmp_path):
    samples = np.array([[[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [10, 11, 300]]], np.uint16)
    snowbough_native.write_png(str(tmp_path / "a.png"), samples)
    data = (tmp_path / "a.png").read_bytes()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            assert struct.unpack(">IIBBBBB", body) == (2, 2, 16, 2, 0, 0, 0)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(2, 13)
    assert list(rows[:, 0]) == [2, 2]
    rows = np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8)
    assert np.array_equal(rows.copy().view(">u2").reshape(2, 2, 3), samples[::-1])


@pytest.mark.parametrize("shape", [(3, 5), (4, 2, 3), (2, 3, 4)])
def test_an_encoded_png_reads_back_with_the_bottom_row_last(shape):
    image = pytest.importorskip("PIL.Image", reason="Pillow reads the PNG back")
    samples = np.random.default_rng(1).integers(0, 256, shape).astype(np.uint8)
    read = np.asarray(image.open(io.BytesIO(snowbough_native.encode_png(samples))))
    assert np.array_equal(read[::-1], samples)


def test_an_encoded_png_of_16_bits_keeps_all_of_them():
    image = pytest.importorskip("PIL.Image", reason="Pillow reads the PNG back")
    samples = np.array([[0, 1, 255, 256], [257, 32768, 65534, 65535]], np.uint16)
    read = np.asarray(image.open(io.BytesIO(snowbough_native.encode_png(samples)))).astype(np.uint16)
    assert np.array_equal(read[::-1], samples)


def test_a_png_of_floats_is_refused():
    with pytest.raises(ValueError, match="uint8 or uint16"):
        snowbough_native.encode_png(np.zeros((2, 2)))
