# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of the cache with a right checksum and wrong content: each is refused with a message, none ends in a traceback
or fills the memory."""

import copy
import itertools
import json
import math
import os
import random
import resource
import shutil

import pytest
import shot
from snowbough.base import native
from snowbough.cache import folder, integrity, journal, manifest, owner, sealed, versions
from snowbough.cache.errors import CacheError
from snowbough.surface import compute
from snowbough.surface.style import SurfaceStyle

VALUES = (
    None, True, -1, 0, 1 << 40, 10**400, 30_000_000, 1e300, -0.5, "", "a\0b", "\ud800", "../../x", "x" * 100_000,
    [], [1], [[]], {}, {"a": 1}, {"../x": "0" * 32}, [1] * 16, [0.0] * 16, [1e30] * 16, "9" * 5000,
)  # fmt: skip
tick = itertools.count()
# Numbers of changes, seeded.
CHANGES = int(os.environ.get("SNOWBOUGH_TEST_CHANGES", 800))
RESUMED = int(os.environ.get("SNOWBOUGH_TEST_RESUMED", 60))


@pytest.fixture(scope="module")
def finished(memory_folder):
    shot.bake(memory_folder / "finished" / "cache")
    return memory_folder / "finished" / "cache"


@pytest.fixture
def moments():
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    return random.Random(seed)


@pytest.fixture(autouse=True)
def little_memory():
    """A limit of the memory that a number may fill."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm") as pages:
        now = int(pages.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (now + (1 << 30), before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


def places(value, path=()):
    """Paths of all entries in JSON."""
    entries = (
        value.items() if isinstance(value, dict) else enumerate(value[:2]) if isinstance(value, list) else ()
    )
    for key, own in entries:
        yield (*path, key)
        yield from places(own, (*path, key))


def changed(value, path, new):
    """A copy with another entry, or without it if `new` is Ellipsis."""
    value = copy.deepcopy(value)
    inside = value
    for key in path[:-1]:
        inside = inside[key]
    if new is ...:
        del inside[path[-1]]
    else:
        inside[path[-1]] = new
    return value


def write(path, value):
    """Seals any value."""
    body = json.dumps(value, sort_keys=True, indent=1).encode() + b"\n"
    seal = sealed._checksum(body).decode()
    path.write_bytes(body[:-3] + f',\n "checksum": "{seal}"\n}}\n'.encode())


def write_lines(place, header, entries, poses):
    """A journal of any values, sealed up to the manifest."""
    seal, raw = b"", b""
    for entry, own in zip([header, *entries], [[], *poses]):
        body = f"{json.dumps(entry)}\t{json.dumps(own)}\n".encode()
        seal = journal._checksum(seal, body)
        raw += seal + b"\t" + body
    (place / "frames.tsv").write_bytes(raw)
    known = json.loads((place / "object.json").read_text())
    del known["checksum"]
    write(place / "object.json", {**known, "end": {"bytes": len(raw), "checksum": seal.decode()}})


def read_surface(place):
    """Computing a surface takes long, so only a few of the changes get there; all are read and give numbers."""
    compute.read_summary(place)
    inputs = compute.SurfaceInputs(native.load(), place)
    inputs.pose(0)
    assert (
        0 < compute.WantedPoints(*inputs.manifest.get("wanted", ())).most(*compute.DETAILS["FILM"]) < 1 << 31
    )
    assert all(map(math.isfinite, (*inputs.wind(), inputs.depth(0), inputs.world(0).max())))
    if next(tick) % 40 == 0:
        compute.Surface(native.load(), place, SurfaceStyle("DRAFT")).points(0)


def read_checkpoints(place):
    for frame in folder.checkpoints(place):
        sidecar = folder.read_sidecar(place, frame)
        folder.lines_until(place, frame, sidecar)


def look(place):
    """All that reads a receiver's folder without a bake. Returns the messages of the refusals."""
    said = []
    for read in (
        lambda: manifest.read_manifest(place),
        lambda: manifest.read_inputs(place),
        lambda: folder.listed_files(place),
        lambda: integrity.first_damage(place, manifest.read_head(place)),
        lambda: read_checkpoints(place),
        lambda: versions.choose_version(place.parent.parent, [place.name], "s"),
        lambda: versions.find_bakes(place.parent.parent, ("",)),
        lambda: read_surface(place),
        lambda: owner.is_owner(place.parent.parent, place / "shot.blend"),
    ):
        try:
            read()
        except (CacheError, compute.NoSurface) as error:
            said.append(str(error))
    return said


def harms(place):
    """(name, function that writes it) of all changes of one entry in one file of a receiver."""
    for path in [*sorted(place.glob("*.json")), place.parent.parent / "owner.json"]:
        value = json.loads(path.read_text())
        value.pop("checksum", None)
        for at in places(value):
            for new in (..., *VALUES):
                yield (
                    f"{path.name} {at} {new!r:.40}",
                    lambda p=path, v=value, a=at, n=new: write(p, changed(v, a, n)),
                )
    lines = [line.split("\t") for line in (place / "frames.tsv").read_text().splitlines()]
    rows = [[json.loads(entry), json.loads(poses)] for _, entry, poses in lines]
    for at in places(rows[:2]):
        for new in (..., *VALUES):
            if len(at) > 2:

                def write_changed(a=at, n=new):
                    all_rows = [*changed(rows[:2], a, n), *rows[2:]]
                    write_lines(
                        place,
                        all_rows[0][0],
                        [row[0] for row in all_rows[1:]],
                        [r[1] for r in all_rows[1:]],
                    )

                yield f"frames.tsv {at} {new!r:.40}", write_changed


def test_wrong_content_gets_a_sentence(finished, memory_folder, moments):
    cache = shutil.copytree(finished, memory_folder / "looked" / "cache")
    (place,) = cache.rglob("Flag-*")
    files = {path: path.read_bytes() for path in cache.rglob("*") if path.suffix in (".json", ".tsv")}
    assert look(place) == []
    all_harms, refused, failures = list(harms(place)), 0, []
    for name, harm in moments.sample(all_harms, CHANGES):
        harm()
        try:
            said = look(place)
            assert all(len(text) < 2000 for text in said)
        except Exception as error:
            failures.append(f"{name}: {type(error).__name__}: {error}"[:300])
        refused += bool(said)
        for path, data in files.items():
            if path.read_bytes() != data:
                path.write_bytes(data)
    print(f"{refused} of {CHANGES} changes refused, of {len(all_harms)}")
    assert not failures, "\n".join(failures[:20])
    assert refused > CHANGES // 2


def test_a_resumed_bake_refuses_or_repairs_wrong_content(finished, memory_folder, moments):
    for _ in range(RESUMED):
        cache = shutil.copytree(finished, memory_folder / "resumed" / "cache")
        (place,) = cache.rglob("Flag-*")
        name, harm = moments.choice(list(harms(place)))
        harm()
        try:
            shot.bake(cache, resume=True)
        except CacheError:
            pass
        except Exception as error:
            raise AssertionError(f"{name}: {type(error).__name__}: {error}") from error
        shutil.rmtree(cache.parent)
