# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py files``: lists every file that rendering the loaded file needs, one absolute path a line: the .blend, its
libraries, textures and caches, and of each bake the maps of all frames and the snow surface. For the submitters of
render farms, which find the first frame of a sequence only.

Exit codes: 0 all files exist; 1 a receiver has no bake, or a file is missing, which standard error names.
"""

import json
import os
import re
import sys
from pathlib import Path

import bpy

from ..bake.outcome import one_line, show_bakes
from ..base.names import EXIT_FAILED, EXIT_OK, FAILURES
from ..cache.files import STATE_PATTERN, write_bytes
from ..cache.folder import listed_files
from ..cache.manifest import read_manifest

# The number of a frame or of a UDIM tile at the end of a file's name, and what Blender writes instead of a tile's.
_NUMBER = re.compile(r"(\d+|<UDIM>|<UVTILE>)(?=\.[^.]*$)")


def add_arguments(parser):
    """Adds the arguments of ``files``."""
    parser.add_argument(
        "--cache",
        metavar="DIR",
        help="cache folder of the bake, as for `bake` (default: the file's own bakes)",
    )
    parser.add_argument(
        "--out", metavar="FILES.txt", help="write the list there instead of to standard output"
    )


def bake_files(folder):
    """Paths of a bake's files that rendering, Update Surface and Snowbough Realtime read."""
    return [
        path
        for path in listed_files(folder)
        if path.parent == folder and not STATE_PATTERN.match(path.name.removesuffix(".json"))
    ]


def _sequence(path):
    """All files of the numbered sequence that a path belongs to."""
    number = _NUMBER.search(path.name)
    if number is None or not path.parent.is_dir():
        return [path]
    begin, end = path.name[: number.start()], path.name[number.end() :]
    like = re.compile(re.escape(begin) + r"\d+" + re.escape(end))
    return sorted(other for other in path.parent.iterdir() if like.fullmatch(other.name)) or [path]


def _absolute(path, library=None):
    return Path(os.path.normpath(bpy.path.abspath(path, library=library)))


def _other_files():
    """Paths of all files that Blender's own data refers to."""
    sequences = {
        _absolute(data.filepath, data.library)
        for data in (*bpy.data.images, *getattr(bpy.data, "volumes", ()), *bpy.data.cache_files)
        if getattr(data, "source", "") in ("SEQUENCE", "TILED") or getattr(data, "is_sequence", False)
    }
    for path in map(_absolute, bpy.utils.blend_paths(absolute=True, packed=False)):
        yield from _sequence(path) if path in sequences or path.stem.endswith(">") else (path,)


def _problem(entry, folder, manifest):
    """What a receiver's bake lacks, or None."""
    if manifest is None:
        return f"'{entry.object.name}' has no bake: bake it first, or name its cache with --cache"
    if not manifest["complete"]:
        return f"the bake of '{entry.object.name}' in {folder} is not finished: resume it"
    names = [name for frame in manifest["frames"] for name in frame.get("checksums", ())]
    missing = [name for name in (*names, *manifest.get("checksums", ())) if not (folder / name).is_file()]
    return f"{folder / missing[0]} is missing: resume the bake, which makes it again" if missing else None


def shot_files(scene):
    """([Path] that exist, [messages about missing files]) of a scene."""
    found, problems = {}, []
    if bpy.data.filepath:
        found[Path(bpy.data.filepath)] = None
    for entry in scene.snowbough.receivers:
        if entry.object is None or not entry.enabled:
            continue
        folder = _absolute(entry.folder) if entry.folder else None
        manifest = read_manifest(folder) if folder is not None else None
        if manifest is not None:
            found.update(dict.fromkeys(bake_files(folder)))
        problems.append(_problem(entry, folder, manifest))
    for path in _other_files():
        if path.exists():
            found[path] = None
        else:
            problems.append(f"{path} is missing")
    return list(found), list(filter(None, problems))


def run(args):
    """Prints the files and returns the exit code. args: see add_arguments."""
    try:
        show_bakes(bpy.context.scene, args.cache)
        files, problems = shot_files(bpy.context.scene)
        text = "".join(f"{path.as_posix()}\n" for path in files)
        if args.out:
            write_bytes(Path(args.out).absolute(), text.encode())
        else:
            print(text, end="", flush=True)
    except FAILURES as error:
        problems = [one_line(error)]
    for text in problems:
        print(f"SNOWBOUGH missing={json.dumps(text)}", file=sys.stderr, flush=True)
    return EXIT_FAILED if problems else EXIT_OK
