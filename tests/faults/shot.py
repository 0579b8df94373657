# SPDX-License-Identifier: GPL-3.0-or-later
"""A short shot of plain data, and its bake without Blender: the job, the cache and the native module are the real ones.

    python3 tests/faults/shot.py CACHE [--resume] [--last FRAME] [--wait SECONDS]

A ground, a cart that drives over it, and a flag that bends, all of them receivers; the flag ends with a snow surface.
The exit code is 0 if everything is baked, 5 or 7 as in ``snowbough bake`` with a message, or 1 for an unexpected error.
--wait: pause after each pose, for tests that interfere.
"""

import argparse
import hashlib
import math
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))

from snowbough.bake.job import BakeJob  # noqa: E402
from snowbough.bake.map_writer import WriteFailed  # noqa: E402
from snowbough.bake.request import BakeRequest  # noqa: E402
from snowbough.base import native as native_loader  # noqa: E402
from snowbough.base.map_kinds import ON_REQUEST  # noqa: E402
from snowbough.base.names import EXIT_CACHE, EXIT_LOCK_LOST  # noqa: E402
from snowbough.cache import manifest, owner  # noqa: E402
from snowbough.cache.errors import CacheBusy, CacheError, LockLost  # noqa: E402
from snowbough.scene.inputs import fingerprint  # noqa: E402
from snowbough.scene.pose import ObjectPose, ReceiverSpec, ScenePose, Topology, own_key  # noqa: E402
from snowbough.surface.style import SurfaceStyle  # noqa: E402

FRAMES = 8
INTERVAL = 3
RESOLUTION = 64
REPOSE = math.radians(60.0)

_SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
_UV = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
_TOPOLOGY = Topology(_TRIANGLES, _UV, 4, fingerprint(_TRIANGLES, _UV))

SPECS = (
    ReceiverSpec("Cart", "", "snow", RESOLUTION),
    ReceiverSpec("Flag", "", "snow", RESOLUTION, surface=SurfaceStyle("DRAFT")),
    ReceiverSpec("Ground", "", "snow", RESOLUTION),
)


def _object(name, local, matrix):
    spec = next(spec for spec in SPECS if spec.name == name)
    positions = (local @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    prints = (fingerprint(matrix), fingerprint(local), _TOPOLOGY.print)
    key = own_key(name, "")
    return ObjectPose(key, name, name, "", spec, "snow", _TOPOLOGY, positions, prints, local, matrix)


def _placed(x, y, z, scale):
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = x, y, z
    return matrix


def pose(frame, subframe):
    """The ScenePose of a frame of the shot."""
    share = (frame + subframe - 1) / (FRAMES - 1)
    bent = _SQUARE.copy()
    bent[2:, 2] = 0.5 * math.sin(3.0 * share)
    objects = [
        _object("Ground", _SQUARE, _placed(0.0, 0.0, 0.0, 1.5)),
        _object("Cart", _SQUARE, _placed(2.0 * share - 1.0, 0.0, 0.8, 0.4)),
        _object("Flag", bent, _placed(0.0, -1.0, 0.4, 0.3)),
    ]
    return ScenePose({obj.key: obj for obj in sorted(objects, key=lambda obj: obj.key)}, 0.3, 1.0, 1.0)


def request(cache, **changes):
    """The BakeRequest of the whole shot."""
    snow = {
        "flutter": 0.05, "noise_density": 0.5, "repose": REPOSE, "slide_half_life": 0.5,
        "mapping": "COMPUTE", "seed": 1, "landing": True, **manifest.LATER,
    }  # fmt: skip
    whole = {
        "scene_name": "Scene", "cache": str(cache), "cache_id": "0123456789abcdef", "frame_start": 1,
        "frame_end": FRAMES, "first": 1, "last": FRAMES, "fps": 24.0, "start_depth": 0.0, "end_depth": 0.1,
        "rates": (1.0,) * FRAMES, "snow": snow, "texel_size": 0.01, "pixel_size": 0.04, "blur_radius": 1.0,
        "substeps": 1, "directions": 4, "checkpoint_interval": INTERVAL, "receivers": SPECS,
        "maps": {kind.name: kind.name == "normal" for kind in ON_REQUEST}, "engine": "CPU",
        "blend": str(Path(cache).parent / "shot.blend"),
    }  # fmt: skip
    return BakeRequest(**{**whole, **changes})


def bake(cache, evaluate=pose, native=None, **changes):
    """Bakes into `cache` as the file shot.blend beside it; returns the BakeJob. Raises the errors of BakeJob.run.
    native: the module; None: that of the add-on."""
    job = BakeJob(request(cache, **changes), native or native_loader.load())
    if not owner.is_owner(job.root, job.request.blend):  # bake.cache_place asks this first, too
        raise CacheBusy(f"{job.root} belongs to another file")
    job.run(evaluate)
    return job


def plates(count, resolution, faces=4):
    """(receivers' specs, ScenePose) of level plates in rows, of faces x faces quads each."""
    at = np.linspace(-1.0, 1.0, faces + 1, dtype=np.float32)
    x, y = (values.ravel() for values in np.meshgrid(at, at))
    local = np.stack([x, y, 0.2 * np.sin(3.0 * x)], axis=1)
    first = (np.arange(faces)[:, None] * (faces + 1) + np.arange(faces)).ravel()
    quads = np.stack([first, first + 1, first + faces + 2, first + faces + 1], axis=1).astype(np.int32)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    uv = ((np.stack([x, y], axis=1) + 1.0) / 2.0)[triangles]
    topology = Topology(triangles, uv, len(local), fingerprint(triangles, uv))
    specs = [ReceiverSpec(f"Plate {number}", "", "snow", resolution) for number in range(count)]
    columns = math.isqrt(count) + 1
    objects = {}
    for number, spec in enumerate(specs):
        matrix = _placed(3.0 * (number % columns), 3.0 * (number // columns), 0.0, 1.0)
        positions = (local + matrix[:3, 3]).astype(np.float32)
        prints = (fingerprint(matrix), fingerprint(local), topology.print)
        key = own_key(spec.name, "")
        objects[key] = ObjectPose(
            key, spec.name, spec.name, "", spec, "snow", topology, positions, prints, local, matrix
        )
    return tuple(specs), ScenePose(dict(sorted(objects.items())), 0.3, 1.0, 1.0)


def files_of(root):
    """{relative path: digest of its bytes} of everything in a cache but the logs."""
    root = Path(root)
    return {
        str(path.relative_to(root)): hashlib.blake2b(path.read_bytes(), digest_size=16).hexdigest()
        for path in sorted(root.rglob("*"))
        if path.is_file() and "logs" not in path.parts
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cache", type=Path)
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--last", type=int, default=FRAMES)
    parser.add_argument("--wait", type=float, default=0.0)
    options = parser.parse_args()

    def evaluate(frame, subframe):
        print("pose", frame, flush=True)
        time.sleep(options.wait)
        return pose(frame, subframe)

    try:
        bake(options.cache, evaluate, resume=options.resume, last=options.last)
    except (CacheError, WriteFailed) as error:
        print(error, file=sys.stderr)
        return EXIT_LOCK_LOST if isinstance(error, LockLost) else EXIT_CACHE
    return 0


if __name__ == "__main__":
    sys.exit(main())
