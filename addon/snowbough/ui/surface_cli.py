# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py surface``: recomputes the snow surfaces of the loaded file's bakes, without simulating and without
evaluating the scene. The exit codes are those of ``bake``.
"""

import json
import sys
from functools import partial

import bpy

from ..bake import plan
from ..bake.cli import exit_code
from ..bake.outcome import one_line
from ..base import native
from ..base.names import EXIT_FAILED, EXIT_OK
from ..result import surface_preview
from ..surface import compute
from ..surface.side_by_side import run_side_by_side
from ..surface.style import DETAILS


def add_arguments(parser):
    """Adds the arguments of ``surface``."""
    parser.add_argument("--objects", metavar="A,B", help="update only these receivers (default: all)")
    parser.add_argument("--detail", choices=list(DETAILS), help="point budget (default: the scene's setting)")


def run(args):
    """Updates the surfaces and returns the exit code. args: see add_arguments."""
    scene = bpy.context.scene
    if args.detail:
        scene.snowbough.surface_detail = args.detail
    try:
        names = set(plan.parse_names(args.objects))
        module, tasks = native.load(), surface_preview.tasks(scene, names)
        if not tasks:
            raise ValueError(
                "No baked receiver shows its snow as a surface: bake with Displacement > Snow Surface first"
            )
        jobs = [partial(compute.update, module, folder, style) for _, folder, style in tasks]
        run_side_by_side(jobs, lambda share: True)
        for _, folder, _ in tasks:
            summary = compute.read_summary(folder)
            print(
                f"SNOWBOUGH surface={json.dumps(folder.name)} frames={summary['frames']} points={summary['points']}",
                flush=True,
            )
    except (ValueError, RuntimeError, OSError) as error:
        code = exit_code(error) or EXIT_FAILED
        print(f"SNOWBOUGH error={json.dumps(one_line(error))} code={code}", file=sys.stderr, flush=True)
        return code
    return EXIT_OK
