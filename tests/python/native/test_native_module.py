"""Importing the native module."""

import os
import subprocess
import sys

import snowbough_native as native


def test_threads_need_not_look_numpy_up_when_they_make_their_first_arrays():
    # Two threads that import it at once would deadlock.
    program = "import sys, snowbough_native; sys.exit('numpy' not in sys.modules)"
    environment = dict(os.environ, PYTHONPATH=os.path.dirname(native.__file__))
    assert subprocess.run([sys.executable, "-c", program], env=environment).returncode == 0
