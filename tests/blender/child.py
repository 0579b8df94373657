# SPDX-License-Identifier: GPL-3.0-or-later
"""Blenders that tests start."""

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
    """The command that runs a Python program in a Blender of its own, or in one as a module if this is one."""
    if bpy.app.binary_path:
        options = ["-b", "--factory-startup", "--python-exit-code", "1"]
        return [bpy.app.binary_path, *options, "--python-expr", program]
    return [sys.executable, "-c", f"{END_AT_ONCE}\n{program}\nend()"]
