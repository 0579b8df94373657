# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender processes that tests start."""

import subprocess
import sys

import bpy
import pytest
from conftest import ROOT

# Blender as a module may crash or wait for ever in its own handler at exit: 4.2.23 and 4.5.15 do.
END_AT_ONCE = """
import bpy, os, sys
def end(code=0):
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
sys.exit = end
"""


def command(program):
    """The command that runs a Python program in a new Blender process, or with the module bpy if this Python has it."""
    if bpy.app.binary_path:
        options = ["-b", "--factory-startup", "--python-exit-code", "1"]
        return [bpy.app.binary_path, *options, "--python-expr", program]
    return [sys.executable, "-c", f"{END_AT_ONCE}\n{program}\nend()"]


def bake(blend, *arguments):
    """A bake on the command line, by the checkout's script; the ended process. Skips if this Blender is a module."""
    return cli(blend, "bake", *arguments)


def cli(blend, *arguments):
    """The same with any subcommand."""
    if not bpy.app.binary_path:
        pytest.skip("this Blender is a Python module and has no command line")
    command = [bpy.app.binary_path, "-b", str(blend), "--factory-startup", "--python-exit-code", "1"]
    command += ["-P", str(ROOT / "addon" / "snowbough" / "cli.py"), "--", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)
