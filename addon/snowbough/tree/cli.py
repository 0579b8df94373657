# SPDX-License-Identifier: GPL-3.0-or-later
"""``cli.py import``: imports trees into the loaded file, saves a .blend and a JSON report.

Exit codes: 0 done; 1 a file is not a tree, or a file could not be written; 6 the native module is missing; 8 a tree's
limbs represent too little of its wood: it was imported, and the warning says which parts are missing; 130 stopped.
If some files are not trees, the others are imported. A file gets its final name only when it is complete.
"""

import os
import sys
from pathlib import Path

import bpy

from ..base import native
from ..base.names import EXIT_COVERAGE, EXIT_FAILED, EXIT_NO_NATIVE, EXIT_OK, FAILURES
from ..base.options import add_options, options_of
from ..cache.files import write_report
from . import import_tree
from .import_options import ImportOptions, ImportProperties

# Flags of options whose flag is not their name.
FLAGS = {"foliage": "--no-foliage", "foliage_names": "--foliage"}


def add_arguments(parser):
    """Adds the arguments of ``import``; the options are those of tree.import_options."""
    parser.add_argument(
        "files", metavar="FILE.obj", nargs="+", help="trees, or folders of trees, to import into one scene"
    )
    parser.add_argument(
        "--out", metavar="F.blend", help="file to save the scene to (default: nothing is saved)"
    )
    parser.add_argument("--json", metavar="R.json", help="file for the report")
    add_options(parser, ImportProperties, FLAGS)


def _save_blend(path):
    partial = path.with_name(f".{path.stem}.part.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, check_existing=False)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def checked_target(name, suffix):
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


def _import(args, options):
    """([(collection, report), ...], [Failure, ...]) of the files in the command line."""
    paths = import_tree.chosen_files("", "", [str(Path(name).absolute()) for name in args.files])
    units = import_tree.units_per_metre(bpy.context.scene)
    # The callback lets Ctrl-C reach the native module.
    trees, failures = import_tree.read_files(paths, options, lambda _share: True, units)
    if trees and not bpy.data.filepath:
        # Without a .blend, the scene has only the objects of the startup file.
        bpy.data.batch_remove(list(bpy.context.scene.objects))
    collections = import_tree.create_trees(bpy.context, trees, options)
    return list(zip(collections, (tree.report for _path, tree in trees))), failures


def _json(reports, failures, several):
    """The content of the report file: the report of one file, or a list for several."""
    if not several:
        return reports[0]
    refused = [
        {"file": str(failure.path), "error": import_tree.message(failure.error)} for failure in failures
    ]
    return {"trees": reports, "failures": refused}


def run(args):
    """Imports the files; returns the exit code. args: see add_arguments."""
    try:
        blend, report_file = checked_target(args.out, ".blend"), checked_target(args.json, "")
        made, failures = _import(args, options_of(ImportOptions, args))
        reports = [report for _collection, report in made]
        several = len(reports) + len(failures) > 1
        for failure in failures:
            print(f"Snowbough: {failure.text()}", file=sys.stderr)
        if blend and made:
            _save_blend(blend)
        if report_file and (made or several):
            write_report(report_file, _json(reports, failures, several))
    except native.NativeModuleMissing as error:
        print(f"Snowbough: {error}", file=sys.stderr)
        return EXIT_NO_NATIVE
    except FAILURES as error:
        print(f"Snowbough: {import_tree.message(error)}", file=sys.stderr)
        return EXIT_FAILED
    for report in reports:
        named = f"{report['file']}: " if several else ""
        for text in import_tree.warning_lines(report):
            print(f"Snowbough: warning: {named}{text}")
    if several:
        print(f"Snowbough: {import_tree.summary_of_all(reports, failures)}")
    elif made:
        print(f"Snowbough: {import_tree.summary(reports[0])}")
    if failures:
        return EXIT_FAILED
    return EXIT_COVERAGE if any(map(import_tree.is_incomplete, reports)) else EXIT_OK
