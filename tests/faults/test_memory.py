# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that the panel shows, against the peak of a bake in a process of its own; bakes that do not fit; and many
receivers."""

import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import shot
from snowbough.bake import memory

HERE = Path(__file__).resolve().parent

# Bakes plates in a process of its own and prints the additional bytes at its peak.
CHILD = """
import sys
sys.path.insert(0, sys.argv[1])
import shot

def status(name):
    with open("/proc/self/status") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith(name)) * 1024

cache, count, resolution, frames = sys.argv[2], *map(int, sys.argv[3:])
specs, pose = shot.plates(count, resolution)
shot.native_loader.load()
before = status("VmRSS")
job = shot.bake(
    cache, lambda frame, subframe: pose, frame_end=frames, last=frames, rates=(1.0,) * frames, receivers=specs,
    pixel_size=0.0,
)
print(status("VmHWM") - before, len(job.results))
"""


def peak(cache, count, resolution, frames):
    """(bytes that a bake takes at its peak, number of its frames)"""
    arguments = [str(value) for value in (cache, count, resolution, frames)]
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(HERE), *arguments], check=True, capture_output=True, text=True
    )
    return tuple(map(int, done.stdout.split()[-2:]))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /proc")
@pytest.mark.parametrize("count, resolution, frames", [(1, 1024, 12), (8, 512, 4), (100, 128, 3)])
def test_the_estimate_is_what_a_bake_takes(memory_folder, count, resolution, frames):
    used, baked = peak(memory_folder / f"{count}" / "cache", count, resolution, frames)
    estimated = memory.estimate([memory.MapSize(resolution, 32)] * count, shot.REPOSE, True)
    print(f"{count} x {resolution}: estimate {estimated >> 20} MiB, used {used >> 20} MiB")
    assert baked == frames
    assert used < 1.1 * estimated < 1.75 * used


@pytest.mark.skipif(not memory.available(), reason="the free memory is unknown")
def test_a_bake_that_does_not_fit_makes_neither_files_nor_texel_tables(tmp_path):
    one = memory.estimate([memory.MapSize(8192, 32)], shot.REPOSE, True)
    specs, pose = shot.plates(2 + 2 * memory.available() // one, 8192)

    def no_simulation(**_settings):
        raise AssertionError("a simulation is made")

    native = SimpleNamespace(**{**vars(shot.native_loader.load()), "SnowSimulation": no_simulation})
    with pytest.raises(RuntimeError, match="of memory, but only .* are free: lower the resolution"):
        shot.bake(tmp_path / "cache", lambda frame, subframe: pose, native, receivers=specs)
    assert not (tmp_path / "cache").exists()


# Bakes 1,050 bending plates with surfaces in a process that may open 1,024 files, as most may.
FEW_FILES = """
import dataclasses, resource, sys
sys.path.insert(0, sys.argv[1])
import shot
specs, pose = shot.plates(1050, 64, 1)
specs = tuple(dataclasses.replace(spec, surface=shot.SurfaceStyle("DRAFT")) for spec in specs)

def bent(frame, subframe):
    objects = {}
    for key, obj in pose.objects.items():
        local = obj.local + [[0.0, 0.0, 0.1 * frame * x] for x in obj.local[:, 0]]
        spec = dataclasses.replace(obj.receiver, surface=specs[0].surface)
        objects[key] = dataclasses.replace(obj, local=local.astype("f4"), receiver=spec)
    return dataclasses.replace(pose, objects=objects)

resource.setrlimit(resource.RLIMIT_NOFILE, (1024, 1024))
shot.bake(sys.argv[2], bent, frame_end=2, last=2, rates=(1.0,) * 2, receivers=specs, pixel_size=0.2)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs limits of open files")
def test_there_may_be_more_receivers_than_open_files(memory_folder):
    command = [sys.executable, "-c", FEW_FILES, str(HERE), str(memory_folder / "few" / "cache")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert len(list((memory_folder / "few").rglob("surface.pc2"))) == 1050


def test_a_bake_of_5000_receivers_ends(memory_folder):
    needed = memory.estimate([memory.MapSize(64, 32)] * 5000, shot.REPOSE, True)
    if memory.available() < needed:
        pytest.skip(f"needs {needed >> 30} GiB of memory")
    begun = time.monotonic()
    used, baked = peak(memory_folder / "many" / "cache", 5000, 64, 2)
    print(f"{time.monotonic() - begun:.0f} s, {used >> 20} MiB, estimate {needed >> 20} MiB")
    assert baked == 2
    assert len(list((memory_folder / "many").rglob("height_0002.exr"))) == 5000
