# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py import``: imports a tree into the loaded file, saves a .blend and a JSON report.

Exit codes: 0 done; 1 the file is no tree, or something could not be written; 6 no native module;
130 stopped. A file appears under its name only when it is complete.
"""

import json
import os
import sys
from pathlib import Path

import bpy

from . import import_tree, native

OK, FAILED, NO_NATIVE = 0, 1, 6


def _write_json(path, report):
    partial = path.with_name(f".{path.name}.part")
    try:
        partial.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _save_blend(path):
    partial = path.with_name(f".{path.stem}.part.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, check_existing=False)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _checked_target(name, suffix):
    if name is None:
        return None
    path = Path(name).absolute()
    if suffix and path.suffix != suffix:
        raise ValueError(f"{name} must end in {suffix}")
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent} to write {path.name} into")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(f"the folder {path.parent} cannot be written into")
    return path


def run(args):
    """Imports as the command line says; returns the exit code. args: see cli.parser."""
    try:
        blend, report_file = _checked_target(args.out, ".blend"), _checked_target(args.json, "")
        fields = import_tree.ImportOptions.__dataclass_fields__
        options = import_tree.ImportOptions(
            **{name: getattr(args, name) for name in fields if hasattr(args, name)}
        )
        # A callback is what lets Ctrl-C reach the native part.
        tree = import_tree.read_native(Path(args.file).absolute(), options, progress=lambda _share: True)
        if not bpy.data.filepath:
            # No .blend was given: the startup file's cube, lamp and camera are nobody's scene.
            bpy.data.batch_remove(list(bpy.context.scene.objects))
        import_tree.create_tree(bpy.context, Path(args.file).stem, tree, options)
        if blend:
            _save_blend(blend)
        if report_file:
            _write_json(report_file, tree.report)
    except native.NativeModuleMissing as error:
        print(f"Snowbough: {error}", file=sys.stderr)
        return NO_NATIVE
    except (ValueError, RuntimeError, OSError, MemoryError) as error:
        print(f"Snowbough: {import_tree.message(error)}", file=sys.stderr)
        return FAILED
    for text in tree.report["warnings"]:
        print(f"Snowbough: warning: {text}")
    print(f"Snowbough: {import_tree.summary(tree.report)}")
    return OK
