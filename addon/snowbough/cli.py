# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line, from a checkout as well as from the installed add-on.

    blender -b [file.blend] --python-exit-code 1 -P addon/snowbough/cli.py -- import FILE.obj --out F.blend
    blender -b file.blend --python-exit-code 1 -P addon/snowbough/cli.py -- bake --frames 1-48 --cache DIR
    blender -b [file.blend] -c snowbough import ...        (Blender 4.2 on, add-on installed)

The exit code is 0 only on success. Without --python-exit-code 1 before -P, Blender itself ends with 0
even when this script could not start.
"""

import argparse
import signal
import sys

USAGE_ERROR = 2
STOPPED = 130


def parser():
    """The parser of both subcommands; `args.command` says which."""
    top = argparse.ArgumentParser(
        prog="snowbough", description="Imports trees and bakes snow without a window."
    )
    commands = top.add_subparsers(dest="command", required=True)

    tree = commands.add_parser("import", help="import an OBJ tree and save a .blend")
    tree.add_argument("file", metavar="FILE.obj")
    tree.add_argument(
        "--out", metavar="F.blend", help="where the scene is saved; without it nothing is saved"
    )
    tree.add_argument("--json", metavar="R.json", help="where the import report goes")
    tree.add_argument("--up-axis", choices=("AUTO", "Y", "Z"), default="AUTO")
    tree.add_argument("--levels", default="", help="names of groups from the trunk on, separated by commas")
    tree.add_argument("--simplify", choices=("NONE", "THESIS", "TOLERANCE"), default="TOLERANCE")
    tree.add_argument("--tolerance", type=float, default=0.5, help="radii a limb may stray by")
    tree.add_argument("--width", choices=("ORIGINAL", "INVERSE"), default="ORIGINAL")
    tree.add_argument("--species", choices=("BROADLEAF", "EVERGREEN"), default="BROADLEAF")
    tree.add_argument("--lod", type=int, choices=range(4), default=0)
    tree.add_argument("--lod-chain", action="store_true", help="all four levels of detail, _LOD0 the finest")
    tree.add_argument("--max-bones", type=int, default=1000, help="0 = all")
    tree.add_argument("--max-bone-level", type=int, default=-1, help="-1 = all")
    tree.add_argument("--no-foliage", dest="foliage", action="store_false", help="leave the leaves out")
    tree.add_argument(
        "--foliage",
        dest="foliage_names",
        metavar="NAMES",
        default="",
        help="starts of the names of groups, objects or materials that are foliage, separated by commas",
    )
    tree.add_argument(
        "--snow-resolution",
        type=int,
        default=1024,
        help="texels a side that the snow UV maps are laid out for",
    )

    bake = commands.add_parser("bake", help="bake the snow of the loaded file")
    bake.add_argument("--frames", metavar="A-B", help="default: the scene's settings")
    bake.add_argument("--cache", metavar="DIR")
    bake.add_argument("--json", metavar="R.json")
    bake.add_argument("--resume", action="store_true")
    bake.add_argument("--objects", metavar="A,B", help="only these receivers")
    bake.add_argument(
        "--allow-other-driver", action="store_true", help="resume although the GPU driver changed"
    )
    return top


def run(arguments):
    """Runs one command; returns the exit code."""
    try:
        args = parser().parse_args(arguments)
    except SystemExit as stop:  # argparse has said why; --help ends with 0
        return int(stop.code or 0)
    try:
        if args.command == "bake":
            from . import cli_bake

            return cli_bake.run(args)
        from . import cli_import

        # Blender takes Ctrl-C for itself; while Python computes, it must stop the work.
        previous = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            return cli_import.run(args)
        finally:
            # None: a handler that C code has set, which Python can't put back. SIG_DFL ends the process.
            signal.signal(signal.SIGINT, previous if previous is not None else signal.SIG_DFL)
    except KeyboardInterrupt:
        print("Snowbough: stopped", file=sys.stderr)
        return STOPPED


_handles = []


def register():
    from . import compat

    _handles.append(compat.register_command("snowbough", run))


def unregister():
    from . import compat

    compat.unregister_command(_handles.pop())


def _main():
    """As a script: the add-on of this checkout takes the place of one that is installed."""
    from pathlib import Path

    import addon_utils

    for name in list(sys.modules):
        if name == "snowbough" or (name.startswith("bl_ext.") and name.endswith(".snowbough")):
            addon_utils.disable(name, default_set=False)
    for name in [name for name in sys.modules if name == "snowbough" or name.startswith("snowbough.")]:
        del sys.modules[name]
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    import snowbough
    from snowbough import cli

    snowbough.register()
    code = cli.run(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    sys.stdout.flush()
    sys.stderr.flush()
    sys.exit(code)


if __name__ == "__main__":
    _main()
