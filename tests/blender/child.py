# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender processes that tests start."""

import sys

import bpy

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
