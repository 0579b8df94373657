# SPDX-License-Identifier: GPL-3.0-or-later
"""Python processes that tests start."""

import os
import subprocess
import sys
from pathlib import Path

import snowbough_native as native


def in_child(program):
    """Runs a program with the module and the helpers of these tests; returns what it printed."""
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join([os.path.dirname(native.__file__), *sys.path]))
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment,
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
