# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: installs the add-on, then carries out what the tests send.

    blender --factory-startup -P tests/ui/inside.py -- ZIP FOLDER

A test writes FOLDER/request.py; a timer in Blender's own event loop runs it and answers in
FOLDER/answer.json.
"""

import importlib.util
import json
import os
import sys
import traceback
from pathlib import Path

import bpy

ZIP, FOLDER = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :][:2])
INTERVAL = 0.01


def blender_tests():
    """tests/blender/run.py, which installs the zip as a user would."""
    path = Path(__file__).resolve().parent.parent / "blender" / "run.py"
    spec = importlib.util.spec_from_file_location("run_blender_tests", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


names = {"bpy": bpy}


def view3d():
    """The context of the 3D view's sidebar for operators that need one."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return window, area


names["view3d"] = view3d


def serve():
    request = FOLDER / "request.py"
    if request.exists():
        source = request.read_text()
        request.unlink()
        names.pop("result", None)
        try:
            exec(compile(source, "request.py", "exec"), names)
            answer = {"result": names.get("result")}
        except Exception:  # the test reports every exception
            answer = {"error": traceback.format_exc()}
        partial = FOLDER / "answer.part"
        partial.write_text(json.dumps(answer))
        os.replace(partial, FOLDER / "answer.json")
    return INTERVAL


# The splash screen would swallow the first click.
bpy.context.preferences.view.show_splash = False
# Smooth edges take eight drawings after every change of a view, and a third of each.
system = bpy.context.preferences.system
system.viewport_aa = "OFF"
system.use_overlay_smooth_wire = False
names["addon"] = blender_tests().install(ZIP)
bpy.app.timers.register(serve, persistent=True)
