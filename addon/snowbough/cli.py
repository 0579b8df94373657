# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line, from a checkout as well as from the installed add-on.

    blender -b [file.blend] --python-exit-code 1 -P addon/snowbough/cli.py -- import FILE.obj --out F.blend
    blender -b file.blend --python-exit-code 1 -P addon/snowbough/cli.py -- bake --frames 1-48 --cache DIR
    blender -b file.blend --python-exit-code 1 -P addon/snowbough/cli.py -- surface --detail FILM
    blender -b file.blend --python-exit-code 1 -P addon/snowbough/cli.py -- export TREE.glb --snow FRAME
    blender -b file.blend --python-exit-code 1 -P addon/snowbough/cli.py -- files
    blender -b [file.blend] -c snowbough import ...        (Blender 4.2 on, add-on installed)

The exit code is 0 only on success. Without --python-exit-code 1 before -P, Blender ends with 0 even if this script
could not start.

As a script, this file belongs to no package, so it imports modules of the add-on inside its functions.
"""

import argparse
import signal
import sys


def parser():
    """The parser of all subcommands; its result has the name `command` and the function `run` of the chosen one."""
    from .bake import cli as bake_cli
    from .tree import cli as tree_cli
    from .ui import export_cli, files_cli, surface_cli

    top = argparse.ArgumentParser(
        prog="snowbough",
        description="Imports trees, bakes snow and exports trees to game engines, without a window.",
    )
    commands = top.add_subparsers(dest="command", required=True)

    for name, module, text in (
        ("import", tree_cli, "import an OBJ tree and save a .blend"),
        ("bake", bake_cli, "bake the snow of the loaded file"),
        ("surface", surface_cli, "compute the snow surfaces of baked maps again"),
        ("export", export_cli, "write an imported tree for game engines and other programs"),
        ("files", files_cli, "print all files that rendering the loaded file needs"),
    ):
        command = commands.add_parser(name, help=text)
        module.add_arguments(command)
        command.set_defaults(run=module.run)
    return top


def run(arguments):
    """Runs one command; returns the exit code."""
    from .base.names import EXIT_STOPPED

    try:
        args = parser().parse_args(arguments)
    except SystemExit as stop:  # argparse has printed the reason; --help ends with 0
        return int(stop.code or 0)
    try:
        if args.command != "import":
            return args.run(args)
        # Blender handles Ctrl-C itself; while Python computes, Ctrl-C must stop the work.
        previous = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            return args.run(args)
        finally:
            # None: a handler of C code, which Python cannot restore. SIG_DFL ends the process.
            signal.signal(signal.SIGINT, previous if previous is not None else signal.SIG_DFL)
    except KeyboardInterrupt:
        print("Snowbough: stopped", file=sys.stderr)
        return EXIT_STOPPED


_handles = []


def register():
    from .base import compat

    _handles.append(compat.register_command("snowbough", run))


def unregister():
    from .base import compat

    compat.unregister_command(_handles.pop())


def _main():
    """Runs as a script. The add-on of this checkout replaces an installed one."""
    from pathlib import Path

    import addon_utils

    for name in list(sys.modules):
        if name == "snowbough" or (name.startswith("bl_ext.") and name.endswith(".snowbough")):
            addon_utils.disable(name, default_set=False)
    for name in [name for name in sys.modules if name == "snowbough" or name.startswith("snowbough.")]:
        del sys.modules[name]
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    import snowbough

    snowbough.register()
    from snowbough import cli

    code = cli.run(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    sys.stdout.flush()
    sys.stderr.flush()
    sys.exit(code)


if __name__ == "__main__":
    _main()
