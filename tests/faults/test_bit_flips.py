# SPDX-License-Identifier: GPL-3.0-or-later
"""Bits flip in the files of a cache, then the bake is resumed. A complete bake must contain no wrong frame."""

import os
import random
import re
import shutil
from collections import Counter, defaultdict

import pytest
import shot
from snowbough.base import native
from snowbough.cache import folder, manifest
from snowbough.cache.errors import CacheError

FLIPS = int(os.environ.get("SNOWBOUGH_TEST_FLIPS", 1000))

# Checkpoints that this bake does not need: their own checksums are compared when they are read.
CHECKED_LATER = re.compile(r"state_\d+(\.json)?$")


@pytest.fixture(scope="module")
def bakes(memory_folder):
    """{kind: cache} of a bake that was killed behind a checkpoint, of one that stopped, and of a finished one."""
    root = memory_folder
    found = {}
    for kind, last in (("stopped", 5), ("finished", shot.FRAMES)):
        found[kind] = root / kind / "cache"
        shot.bake(found[kind], last=last)
    found["killed"] = root / "killed" / "cache"
    shutil.copytree(found["finished"], found["killed"])
    for path in found["killed"].rglob("object.json"):
        whole = manifest.read_manifest(path.parent)
        del whole["checksums"], whole["end"]
        manifest.write_manifest(path.parent, {**whole, "complete": False})
    return found


def by_kind(cache):
    """{kind of file: paths}, names without digits."""
    kinds = defaultdict(list)
    for path in sorted(path for path in cache.rglob("*") if path.is_file() and path.suffix != ".log"):
        kinds[re.sub(r"\d+", "#", path.name)].append(path)
    return kinds


def is_refused_when_read(path):
    """Whether a damaged file of a checkpoint is refused."""
    number = int(re.search(r"\d+", path.name).group())
    try:
        folder.read_sidecar(path.parent, number)
        native.load().read_checkpoint(
            str(path.parent / f"state_{number:04d}"), {path.parent.name: shot.RESOLUTION}
        )
    except (CacheError, RuntimeError, ValueError) as error:
        return str(path) in str(error)
    return False


def outcome(cache, path, whole):
    """The result of resuming a cache with a damaged file: refused, repaired, harmless, or WRONG and the reason."""
    try:
        shot.bake(cache, resume=True)
    except CacheError as error:
        named = path.name in str(error) and str(path.parent) in str(error)
        return "refused" if named else f"WRONG: the message does not name the file: {error}"
    except Exception as error:
        return f"WRONG: {type(error).__name__}: {error}"
    after = shot.files_of(cache)
    different = sorted(name for name in after.keys() | whole.keys() if after.get(name) != whole.get(name))
    if not different:
        return "repaired"
    if different == [str(path.relative_to(cache))] and CHECKED_LATER.search(path.name):
        return "harmless" if is_refused_when_read(path) else "WRONG: a damaged checkpoint is accepted"
    return f"WRONG: {different} are different"


def test_no_flipped_bit_leaves_a_wrong_frame(bakes, memory_folder):
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    moments = random.Random(seed)
    whole = shot.files_of(bakes["finished"])
    counts, wrong = defaultdict(Counter), []
    for number in range(FLIPS):
        kind = sorted(bakes)[number % len(bakes)]
        cache = memory_folder / "flipped" / "cache"
        shutil.copytree(bakes[kind], cache)
        # owner.json names the file beside the cache, so the copy belongs to its own shot.blend.
        name, paths = moments.choice(sorted(by_kind(cache).items()))
        path = moments.choice(paths)
        data = bytearray(path.read_bytes())
        bit = moments.randrange(8 * len(data))
        data[bit // 8] ^= 1 << bit % 8
        path.write_bytes(data)
        result = outcome(cache, path, whole)
        counts[name][result.partition(":")[0]] += 1
        if result.startswith("WRONG"):
            wrong.append(f"{kind} {path.relative_to(cache)} bit {bit}: {result}")
        shutil.rmtree(cache.parent)
    print(f"| file | {' | '.join(RESULTS)} |")
    for name, results in sorted(counts.items()):
        print(f"| {name} | {' | '.join(str(results[result]) for result in RESULTS)} |")
    assert not wrong, "\n".join(wrong[:20])


RESULTS = ("refused", "repaired", "harmless", "WRONG")
