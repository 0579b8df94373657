"""The set-up itself: the module is built, and a page names everything it needs."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import snowbough_native
import test_rooms

ROOT = Path(__file__).resolve().parents[2]


def dependencies():
    for line in (ROOT / "tools" / "dependencies.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            yield line.split(None, 1)


def test_module_comes_from_this_checkout():
    assert Path(snowbough_native.__file__).parent == ROOT / "build" / "python"


def test_module_version_is_the_add_ons():
    add_on = (ROOT / "addon" / "snowbough" / "__init__.py").read_text()
    major, minor, patch = snowbough_native.__version__.split(".")
    assert f'"version": ({major}, {minor}, {patch})' in add_on


def test_the_module_asks_numpy_for_no_size_of_an_element():
    """pybind11 before 2.12 (Debian 12) reads it as 0 in Blenders with NumPy 2: see numpy_arrays.h."""
    sources = [*(ROOT / "native" / "python").rglob("*.cpp"), *(ROOT / "native" / "python").rglob("*.h")]
    asking = re.compile(r"nbytes\(|itemsize\(|\barray_t<\w+>(\s+\w+)?\((\d|static_cast)")
    lines = [(path.name, line) for path in sources for line in path.read_text().splitlines()]
    assert [place for place in lines if asking.search(place[1])] == []


def test_a_page_names_every_dependency():
    page = (ROOT / "docs" / "dev" / "packages.md").read_text()
    assert [package for package, _ in dependencies() if f"`{package}`" not in page] == []


def test_every_dependency_says_what_it_is_for():
    assert [line for line in dependencies() if len(line) != 2] == []


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (["nonsense"], "unknown argument 'nonsense'"),
        (["--blender", "2.79"], "not '2.79'"),
        (["--platform", "beos"], "not 'beos'"),
    ],
)
def test_test_script_refuses_unknown_arguments(arguments, complaint):
    ended = subprocess.run(
        [ROOT / "tools" / "test.sh", *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, "SNOWBOUGH_SETUP": "0"},
    )
    assert ended.returncode == 2
    assert complaint in ended.stderr


def test_setup_script_refuses_unknown_arguments_before_it_does_anything():
    ended = subprocess.run([ROOT / "tools" / "setup.sh", "nonsense"], capture_output=True, text=True)
    assert ended.returncode == 2
    assert "unknown argument 'nonsense'" in ended.stderr and ended.stdout == ""


def test_summary_counts_a_layer_that_crashed(tmp_path):
    (tmp_path / "blender.exit").write_text("139\n")
    (tmp_path / "blender.seconds").write_text("7\n")
    ended = subprocess.run(
        ["/usr/bin/python3", ROOT / "tools" / "test_summary.py", tmp_path, "blender"],
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 1
    assert ended.stdout.splitlines()[-1] == "0 passed, 1 failed, 0 skipped"


def test_summary_gives_googletest_and_pytest_reasons_for_skips(tmp_path):
    for layer, case in (
        (
            "native",
            '<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/><system-out>'
            "[ RUN      ] Tree.RealFile\ntree_test.cpp:7: Skipped\n../shared/data is absent\n\n"
            "[  SKIPPED ] Tree.RealFile (0 ms)</system-out>",
        ),
        ("python", '<skipped type="pytest.skip" message="no EGL"/>'),
    ):
        (tmp_path / f"{layer}.exit").write_text("0\n")
        (tmp_path / f"{layer}.seconds").write_text("5\n")
        (tmp_path / f"{layer}.xml").write_text(
            f'<testsuite><testcase classname="a" name="b">{case}</testcase>'
            f'<testcase classname="a" name="c" time="{len(layer)}.25"/></testsuite>'
        )
    ended = subprocess.run(
        ["/usr/bin/python3", ROOT / "tools" / "test_summary.py", tmp_path, "native", "python"],
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0
    assert ended.stdout.splitlines() == [
        "slowest tests:",
        "     6.2 s  python: a c",
        "     6.2 s  native: a c",
        "     0.0 s  python: a b",
        "     0.0 s  native: a b",
        "skipped: native: 1 x ../shared/data is absent",
        "skipped: python: 1 x no EGL",
        "2 passed, 0 failed, 2 skipped",
    ]
    assert (tmp_path / "times.txt").read_text().splitlines()[:3] == [
        "       5 s  native",
        "       5 s  python",
        "     6.2 s  python: a c",
    ]


def test_the_drawing_shows_every_room_that_data_passes():
    sys.path.insert(0, str(ROOT / "tools"))
    import draw_rooms

    drawn = [room for rooms in draw_rooms.PIPELINES.values() for room in rooms]
    native = [
        f"{floor}/{room}"
        for floor in ("native/tree", "native/snow")
        for room in test_rooms.ROOMS[floor].split()
    ]
    addon = [
        f"addon/snowbough/{path.name}" for path in (ROOT / "addon" / "snowbough").iterdir() if path.is_dir()
    ]
    # Used by all of them, or above them.
    beside = {f"addon/snowbough/{name}" for name in ("base", "ui", "__pycache__")}
    assert set(native + addon) - beside - set(drawn) == set()
    assert [room for room in drawn if draw_rooms.lines_of(room) == 0] == []
    picture = draw_rooms.DRAWING.read_text()
    assert [
        name for rooms in draw_rooms.PIPELINES.values() for name in rooms.values() if name not in picture
    ] == []
    shown = dict(re.findall(r">([a-z/]+) · ([\d,]+)<", picture))
    for room in drawn:
        count = int(shown[room.removeprefix("addon/snowbough/").removeprefix("native/")].replace(",", ""))
        now = draw_rooms.lines_of(room)
        assert abs(now - count) <= 0.25 * now, f"{room} has {now} lines, not {count}: run tools/draw_rooms.py"


@pytest.mark.parametrize("page, limit", [("README.md", 80), ("CONTRIBUTING.md", 100)])
def test_the_first_pages_are_short(page, limit):
    assert len((ROOT / page).read_text().splitlines()) < limit


def test_the_pages_of_rooms_have_10_to_20_lines():
    pages = [path for floor in ("native", "addon") for path in (ROOT / floor).rglob("README.md")]
    assert len(pages) > 8
    lines = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in pages}
    assert {page: count for page, count in lines.items() if not 10 <= count <= 20} == {}
