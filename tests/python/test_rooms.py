"""Includes between rooms go downwards only and have no cycles. test_addon_rooms.py checks imports."""

import re
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]

# Floors of native/, the lowest first, and the lower ones that each may use.
FLOORS = {
    "base": "",
    "image": "base",
    "gpu": "base",
    "tree": "base",
    "snow": "base image gpu",
    "render": "base image gpu",
    "python": "base image gpu tree snow render",
}

# Rooms of a folder, the lowest first: each may use those before it. A file of the folder itself can be listed
# like a room; otherwise it is above all rooms. In unlisted folders, rooms need only be free of cycles, and the files of
# the folder itself count as one of them.
ROOMS = {
    "native/render": "data draw tree snow",
    "native/snow": "state texels seams scene movement output surface step",
    "native/snow/movement": "moving_map.h rays repose press melt drift",
    "native/snow/step": "engine cpu gl",
    "native/snow/step/cpu": "kernel.h occlusion",
    "native/snow/step/gl": "scene_buffers.h occlusion.h geometry",
    "native/tree": "skeleton obj rings welded read coverage surface crossings mesh tubes collars detail uv leaves "
    "original kept",
}


# Most lines of source per room. A commit that raises one says why; what a change puts in, it should take out elsewhere.
LINES = {
    "native/base": 950,
    "native/gpu": 1850,
    "native/image": 950,
    "native/python": 3500,
    "native/render": 5150,
    "native/tree": 23350,
    "native/snow/movement": 12100,
    "native/snow/output": 1850,
    "native/snow/scene": 1850,
    "native/snow/seams": 2550,
    "native/snow/state": 550,
    "native/snow/step": 5400,
    "native/snow/surface": 6850,
    "native/snow/texels": 2100,
    "addon/snowbough/bake": 4250,
    "addon/snowbough/base": 1200,
    "addon/snowbough/cache": 1850,
    "addon/snowbough/bending": 750,
    "addon/snowbough/gltf": 2950,
    "addon/snowbough/preview": 1100,
    "addon/snowbough/realtime": 2300,
    "addon/snowbough/result": 2300,
    "addon/snowbough/scene": 2650,
    "addon/snowbough/settings": 1000,
    "addon/snowbough/surface": 900,
    "addon/snowbough/tree": 2700,
    "addon/snowbough/ui": 2550,
    "addon/snowbough/usd": 600,
    "shaders": 5050,
    "benchmarks": 6100,
    "tests": 57400,
}
SOURCES = {".h", ".cpp", ".glsl", ".py"}


class Arrow(NamedTuple):
    """One include. Paths are relative to the root."""

    file: Path
    line: int
    target: Path

    def __str__(self):
        return f"{self.file.as_posix()}:{self.line}: {self.target.as_posix()}"


def includes(root):
    """Arrows between the sources under native/; headers from elsewhere are left out."""
    for path in sorted(root.glob("native/**/*")):
        if path.suffix not in {".h", ".cpp"}:
            continue
        for number, text in enumerate(path.read_text().splitlines(), 1):
            found = re.match(r'\s*#\s*include\s*"([^"]+)"', text)
            if not found:
                continue
            for folder in (path.parent, root / "native"):
                target = (folder / found[1]).resolve()
                if target.is_file() and target.is_relative_to(root / "native"):
                    yield Arrow(path.relative_to(root), number, target.relative_to(root))
                    break


def place_in(folder, path):
    """The room of a folder in which a path lies, or the file that stands in the folder itself."""
    return path.relative_to(folder).parts[0]


def arrows_within(arrows, folder):
    """Arrows from one place of a folder to another: (from, to, arrow)."""
    for arrow in arrows:
        if arrow.file.is_relative_to(folder) and arrow.target.is_relative_to(folder):
            places = place_in(folder, arrow.file), place_in(folder, arrow.target)
            if places[0] != places[1]:
                yield *places, arrow


def allowed_by(order):
    """Per room of an order, the rooms before it."""
    rooms = order.split()
    return {room: set(rooms[:number]) for number, room in enumerate(rooms)}


def upward(arrows, folder, allowed, is_room):
    """The forbidden arrows of a folder. Places that `allowed` does not list are files above all rooms, which may import
    each other, or unlisted rooms."""
    for source, target, arrow in arrows_within(arrows, folder):
        for place in {source, target} - set(allowed):
            if is_room(folder / place):
                yield f"{arrow}: room {place} is not listed in {folder.as_posix()}"
        if source in allowed and target not in allowed[source]:
            yield f"{arrow}: {source} must not know {target}"


def circular(arrows, folder, is_room):
    """The arrows between a folder's rooms that are part of a cycle. The folder's own files are one room."""

    def name(place):
        return place if is_room(folder / place) else f"files of {folder.name}"

    named = [(name(a), name(b), arrow) for a, b, arrow in arrows_within(arrows, folder)]
    between = [a for a in named if a[0] != a[1]]
    known = {}
    for source, target, _ in between:
        known.setdefault(source, set()).add(target)

    def reach(room, seen):
        for other in known.get(room, ()):
            if other not in seen:
                seen.add(other)
                reach(other, seen)
        return seen

    for source, target, arrow in between:
        if source in reach(target, set()):
            yield f"{arrow}: {source} and {target} know each other"


def wrong_arrows(root, floors, rooms):
    """One line for each include that goes upwards or is part of a cycle, with file and line."""
    root = root.resolve()
    arrows = list(includes(root))

    def is_room(path):
        return (root / path).is_dir()

    for folder in sorted({parent for arrow in arrows for parent in arrow.file.parents}):
        if folder == Path("native"):
            yield from upward(
                arrows, folder, {floor: set(to.split()) for floor, to in floors.items()}, is_room
            )
        elif folder.as_posix() in rooms:
            yield from upward(arrows, folder, allowed_by(rooms[folder.as_posix()]), is_room)
        else:
            yield from circular(arrows, folder, is_room)


def test_no_include_runs_upwards_or_in_a_circle():
    assert list(wrong_arrows(ROOT, FLOORS, ROOMS)) == []


def test_the_processors_engine_includes_nothing_of_opengl():
    folder = ROOT / "native" / "snow" / "step" / "cpu"
    lines = [
        f"{path.name}:{number}: {line}"
        for path in sorted(folder.rglob("*.*"))
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if line.startswith("#include") and ('"gpu/' in line or "/gl/" in line or "epoxy" in line)
    ]
    assert len(list(folder.iterdir())) > 10
    assert lines == []


def test_arrows_are_found_at_all():
    assert len(list(includes(ROOT))) > 500


def test_floors_know_only_floors_listed_before_them():
    listed = list(FLOORS)
    for number, (floor, known) in enumerate(FLOORS.items()):
        assert set(known.split()) <= set(listed[:number]), floor


@pytest.mark.parametrize("folder", ROOMS)
def test_listed_rooms_are_there(folder):
    for room in ROOMS[folder].split():
        assert (ROOT / folder / room).exists()


def lines_in(folder):
    return sum(len(path.read_bytes().splitlines()) for path in folder.rglob("*") if path.suffix in SOURCES)


@pytest.mark.parametrize("room", LINES)
def test_a_room_stays_within_its_lines(room):
    count = lines_in(ROOT / room)
    assert 0 < count <= LINES[room], f"{room} has {count} lines"


@pytest.mark.parametrize("floor", ["native", "native/snow", "addon/snowbough"])
def test_every_room_has_a_budget(floor):
    for folder in (ROOT / floor).iterdir():
        if not folder.is_dir() or folder.name == "__pycache__":
            continue
        name = folder.relative_to(ROOT).as_posix()
        assert name in LINES or any(room.startswith(f"{name}/") for room in LINES), name


@pytest.fixture
def house(tmp_path):
    """Writes files from a dictionary of path and text and returns their errors."""

    def check(files, rooms=()):
        for name, text in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return list(wrong_arrows(tmp_path, FLOORS, dict(rooms)))

    return check


def test_an_include_of_a_higher_floor_is_told_with_file_and_line(house):
    wrong = house(
        {
            "native/tree/a.h": '#pragma once\n\n#include "snow/b.h"\n',
            "native/snow/b.h": '#include "base/c.h"\n',
            "native/base/c.h": "#include <vector>\n",
        }
    )
    assert wrong == ["native/tree/a.h:3: native/snow/b.h: tree must not know snow"]


def test_an_include_of_a_higher_room_is_told_with_file_and_line(house):
    wrong = house(
        {
            "native/tree/low/a.h": '#pragma once\n#include "tree/high/b.h"\n',
            "native/tree/high/b.h": "",
            "native/tree/high/c.h": '#include "tree/low/a.h"\n#include "b.h"\n',
        },
        {"native/tree": "low high"},
    )
    assert wrong == ["native/tree/low/a.h:2: native/tree/high/b.h: low must not know high"]


def test_a_file_above_the_rooms_knows_them_all_and_none_knows_it(house):
    wrong = house(
        {
            "native/tree/top.h": '#include "tree/low/a.h"\n#include "tree/beside.h"\n',
            "native/tree/beside.h": "",
            "native/tree/low/a.h": "",
            "native/tree/low/b.cpp": '#include "tree/top.h"\n',
        },
        {"native/tree": "low"},
    )
    assert wrong == ["native/tree/low/b.cpp:1: native/tree/top.h: low must not know top.h"]


def test_a_room_that_is_not_listed_is_told(house):
    wrong = house(
        {"native/tree/new/a.h": '#include "tree/low/b.h"\n', "native/tree/low/b.h": ""},
        {"native/tree": "low"},
    )
    assert wrong == ["native/tree/new/a.h:1: native/tree/low/b.h: room new is not listed in native/tree"]


def test_a_circle_of_rooms_without_an_order_is_told_with_each_of_its_includes(house):
    wrong = house(
        {
            "native/snow/a/x.h": '#include "snow/b/y.h"\n',
            "native/snow/b/y.h": '\n#include "snow/c/z.h"\n',
            "native/snow/c/z.h": '#include "snow/a/x.h"\n#include "snow/d/w.h"\n',
            "native/snow/d/w.h": "",
        }
    )
    assert wrong == [
        "native/snow/a/x.h:1: native/snow/b/y.h: a and b know each other",
        "native/snow/b/y.h:2: native/snow/c/z.h: b and c know each other",
        "native/snow/c/z.h:1: native/snow/a/x.h: c and a know each other",
    ]


def test_a_circle_of_a_room_with_the_files_beside_it_is_told(house):
    files = {
        "native/snow/all.h": '#include "snow/a/x.h"\n',
        "native/snow/a/x.h": '#include "snow/low.h"\n',
        "native/snow/low.h": "",
    }
    assert house(files) == [
        "native/snow/a/x.h:1: native/snow/low.h: a and files of snow know each other",
        "native/snow/all.h:1: native/snow/a/x.h: files of snow and a know each other",
    ]
    assert house(files, {"native/snow": "low.h a"}) == []
