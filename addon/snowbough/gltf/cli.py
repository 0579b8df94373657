# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py export``: writes an imported tree of the loaded file for engines, and a JSON report.

Exit codes: 0 done; 1 there is no such tree, or something could not be written; 6 no native module.
"""

import sys
from pathlib import Path

import bpy

from .. import native
from ..cache.files import write_report
from ..names import EXIT_FAILED, EXIT_NO_NATIVE, EXIT_OK, FAILURES
from ..options import add_options, options_of
from ..tree.cli import checked_target
from . import scene_tree
from .export_options import ExportOptions, ExportProperties
from .export_tree import export, summary


def add_arguments(parser):
    """What ``export`` takes; options as gltf.export_options declares them."""
    parser.add_argument(
        "file", metavar="FILE.glb", help="what is written: .glb, or .gltf with files beside it"
    )
    parser.add_argument(
        "--tree", metavar="NAME", help="the tree's armature; not needed where there is but one"
    )
    parser.add_argument("--frame", type=int, metavar="N", help="the frame whose snow is exported")
    parser.add_argument("--json", metavar="R.json", help="where the report goes")
    add_options(parser, ExportProperties)


def _chosen(scene, name):
    """The armature of the tree `name`, or of the only one."""
    trees = scene_tree.all_trees(scene)
    if name is None and len(trees) == 1:
        return next(iter(trees.values()))
    if name not in trees:
        there = ", ".join(sorted(trees)) or "none"
        asked = f"there is no tree '{name}'" if name is not None else "name a tree with --tree"
        raise ValueError(f"{asked}; imported trees in the scene: {there}")
    return trees[name]


def run(args):
    """Exports as the command line says; returns the exit code. args: see add_arguments."""
    scene = bpy.context.scene
    try:
        report_file = checked_target(args.json, "")
        if args.frame is not None:
            scene.frame_set(args.frame)
        report = export(
            bpy.context,
            _chosen(scene, args.tree),
            Path(args.file).absolute(),
            options_of(ExportOptions, args),
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
