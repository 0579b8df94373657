# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py bake``: bakes the loaded file without a window.

One line a frame on standard output, made of ``name=value`` words, seconds and metres::

    SNOWBOUGH frame=12 first=1 last=48 depth=0.025000 volume=0.183201 slid=0.000000 seconds=0.412 left=14.8
              evaluate=0.012 gpu=0.371 files=0.094                                  (all in one line)

``seconds`` is the time from the frame before to this one; ``evaluate`` (Blender's poses), ``gpu`` (snow and
maps, whichever engine computes them) and ``files`` (packing and writing) run beside each other.

``--engine`` says what computes the snow: GL (OpenGL), CPU (all cores of the processor, no graphics driver needed)
or AUTO (GL on a graphics card, else CPU). Without it the add-on's preference counts, and AUTO where there is none.

What would not look right, such as overlapping UVs, comes before as ``SNOWBOUGH warning="..."`` on
standard error, each receiver that is left out as ``SNOWBOUGH refused="..."``, what went wrong after as
``SNOWBOUGH error="..." code=N``.

Exit codes, also in the JSON report:

===  ==================================================================================================
0    everything asked for is baked (or was already), but for receivers that cannot be, which are listed
1    the scene or its settings cannot be baked, or something unforeseen happened; nothing was begun
2    the command line is wrong
3    no checkpoint to start from
4    settings or scene are not those that the cache was baked from; the message names what changed
5    the cache cannot be written, is full or is locked by another bake; what is done can be resumed
6    engine GL is asked for and there is no EGL or no OpenGL driver, or there is no native module
7    the lock of this bake was removed while it ran, or another bake has it; nothing more was written
130  stopped (Ctrl-C); what is done can be resumed
===  ==================================================================================================
"""

import contextlib
import json
import signal
import sys
from pathlib import Path

import bpy

from .. import native
from ..cache.errors import CacheError, InputsChanged, LockLost, NoCheckpoint
from ..cache.files import write_report
from ..names import (
    EXIT_CACHE,
    EXIT_CHANGED,
    EXIT_FAILED,
    EXIT_LOCK_LOST,
    EXIT_NO_CHECKPOINT,
    EXIT_NO_NATIVE,
    EXIT_OK,
    EXIT_STOPPED,
)
from ..settings.preferences import ENGINES
from . import engine, plan, preflight
from .from_scene import make_request, prepare_bake
from .map_writer import WriteFailed
from .outcome import describe, one_line
from .request import NoGpu


def add_arguments(parser):
    """What ``bake`` takes."""
    parser.add_argument("--frames", metavar="A-B", help="default: the scene's settings")
    parser.add_argument(
        "--cache",
        metavar="DIR",
        help="default: the scene's settings; // stands for the folder of the .blend",
    )
    parser.add_argument("--json", metavar="R.json")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--objects", metavar="A,B", help="only these receivers")
    parser.add_argument(
        "--allow-other-driver",
        action="store_true",
        help="resume although the checkpoint is another engine's or driver's",
    )
    parser.add_argument(
        "--strict",
        action="store_true",
        help="end with code 1, before anything is baked, where a receiver cannot be: hidden, without a UV map, "
        "scattered as instances (default: list it and bake the others)",
    )
    parser.add_argument(
        "--engine",
        choices=[name for name, *_ in ENGINES],
        help="what computes the snow (default: the add-on's preference, else AUTO)",
    )


def exit_code(error):
    """The exit code for what went wrong."""
    for kinds, code in (
        ((NoCheckpoint,), EXIT_NO_CHECKPOINT),
        ((InputsChanged,), EXIT_CHANGED),
        ((LockLost,), EXIT_LOCK_LOST),
        ((CacheError, OSError), EXIT_CACHE),
        ((native.NativeModuleMissing, NoGpu), EXIT_NO_NATIVE),
        ((WriteFailed,), EXIT_CACHE),
    ):
        if isinstance(error, kinds):
            return code
    return EXIT_FAILED


def frame_line(result, seconds_left):
    return (
        f"SNOWBOUGH frame={result.frame} first={result.first} last={result.last} depth={result.depth:.6f} "
        f"volume={result.volume:.6f} slid={result.slid:.6f} seconds={result.seconds['total']:.3f} "
        f"left={seconds_left:.1f} "
        + " ".join(f"{name}={result.seconds[name]:.3f}" for name in ("evaluate", "gpu", "files"))
    )


def run(args):
    """Bakes as the command line says and returns the exit code.

    args: namespace with frames ("1-48" or None), cache (folder or None), json (file or None), resume
    (bool), objects ("A,B" or None), engine (AUTO, GL, CPU or None), strict (bool).
    """
    scene = bpy.context.scene
    report = {"exit_code": EXIT_FAILED, "error": None, "frames": [], "receivers": {}}
    code, message = EXIT_FAILED, None
    try:
        with _stopping() as pressed:
            settings = scene.snowbough
            first, last = settings.frame_start, settings.frame_end
            if args.frames:
                first, last = plan.parse_frames(args.frames, first, last)
            objects = [name.strip() for name in (args.objects or "").split(",") if name.strip()]
            request = make_request(
                scene,
                resume=bool(args.resume),
                first=first,
                last=last,
                objects=objects,
                directory=args.cache,
                allow_other_driver=bool(getattr(args, "allow_other_driver", False)),
                engine=args.engine,
                strict=bool(getattr(args, "strict", False)),
            )
            code, message = _bake(request, report, pressed)
    except (ValueError, RuntimeError, OSError) as error:
        code, message = exit_code(error), one_line(error)
    report["exit_code"], report["error"] = code, message
    if args.json:
        try:
            Path(args.json).parent.mkdir(parents=True, exist_ok=True)
            write_report(args.json, report)
        except (CacheError, OSError) as error:
            message, code = message or one_line(error), code or EXIT_CACHE
    if message:
        print(f"SNOWBOUGH error={json.dumps(message)} code={code}", file=sys.stderr, flush=True)
    else:
        print(
            f"SNOWBOUGH done frames={len(report['frames'])} version={report.get('version', '')}", flush=True
        )
    return code


@contextlib.contextmanager
def _stopping():
    """Ctrl-C, however often, stops the bake after the frame that it works on; Blender itself would end with 2 at the
    second one. Gives a list that is filled once it was pressed."""
    pressed = []

    def stop(*_):
        pressed.append(True)
        engine.stop()

    previous = signal.signal(signal.SIGINT, stop)
    try:
        yield pressed
    finally:
        # None: Blender's own handler, which Python can't put back. SIG_DFL ends the process.
        signal.signal(signal.SIGINT, previous if previous is not None else signal.SIG_DFL)


def _bake(request, report, pressed):
    """(exit code, message or None)"""

    def on_frame(result):
        left = running.seconds_left() or 0.0
        print(frame_line(result, left), flush=True)
        report["frames"].append(
            {
                "frame": result.frame,
                "depth": result.depth,
                "volume": result.volume,
                "slid": result.slid,
                "seconds": {name: round(value, 6) for name, value in sorted(result.seconds.items())},
            }
        )

    running = prepare_bake(bpy.context.scene, request, on_frame)
    report["warnings"] = preflight.warnings(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    for text in report["warnings"]:
        print(f"SNOWBOUGH warning={json.dumps(text)}", file=sys.stderr, flush=True)
    running.stop_requested = bool(pressed)
    engine.run(bpy.context, running)
    job = running.job
    report["version"] = str(job.version) if job.version else ""
    report["pixel_size"] = job.pixel_size
    report["refused"] = job.refused
    for reason in job.refused.values():
        print(f"SNOWBOUGH refused={json.dumps(reason)}", file=sys.stderr, flush=True)
    report["receivers"] = {label: str(folder) for label, folder in sorted(job.folders.items())}
    report["settings"] = {"frame_start": request.frame_start, "frame_end": request.frame_end,
                          "first": request.first, "last": request.last}  # fmt: skip
    if running.error is not None:
        return exit_code(running.error), one_line(running.error)
    if running.cancelled:
        return EXIT_STOPPED, describe(running)[1]
    return EXIT_OK, None
