# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py bake``: bakes the loaded file without a window.

One line a frame on standard output, made of ``name=value`` words, seconds and metres::

    SNOWBOUGH frame=12 first=1 last=48 depth=0.025000 volume=0.183201 slid=0.000000 seconds=0.412 left=14.8
              evaluate=0.012 gpu=0.371 files=0.094                                  (all in one line)

While snow surfaces are made after the last frame, ``SNOWBOUGH surfaces=0.35 left=4.1`` is printed every five seconds.

``seconds`` is the time since the frame before; ``left`` includes the surfaces; ``evaluate`` (Blender's poses), ``gpu``
(snow and maps, in either engine) and ``files`` (packing and writing) run in parallel.

``--engine`` sets what computes the snow: GL (OpenGL), CPU (all cores of the processor, without a graphics driver) or
AUTO (GL on a graphics card, else CPU). The default is the add-on's preference, or AUTO without one.

The first line is ``SNOWBOUGH cache="..."``, the folder that the bake uses.

Problems that do not stop the bake, such as overlapping UVs, are printed before it as ``SNOWBOUGH warning="..."`` on
standard error, each receiver that is left out as ``SNOWBOUGH refused="..."``, and each damaged file that a resumed bake
makes again as ``SNOWBOUGH repaired="..."``. With ``--attempts``, each pause between two attempts is printed as
``SNOWBOUGH waiting=SECONDS error="..."``. Errors are printed last, as ``SNOWBOUGH error="..." code=N next="..."``;
``next`` says what a person must do. The JSON report also has ``notes``, such as the space that the maps take.

Exit codes, also in the JSON report:

===  ==================================================================================================
0    everything is baked, or was already, except for receivers that cannot be baked, which are listed
1    the scene or its settings cannot be baked, or an unexpected error occurred; nothing was started
2    the command line is wrong
3    there is no checkpoint to start from
4    settings or scene differ from those of the cached bake; the message names the change
5    the cache cannot be written, is full or is locked by another bake; the bake can be resumed
6    engine GL is asked for without EGL or an OpenGL driver, or the native module is missing
7    the lock of this bake was removed or taken over during the bake; it has stopped writing
130  stopped (Ctrl-C); the bake can be resumed
===  ==================================================================================================
"""

import argparse
import contextlib
import json
import signal
import sys
import time
from pathlib import Path

import bpy

from ..base import native
from ..base.names import (
    EXIT_CACHE,
    EXIT_CHANGED,
    EXIT_FAILED,
    EXIT_LOCK_LOST,
    EXIT_NO_CHECKPOINT,
    EXIT_NO_NATIVE,
    EXIT_OK,
    EXIT_STOPPED,
)
from ..cache.errors import CacheError, InputsChanged, LockLost, NoCheckpoint
from ..cache.files import write_report
from ..settings.preferences import ENGINES
from . import engine, plan, preflight
from .from_scene import make_request, prepare_bake
from .map_writer import WriteFailed
from .outcome import describe, one_line
from .request import NoGpu


def add_arguments(parser):
    """Adds the arguments of ``bake``."""
    parser.add_argument("--frames", metavar="A-B", help="frames to bake (default: the scene's settings)")
    parser.add_argument(
        "--cache",
        metavar="DIR",
        help="cache folder, a path of the system (default: the scene's settings)",
    )
    parser.add_argument("--json", metavar="R.json", help="file for the report")
    parser.add_argument("--resume", action="store_true", help="continue from the last checkpoint")
    parser.add_argument(
        "--continue",
        dest="extend",
        action="store_true",
        help="add the frames by which the shot became longer to a finished bake, whose frames stay as they are",
    )
    parser.add_argument("--objects", metavar="A,B", help="bake only these receivers (default: all)")
    parser.add_argument(
        "--allow-other-driver",
        action="store_true",
        help="resume even if the checkpoint was made by another engine or driver; maps may differ by rounding",
    )
    parser.add_argument(
        "--strict",
        action="store_true",
        help="stop with code 1 before the bake if a receiver is hidden, has no UV map, or exists only as instances "
        "(default: list it and bake the others)",
    )
    parser.add_argument(
        "--attempts",
        type=_positive,
        default=1,
        metavar="N",
        help="try up to N times if the cache is locked by another bake, full or out of reach (default: %(default)s)",
    )
    parser.add_argument(
        "--wait",
        type=_positive,
        default=WAIT_SECONDS,
        metavar="SECONDS",
        help="time between two attempts (default: %(default)s)",
    )
    parser.add_argument(
        "--engine",
        choices=[name for name, *_ in ENGINES],
        help="engine that computes the snow (default: the add-on's preference, else AUTO)",
    )


# What a person, or a farm, must do after an exit code.
NEXT_STEPS = {
    EXIT_FAILED: "Change what the message names, then run the command again",
    EXIT_NO_CHECKPOINT: "Bake from the first frame of the shot",
    EXIT_CHANGED: "Undo the change, or bake the shot again without --resume",
    EXIT_CACHE: "Do what the message says, then run the command again with --resume",
    EXIT_NO_NATIVE: "Run the command with --engine CPU, or on another machine",
    EXIT_LOCK_LOST: "Make sure that no other task bakes these receivers, then run the command again with --resume",
    EXIT_STOPPED: "Run the command again with --resume",
}
WAIT_SECONDS = 60


def exit_code(error):
    """The exit code for an error."""
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
    """Bakes and returns the exit code. args: see add_arguments; those that are missing have their defaults."""
    report = {"exit_code": EXIT_FAILED, "error": None, "frames": [], "receivers": {}}
    with _stopping() as pressed:
        for attempts_left in reversed(range(getattr(args, "attempts", 1))):
            code, message = _attempt(args, report, pressed)
            if code != EXIT_CACHE or not attempts_left or pressed:
                break
            wait = getattr(args, "wait", WAIT_SECONDS)
            print(f"SNOWBOUGH waiting={wait} error={json.dumps(message)}", file=sys.stderr, flush=True)
            end = time.monotonic() + wait
            while time.monotonic() < end and not pressed:
                time.sleep(min(wait, 0.1))
            if pressed:
                code, message = EXIT_STOPPED, "The bake was stopped while it waited"
                break
    # A frame after the last checkpoint is baked again by the next attempt.
    report["frames"] = list({frame["frame"]: frame for frame in report["frames"]}.values())
    report["exit_code"], report["error"] = code, message
    if args.json:
        try:
            Path(args.json).parent.mkdir(parents=True, exist_ok=True)
            write_report(args.json, report)
        except (CacheError, OSError) as error:
            message, code = message or one_line(error), code or EXIT_CACHE
    if message:
        step = json.dumps(NEXT_STEPS[code])
        print(f"SNOWBOUGH error={json.dumps(message)} code={code} next={step}", file=sys.stderr, flush=True)
    else:
        print(
            f"SNOWBOUGH done frames={len(report['frames'])} version={report.get('version', '')}", flush=True
        )
    return code


def _attempt(args, report, pressed):
    """(exit code, message or None)"""
    scene = bpy.context.scene
    settings = scene.snowbough
    first, last = settings.frame_start, settings.frame_end
    try:
        if args.frames:
            first, last = plan.parse_frames(args.frames, first, last)
            if getattr(args, "extend", False):
                raise ValueError("--continue bakes all new frames: leave out --frames")
        objects = plan.parse_names(args.objects)
        request = make_request(
            scene,
            # An attempt continues the bake that the one before began.
            resume=bool(args.resume or report["frames"]),
            first=first,
            last=last,
            objects=objects,
            directory=args.cache,
            allow_other_driver=bool(getattr(args, "allow_other_driver", False)),
            engine=args.engine,
            strict=bool(getattr(args, "strict", False)),
            extend=bool(getattr(args, "extend", False)),
        )
        return _bake(request, report, pressed)
    except (ValueError, RuntimeError, OSError) as error:
        return exit_code(error), one_line(error)


def _positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number of 1 or more")
    return number


@contextlib.contextmanager
def _stopping():
    """Makes Ctrl-C stop the bake after the current frame; Blender itself would end with 2 at the second one. Yields a
    list that is empty until it was pressed."""
    pressed = []

    def stop(*_):
        pressed.append(True)
        engine.stop()

    previous = signal.signal(signal.SIGINT, stop)
    try:
        yield pressed
    finally:
        # None: Blender's own handler, which Python cannot restore. SIG_DFL ends the process.
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

    print(f"SNOWBOUGH cache={json.dumps(request.cache)}", flush=True)

    def on_surfaces():
        left = running.seconds_left() or 0.0
        print(f"SNOWBOUGH surfaces={running.shaping:.2f} left={left:.1f}", flush=True)

    running = prepare_bake(bpy.context.scene, request, on_frame)
    running.on_surfaces = engine.seldom(on_surfaces)
    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    findings = preflight.of_bake(scene, depsgraph)
    report["warnings"] = [issue.text for issue in findings if issue.severity == "WARNING"]
    report["notes"] = [issue.text for issue in findings if issue.severity == "INFO"]
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
    report["repaired"] = job.repaired
    for text in job.repaired:
        print(f"SNOWBOUGH repaired={json.dumps(text)}", file=sys.stderr, flush=True)
    report["receivers"] = {label: str(folder) for label, folder in sorted(job.folders.items())}
    report["settings"] = {"frame_start": request.frame_start, "frame_end": request.frame_end,
                          "first": request.first, "last": request.last}  # fmt: skip
    if running.error is not None:
        return exit_code(running.error), one_line(running.error)
    if running.cancelled:
        return EXIT_STOPPED, describe(running)[1]
    return EXIT_OK, None
