# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py export``: exports an imported tree of the loaded file for game engines, and writes a JSON report.

Exit codes: 0 success; 1 there is no such tree, no snow although ``--snow`` asks for it, or a file could not be written;
6 no native module.
"""

import sys
from pathlib import Path

import bpy

from ..bake.outcome import show_bakes
from ..base import native
from ..base.names import EXIT_FAILED, EXIT_NO_NATIVE, EXIT_OK, FAILURES
from ..base.options import add_options, options_of
from ..cache.files import write_report
from ..gltf import scene_tree
from ..gltf.export_options import ExportOptions, ExportProperties
from ..gltf.export_tree import summary
from ..tree.cli import checked_target
from .export_formats import export


def add_arguments(parser):
    """Adds the arguments of ``export``. gltf.export_options declares the options."""
    parser.add_argument(
        "file",
        metavar="FILE.glb",
        help="output file: .glb; .gltf, .usda or .usdc with separate files beside it",
    )
    parser.add_argument("--tree", metavar="NAME", help="name of the tree's armature (default: the only tree)")
    parser.add_argument(
        "--frame", type=int, metavar="N", help="frame whose snow is exported (default: the current frame)"
    )
    parser.add_argument(
        "--cache",
        metavar="DIR",
        help="cache folder of the bake, as for `bake` (default: the file's own bakes)",
    )
    parser.add_argument("--json", metavar="R.json", help="output file of the report")
    add_options(parser, ExportProperties)


def _chosen(scene, name):
    """The armature of the tree `name`; of the only tree for None."""
    trees = scene_tree.all_trees(scene)
    if name is None and len(trees) == 1:
        return next(iter(trees.values()))
    if name not in trees:
        there = ", ".join(sorted(trees)) or "none"
        asked = f"there is no tree '{name}'" if name is not None else "name a tree with --tree"
        raise ValueError(f"{asked}; imported trees in the scene: {there}")
    return trees[name]


def run(args):
    """Exports the tree and returns the exit code. args: see add_arguments."""
    scene = bpy.context.scene
    try:
        report_file, options = checked_target(args.json, ""), options_of(ExportOptions, args)
        if options.snow != "NONE":
            show_bakes(scene, args.cache)
        if args.frame is not None:
            scene.frame_set(args.frame)
        report = export(
            bpy.context,
            _chosen(scene, args.tree),
            Path(args.file).absolute(),
            options,
        )
        if report_file:
            write_report(report_file, report)
    except native.NativeModuleMissing as error:
        print(f"Snowbough: {error}", file=sys.stderr)
        return EXIT_NO_NATIVE
    except FAILURES as error:
        print(f"Snowbough: {error}", file=sys.stderr)
        return EXIT_FAILED
    for text in report["warnings"]:
        print(f"Snowbough: warning: {text}")
    print(f"Snowbough: {summary(report)}")
    return EXIT_OK
