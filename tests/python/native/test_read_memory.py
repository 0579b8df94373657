"""A large file is streamed: the memory for reading and rebuilding it is a small multiple of its size."""

import json
import os
import subprocess
import sys

import pytest
import snowbough_native as native
from forest import write_forest

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
