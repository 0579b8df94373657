# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that are forked, and processes that end while the module computes."""

import os
from pathlib import Path

import pytest
from child import in_child

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")

START = """
import os, sys, threading, time
import numpy as np
import snowbough_native as native
from snow_meshes import grid
positions, triangles, uv = grid(cells=4)

def simulation(engine):
    made = native.SnowSimulation(pixel_size=0.01, engine=engine)
    made.add_object("ground", triangles, uv, resolution=64)
    made.step({"ground": positions}, 0.01)
    return made

def in_fork(work):
    child = os.fork()
    if child == 0:
        work()
        sys.stdout.flush()
        sys.exit(0)
    assert os.waitpid(child, 0)[1] == 0
"""


def run(program):
    return in_child(START + program).split("\n")[:-1]


@needs_fork
def test_a_forked_process_refuses_opengl_and_ends():
    printed = run(
        "live = simulation('GL')\n"
        "renderer = native.Renderer()\n"
        "def work():\n"
        "    for call in (lambda: live.step({}, 0.01), lambda: renderer.render(native.Camera()),\n"
        "                 lambda: simulation('GL'), lambda: native.Engine('GL').info):\n"
        "        try:\n"
        "            call()\n"
        "        except RuntimeError as error:\n"
        "            print('forked' in str(error))\n"
        "    live.close()\n"
        "    renderer.close()\n"
        "in_fork(work)\n"
        "live.step({}, 0.01)\n"
        "print('the parent goes on')\n"
    )
    assert printed == ["True"] * 4 + ["the parent goes on"]


@needs_fork
def test_a_forked_process_may_drop_what_it_was_handed():
    assert run(
        "live = [simulation('GL'), simulation('CPU'), native.Renderer(), native.Engine('GL')]\n"
        "live[1].prepare_output('ground')\n"
        "in_fork(lambda: live.clear())\n"
        "print(live[0].height('ground').max() > 0)\n"
    ) == ["True"]


@needs_fork
def test_a_forked_process_computes_on_the_processor():
    assert run(
        "live = simulation('CPU')\n"
        "other = simulation('GL')\n"
        "def work():\n"
        "    live.step({}, 0.01)\n"
        "    print(abs(live.height('ground').max() - 0.02) < 1e-6)\n"
        "    print(abs(simulation('CPU').height('ground').max() - 0.01) < 1e-6)\n"
        "in_fork(work)\n"
    ) == ["True", "True"]


@pytest.mark.parametrize("engine", ["CPU", "GL"])
def test_a_process_may_end_while_a_daemon_thread_computes(engine):
    assert run(
        f"live = simulation('{engine}')\n"
        "def work():\n"
        "    while True:\n"
        "        live.step({}, 0.001)\n"
        "for _ in range(3):\n"
        "    threading.Thread(target=work, daemon=True).start()\n"
        "time.sleep(0.2)\n"
        "print('ends')\n"
    ) == ["ends"]


def test_a_process_may_end_while_a_daemon_thread_builds_a_tree():
    maple = Path(__file__).resolve().parents[2] / "data" / "small_maple.obj"
    assert run(
        f"def work():\n"
        f"    while True:\n"
        f"        native.build_tree_mesh(native.read_tree({str(maple)!r}), detail='FILM', progress=lambda s: True)\n"
        "threading.Thread(target=work, daemon=True).start()\n"
        "time.sleep(0.2)\n"
        "print('ends')\n"
    ) == ["ends"]
