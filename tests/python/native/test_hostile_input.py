# SPDX-License-Identifier: GPL-3.0-or-later
"""Invalid input: the module raises an exception soon and allocates no memory for it.

Input that once crashed or hung runs in a child process, so that a crash ends only the child.
"""

import copy
import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import child
import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import grid

GROUND = grid()
CLASSES = [name for name, member in vars(native).items() if isinstance(member, type)]
NOT_NUMBERS = [np.nan, np.inf, -np.inf]


def in_child(program):
    """Runs lines of Python with the module, numpy and the meshes at hand; returns what they printed."""
    return child.in_child(
        f"import numpy as np, snowbough_native as native\nfrom snow_meshes import grid\n{program}"
    )


def stepped():
    simulation = native.SnowSimulation(pixel_size=0.05, engine="CPU")
    simulation.add_object("ground", GROUND[1], GROUND[2], resolution=64)
    simulation.step({"ground": GROUND[0]}, 0.01)
    return simulation


def with_number(array, value):
    array = np.array(array, np.float32)
    array.flat[array.size // 2] = value
    return array


# -- objects without __init__ --------------------------------------------------------------------------


@pytest.mark.parametrize("name", CLASSES)
def test_an_object_without_its_init_is_refused(name):
    printed = in_child(
        f"made = native.{name}.__new__(native.{name})\n"
        "for member in dir(made):\n"
        "    if member.startswith('_'):\n"
        "        continue\n"
        "    try:\n"
        "        value = getattr(made, member)\n"
        "        value() if callable(value) else None\n"
        "        print(member)\n"
        "    except TypeError:\n"
        "        pass\n"
    )
    assert set(printed.split()) <= {"from_branches"}  # a static method, which needs no object


def test_a_copy_of_a_simulation_is_refused():
    with pytest.raises(TypeError):
        copy.copy(stepped()).receivers()


def test_a_snapshot_is_worked_out_once():
    in_child(
        "p, t, uv = grid()\n"
        "simulation = native.SnowSimulation(pixel_size=0.05, engine='CPU')\n"
        "simulation.add_object('ground', t, uv, resolution=64)\n"
        "simulation.step({'ground': p}, 0.01)\n"
        "snapshot = simulation.snapshot('ground')\n"
        "snapshot.output()\n"
        "try:\n"
        "    snapshot.output()\n"
        "except RuntimeError as error:\n"
        "    assert 'take a new snapshot' in str(error)\n"
        "else:\n"
        "    raise AssertionError\n"
    )


# -- indices -------------------------------------------------------------------------------------------


def test_shading_numbers_may_be_as_large_as_they_like():
    in_child(
        "p, t, uv = grid(cells=2)\n"
        "heights = []\n"
        "for shading in (t, np.where(t == 8, np.int32(2**31 - 1), t)):\n"
        "    with native.SnowSimulation(pixel_size=0.05, engine='CPU') as simulation:\n"
        "        simulation.add_object('ground', t, uv, resolution=64, shading=shading)\n"
        "        simulation.step({'ground': p}, 0.01)\n"
        "        heights.append(simulation.output('ground')['height'])\n"
        "assert np.array_equal(*heights) and heights[0].max() > 0\n"
    )


def test_shading_numbers_of_a_surface_may_be_as_large_as_they_like():
    in_child(
        "p, t, uv = grid(cells=2)\n"
        "heights = np.full((64, 64), 0.1, np.float32)\n"
        "points = []\n"
        "for shading in (t, np.where(t == 8, np.int32(2**31 - 1), t)):\n"
        "    surface = native.SnowSurface(t, uv, p, heights, heights, 0.1, shading)\n"
        "    points.append(surface.points(heights, 0.1))\n"
        "    assert native.wanted_surface_points(t, p, 0.1, shading)[0] > 0\n"
        "assert np.array_equal(*points)\n"
    )


@pytest.mark.parametrize(
    "call",
    [
        "surface.set_style(relief=nan)",
        "surface.points(heights, nan)",
        "surface.points(heights, 0.1, up=(0.0, nan, 1.0))",
        "surface.points(heights * nan, 0.1)",
        "surface.points(heights, 0.1, positions=p * nan)",
        "surface.points(heights, 0.1, to_result=np.eye(4, dtype=np.float32) * nan)",
        "native.SnowSurface(t, uv, p, heights, heights, 0.1, wind=(nan, 0.0))",
    ],
)
def test_a_number_that_is_none_is_refused_by_a_surface(call):
    in_child(
        "p, t, uv = grid(cells=2)\n"
        "nan = np.float32(np.nan)\n"
        "heights = np.full((64, 64), 0.1, np.float32)\n"
        "surface = native.SnowSurface(t, uv, p, heights, heights, 0.1)\n"
        f"try:\n    {call}\n"
        "except ValueError as error:\n    assert 'finite' in str(error), error\n"
        "else:\n    raise AssertionError\n"
    )


@pytest.mark.parametrize("index", [-1, 4, 2**31 - 1, -(2**31)])
def test_a_quad_of_vertices_that_are_not_there_is_refused(index):
    in_child(
        f"try:\n    native.check_mesh(np.zeros((4, 3)), [[0, 1, 2, {index}]])\n"
        "except ValueError as error:\n    assert 'uses vertex' in str(error)\n"
        "else:\n    raise AssertionError\n"
    )


@pytest.mark.parametrize("index", [-1, 2**31 - 1])
def test_a_triangle_of_vertices_that_are_not_there_is_refused(index):
    triangles = GROUND[1].copy()
    triangles[0, 0] = index
    with pytest.raises(ValueError, match="vertex index"):
        native.texel_table(triangles, GROUND[2], 64)


def test_a_level_beyond_all_trees_is_refused():
    branch = {"name": "a", "level": 2**31 - 1, "parent": -1, "attach_point": [0, 0, 0], "points": [[0, 0, 0]]}
    with pytest.raises(ValueError, match="level 2147483647"):
        native.Skeleton.from_branches([{**branch, "radii": [1], "areas": [1]}])


# -- numbers -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("value", [*NOT_NUMBERS, 1e20])
def test_a_vertex_far_from_everything_ends_no_renderer(value):
    in_child(
        "p, t, uv = grid()\n"
        f"p[2, 0] = {str(value).replace('nan', 'np.nan').replace('inf', 'np.inf')}\n"
        "with native.Renderer() as renderer:\n"
        "    try:\n"
        "        renderer.add_snow_mesh('ground', p, t)\n"
        "    except ValueError as error:\n"
        "        assert 'vertices: row 2' in str(error)\n"
        "    else:\n"
        "        raise AssertionError\n"
    )


@pytest.mark.parametrize("value", NOT_NUMBERS)
def test_a_rest_pose_takes_numbers_only(value):
    with native.SnowSimulation(engine="CPU") as simulation:
        with pytest.raises(ValueError, match="'ground': rest: row 2"):
            simulation.add_object("ground", *GROUND[1:], resolution=64, rest=with_number(GROUND[0], value))


@pytest.mark.parametrize("value", NOT_NUMBERS)
@pytest.mark.parametrize("part", ["height", "sums"])
def test_a_state_takes_numbers_only(part, value):
    with stepped() as simulation:
        state = native.simulation_state(simulation)
        state["objects"]["ground"][part].flat[7] = value
        with pytest.raises(ValueError, match="'ground' are not finite numbers"):
            native.set_simulation_state(simulation, state)


@pytest.mark.parametrize("value", NOT_NUMBERS)
@pytest.mark.parametrize("part", ["points", "radii", "areas", "attach_point"])
def test_a_branch_takes_numbers_only(part, value):
    branch = {
        "attach_point": [0.0] * 3,
        "points": [[0, 0, 0], [0, 0, 1.0]],
        "radii": [1.0, 1],
        "areas": [3.0, 3],
    }
    with pytest.raises(ValueError, match="branch 0"):
        native.Skeleton.from_branches(
            [{"name": "a", "level": 0, "parent": -1, **branch, part: with_number(branch[part], value)}]
        )


# -- files ---------------------------------------------------------------------------------------------


try:
    import resource
except ImportError:  # Windows
    resource = None

sees_memory = pytest.mark.skipif(resource is None, reason="this system does not report the peak of memory")


def peak_memory(program):
    """MiB that a child needs more for a program than without."""
    return int(
        in_child(
            "import resource\n"
            "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
            f"{program}\n"
            "print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024)\n"
        )
    )


def exr(width, height, attributes=b""):
    """The first bytes of an EXR file of one float channel."""

    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    return b"".join(
        [
            struct.pack("<2i", 20000630, 2),
            attribute(b"channels", b"chlist", b"Y\0" + struct.pack("<4i", 2, 0, 1, 1) + b"\0"),
            attribute(b"compression", b"compression", b"\0"),
            attribute(b"dataWindow", b"box2i", window),
            attribute(b"displayWindow", b"box2i", window),
            attribute(b"lineOrder", b"lineOrder", b"\0"),
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
            attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)),
            attributes,
            b"\0",
        ]
    )


@sees_memory
@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (exr(8192, 8192) + bytes(50_000), "cannot hold its 8192 x 8192 pixels"),
        (exr(8193, 1) + bytes(50_000), "maximum is 8192"),
        (exr(34_000, 34_000) + bytes(50_000), "maximum is 8192"),
        (exr(4, 4, b"owner\0string\0" + struct.pack("<i", 2**31 - 1)), "truncated"),
    ],
    ids=["short", "wide", "huge", "attribute"],
)
def test_an_image_that_its_file_cannot_hold_takes_no_memory(tmp_path, content, reason):
    (tmp_path / "a.exr").write_bytes(content)
    with pytest.raises(RuntimeError, match=reason):
        native.read_exr(str(tmp_path / "a.exr"))
    taken = peak_memory(
        f"try:\n    native.read_exr({str(tmp_path / 'a.exr')!r})\nexcept RuntimeError:\n    pass"
    )
    assert taken < 20


@pytest.fixture
def bare_checkpoint(tmp_path):
    """8 kB that encode a bare map of 8192 x 8192 texels."""
    mask = zlib.compress(bytes(8192 * 8192 // 8), 1)
    body = struct.pack("<I", 0) + struct.pack("<II", 1, 1)
    body += struct.pack("<I", 6) + b"ground" + struct.pack("<I", 8192) + struct.pack("<16d", *[0] * 16)
    body += struct.pack("<Q", len(mask)) + mask + struct.pack("<QQQI", 0, 0, 0, 0)  # nothing in the air
    path = tmp_path / "state"
    path.write_bytes(b"SNOWBOUGH-STATE\n" + struct.pack("<IQI", 4, len(body), zlib.crc32(body)) + body)
    return str(path)


@sees_memory
def test_a_checkpoint_of_other_maps_takes_no_memory(bare_checkpoint):
    with pytest.raises(ValueError, match="'ground' with 8192 texels per side, which is not among receivers"):
        native.read_checkpoint(bare_checkpoint, {"ground": 64})
    assert native.read_checkpoint(bare_checkpoint, {"ground": 8192})["step_number"] == 1
    taken = peak_memory(
        f"try:\n    native.read_checkpoint({bare_checkpoint!r}, {{'ground': 64}})\nexcept ValueError:\n    pass"
    )
    assert taken < 40


@pytest.mark.skipif(
    os.name == "nt", reason="the fuzzer limits the memory of its processes, which needs POSIX"
)
def test_the_fuzzer_of_the_module_knows_its_functions():
    fuzzer = Path(__file__).resolve().parents[2] / "fuzz" / "fuzz_module.py"
    done = subprocess.run(
        [sys.executable, fuzzer, "--seed", "1", "--seconds", "0", "--calls", "20"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "executed_units: 20" in done.stdout
