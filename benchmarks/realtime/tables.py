# SPDX-License-Identifier: GPL-3.0-or-later
"""All tables of real time in one markdown document, with the measurements of others beside them.

    /usr/bin/python3 benchmarks/realtime/tables.py [--quick] [--size WIDTH HEIGHT] [--only NAMES] > tables.md

Each section is a script of this folder or of benchmarks/snow, in a process of its own. If a script fails on a machine,
its section ends with the reason, and the exit code is 1. tools/gpu_kit.sh packs all scripts for machines that have only
a graphics driver.
"""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "benchmarks"
MAPLE = ROOT / "tests" / "data" / "small_maple.obj"
GROWN = "grown.obj"  # grown in the folder where the scripts run


@dataclass(frozen=True)
class Section:
    """One script: what it is called on the command line and in the document, its arguments, those of a quick run, and
    what is said below its tables. `{grown}` in arguments is the tree that was grown for this run."""

    name: str
    title: str
    script: str
    arguments: tuple = ()
    quick: tuple = ()
    note: str = ""
    has_size: bool = False


HANAK = """\
Others, on their cards: Hanak 2021, maps of 1024 x 1024 in compute shaders. Ours is `step + output` above, which holds
occlusion and stability besides; normals are no pass of their own, the renderer takes them from the heights by pixel.

| | deformation ms | blur ms | normals ms | together |
|---|---|---|---|---|
| GTX 1060 | 0.07 | 0.13 | 0.14 | 0.34 |
| RTX 2070 Super | 0.03 | 0.05 | 0.03 | 0.11 |

Goals at 1024 x 1024, step and output: 0.8 ms on a card of a GTX 1060's class, 0.15 ms on an H200. On a software
renderer the table shows how the work grows, not how fast a card does it."""

TREES = """\
The thesis's figures stand in the last column, where its own metric is measured: a GTX 460 (D. T. Reynolds, 2014, table
3.1), at another tree. Its table 3.2 is what `THESIS` gains on `nothing tessellated` near and far; the last table is the
same tree as a static mesh, in the same view and run. Goal: ten times the thesis's rates at its polygon counts."""

FOREST = """\
Instances share their base, and all trees go through one chain of passes: dispatches and draws do not grow with the
number of trees. `own bases` shows what other trees cost: the calls stay, the memory grows."""

SNOW = """\
The thesis's table 4.2: six scenes of 1,106 to 42,918 base polygons, 103 to 112 frames a second with maps of 1024 x 1024
on a GTX 580. Its way on this card is `GL, GEOMETRY` in the first table; frame rate against map size (its figure 4.13)
and against base polygons are the third and the last one. But for the first table the engine is the one that Snowbough
chooses here, which the line above them names: GL on a graphics card, the processor where there is none."""

SECTIONS = (
    Section(
        "trees",
        "A tree from near and far: thesis tables 3.1 and 3.2",
        "realtime/trees.py",
        ("{grown}", "--frames", "20"),
        (str(MAPLE), "--frames", "2", "--size", "320", "180"),
        TREES,
        has_size=True,
    ),
    Section(
        "forest",
        "A forest of 1,000 trees",
        "realtime/forest.py",
        (),
        ("--trees", "24", "--apart", "4", "--levels", "2", "--frames", "1", "--size", "320", "180"),
        FOREST,
        has_size=True,
    ),
    Section(
        "step",
        "A step of snow and its output",
        "realtime/step_and_output.py",
        ("--steps", "16"),
        ("--steps", "2", "--sizes", "256,512"),
        HANAK,
    ),
    Section(
        "scenes",
        "Snow as it falls and is drawn: thesis table 4.2",
        "realtime/snow.py",
        ("--frames", "20"),
        ("--quick", "--frames", "1", "--size", "160", "90"),
        has_size=True,
    ),
    Section(
        "snow",
        "Steps by map, occlusion, objects and triangles: thesis table 4.2 and figure 4.13",
        "snow/speed.py",
        ("--steps", "12"),
        ("--steps", "1", "--tables", "triangles"),
        SNOW,
    ),
)


def environment():
    """That of the scripts: they find the module, and the meshes that tests and measurements share."""
    paths = (ROOT / "build" / "python", ROOT / "tests" / "python" / "native")
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths)), "PYTHONDONTWRITEBYTECODE": "1"}


def run(script, *arguments):
    """Runs a script of the checkout; returns (exit code, standard output, standard error)."""
    done = subprocess.run(
        [sys.executable, str(script), *arguments], env=environment(), capture_output=True, text=True
    )
    return done.returncode, done.stdout.strip(), done.stderr.strip()


def machine():
    """Lines about the measured machine."""
    program = (
        "import snowbough_native as n; i = n.Engine('GL').info; print(n.__version__, i['driver'], sep='\\n')"
    )
    done = subprocess.run([sys.executable, "-c", program], env=environment(), capture_output=True, text=True)
    said = done.stdout.split("\n") if done.returncode == 0 else ["?", done.stderr.strip().split("\n")[-1]]
    # Windows has no load average.
    load = f", load {os.getloadavg()[0]:.1f} at the start" if hasattr(os, "getloadavg") else ""
    return [
        f"- OpenGL: {said[1]}",
        f"- Processor: {os.cpu_count()} threads, {platform.machine()}{load}",
        f"- Snowbough {said[0]}, Python {platform.python_version()}, {platform.system()} {platform.release()}",
        f"- {time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}",
    ]


def section(one, quick, grown, size):
    """Prints a section; returns whether its script succeeded. size: of pictures, if not the default."""
    arguments = [word.replace("{grown}", str(grown)) for word in (one.quick if quick else one.arguments)]
    if size and one.has_size:
        arguments += ["--size", *map(str, size)]
    started = time.perf_counter()
    code, tables, complaint = run(BENCHMARKS / one.script, *arguments)
    print(f"\n## {one.title}\n\n{tables}\n")
    if code != 0:
        print(f"**This section is not whole**: `{one.script}` ended with {code}: {complaint[-2000:]}\n")
    print(one.note)
    called = (
        " ".join([one.script, *arguments])
        .replace(f"{ROOT}{os.sep}", "")
        .replace(f"{grown.parent}{os.sep}", "")
    )
    print(f"\n(`benchmarks/{called}`, {time.perf_counter() - started:.0f} s)", flush=True)
    return code == 0


def available():
    """The sections whose scripts are here."""
    return [one for one in SECTIONS if (BENCHMARKS / one.script).is_file()]


def main():
    names = [one.name for one in available()]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--quick", action="store_true", help="few frames and sizes: whether it runs, not how fast"
    )
    parser.add_argument(
        "--size",
        nargs=2,
        type=int,
        metavar=("WIDTH", "HEIGHT"),
        help="of pictures: small for software renderers",
    )
    parser.add_argument("--only", default=",".join(names), metavar="NAMES", help=", ".join(names))
    given = parser.parse_args()
    unknown = set(given.only.split(",")) - set(names)
    if unknown:
        parser.error(f"there is no section {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    print("# Snowbough in real time\n")
    print("\n".join(machine()), flush=True)
    whole = True
    with tempfile.TemporaryDirectory(prefix="snowbough-tables-") as folder:
        grown = Path(folder) / GROWN
        if not given.quick:
            code, _, complaint = run(
                ROOT / "blend_samples" / "grow_tree.py", "--species", "maple", "--seed", "1", str(grown)
            )
            if code:
                sys.exit(f"tables: the tree could not be grown: {complaint}")
        for one in available():
            if one.name in given.only.split(","):
                whole = section(one, given.quick, grown, given.size) and whole
    return 0 if whole else 1


if __name__ == "__main__":
    sys.exit(main())
