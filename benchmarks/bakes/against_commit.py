# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole bakes of this checkout and of another commit, in turn, in one run. Prints markdown tables.

    git worktree add ../before COMMIT      # and build its module there as its CONTRIBUTING says
    python3 benchmarks/bakes/against_commit.py ../before [--rounds 3] [--demo-tree FILE.obj]
        [--tree FILE.obj] [--tree-options '{"detail": "GAME"}'] [--shots monkey-1024,monkey-2048,tree,demo]
        [--json FILE]

The other checkout's add-on makes each shot once, as a .blend file that both bake, so mesh, layout, rig and keyed
snowfall are the same. Settings that the shot does not set have each add-on's own defaults. Each shot is baked with the
defaults, and once more ("deposit only") with repose 90 degrees and no flutter, as before the angle of repose and the 64
directions. "First frame" is a deposit-only bake of one frame: set-up and one step. Each time is the median of the
rounds, over the call of the operator. Processor time is the sum over all threads, and is comparable on a busy machine.
A ratio above 1 means that this checkout is faster. `tree` needs --tree, whose file is imported with --tree-options in
the terms of the other checkout; `demo` grows the demo's tree unless --demo-tree names one.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
THIS = HERE.parent.parent
KINDS = {
    "defaults": (),
    "deposit only": ("--only-deposit",),
    "first frame": ("--only-deposit", "--first-frame"),
}


def blender(script_arguments, file=None):
    opened = [str(file)] if file else []
    command = ["blender", "-b", "--factory-startup", *opened, "--python-exit-code", "1", "-P"]
    environment = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")
    }
    done = subprocess.run(
        [*command, str(HERE / "in_blender.py"), "--", *map(str, script_arguments)],
        capture_output=True,
        text=True,
        env=environment,
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, script_arguments))}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def make_shot(shot, checkout, tree, options, folder):
    """The shot's .blend file, made by `checkout`."""
    file = folder / f"{shot}.blend"
    of_tree = ["--tree", tree, "--tree-options", options] if tree else []
    output = blender(["make", checkout, shot, file, *of_tree])
    for line in output.splitlines():
        if line.startswith(f"{shot}: "):
            print(line, flush=True)
    return file


def measure(file, checkouts, rounds, folder):
    """{(kind, index of the checkout): [times, ...]}, all of them in turn."""
    taken = {}
    for _ in range(rounds):
        for kind, options in KINDS.items():
            for index, checkout in enumerate(checkouts):
                times = folder / "times.json"
                blender(["bake", checkout, times, *options], file)
                taken.setdefault((kind, index), []).append(json.loads(times.read_text()))
    return taken


def table(title, unit, shots):
    """shots: {shot: measure()}."""
    print(f"\n{title}\n")
    heads = [f"{kind}: {which}" for kind in KINDS for which in ("before", "now", "ratio")]
    print(f"| shot | {' | '.join(heads)} |")
    print("|" + " --- |" * (len(heads) + 1))
    for shot, taken in shots.items():
        cells = []
        for kind in KINDS:
            before, now = (
                statistics.median(times[unit] for times in taken[kind, index]) for index in range(2)
            )
            cells += [f"{before:.2f}", f"{now:.2f}", f"**{before / now:.2f}**"]
        print(f"| {shot} | {' | '.join(cells)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--tree", type=Path)
    parser.add_argument("--tree-options", default="{}")
    parser.add_argument("--demo-tree", type=Path)
    parser.add_argument("--shots", default="monkey-1024,monkey-2048,tree,demo")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    checkouts = (given.before.resolve(), THIS)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shots = {}
        for shot in given.shots.split(","):
            tree = given.demo_tree if shot == "demo" else given.tree if shot == "tree" else None
            if shot == "tree" and tree is None:
                print("tree: left out, because --tree names no file")
                continue
            if shot == "demo" and tree is None:
                tree = folder / "maple.obj"
                grown = checkouts[0] / "blend_samples" / "grow_tree.py"
                subprocess.run(
                    [sys.executable, grown, "--species", "maple", "--seed", "1", tree],
                    check=True,
                    stdout=subprocess.DEVNULL,
                )
            file = make_shot(shot, checkouts[0], tree and tree.resolve(), given.tree_options, folder)
            shots[shot] = measure(file, checkouts, given.rounds, folder)
            for index, which in enumerate(("before", "now")):
                print(f"{shot}, {which}: {shots[shot]['defaults', index][0]['engine']}", flush=True)
    print(f"\n{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, medians of {given.rounds} rounds")
    table("Processor seconds a bake", "processor", shots)
    table("Wall seconds a bake", "wall", shots)
    if given.json:
        rows = {shot: {f"{kind} {i}": times for (kind, i), times in t.items()} for shot, t in shots.items()}
        given.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
