"""A large file is streamed: the memory for reading and rebuilding it is a small multiple of its size."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import snowbough_native as native

MEASURE = """
import json, sys
import snowbough_native as native

def high_water():
    with open("/proc/self/status") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM"))

before = high_water()
skeleton = native.read_tree(sys.argv[1], simplify="TOLERANCE")
read = high_water() - before
native.build_tree_mesh(skeleton, threads=2)
print(json.dumps([len(skeleton.branches), read, high_water() - before]))
"""


def write_forest(path, limbs, rings):
    """A thick trunk and `limbs` tubes of four-sided rings out of it, all round; relative indices."""
    ring = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    rows, corners = np.arange(rings - 1), np.arange(4)
    first = 4 * rows[:, None] - 4 * rings
    faces = np.stack([first + corners, first + (corners + 1) % 4, first + (corners + 1) % 4 + 4,
                      first + corners + 4], axis=-1)  # fmt: skip
    faces = "".join("f %d %d %d %d\n" % tuple(face) for face in faces.reshape(-1, 4).tolist())
    steps = np.arange(rings)[:, None, None]
    with path.open("w") as file:
        for limb in range(limbs + 1):
            out = np.array((np.cos(2.4 * limb), np.sin(2.4 * limb), 0.0))
            side = np.array((-out[1], out[0], 0.0))
            if limb == 0:
                rise = np.array((0.0, 0.0, 0.011 * limbs / rings))
                points = 0.5 * np.c_[ring, np.zeros(4)] + steps * rise
            else:
                around = 0.02 * (ring[:, :1] * side + ring[:, 1:] * np.array((0.0, 0.0, 1.0)))
                points = around + steps * 0.1 * out + (0.0, 0.0, 0.01 * limb)
            file.write("".join("v %.5f %.5f %.5f\n" % tuple(p) for p in points.reshape(-1, 3).tolist()))
            file.write(faces)


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="needs /proc to see the peak of memory")
def test_a_large_file_takes_less_than_ten_times_its_size(tmp_path):
    path = tmp_path / "forest.obj"
    write_forest(path, limbs=3000, rings=40)
    size = path.stat().st_size
    run = subprocess.run(
        [sys.executable, "-c", MEASURE, str(path)],
        env=dict(os.environ, PYTHONPATH=os.path.dirname(native.__file__)),
        text=True,
        capture_output=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    branches, read, whole = json.loads(run.stdout)
    assert branches == 3001
    assert read < 4 * size
    assert whole < 10 * size
