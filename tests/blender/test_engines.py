# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines of the snow: the choice, the messages of a bake, and bakes without EGL or OpenGL."""

import json
import math
import os
import signal
import subprocess
import sys

import bpy
import child
import numpy as np
import pytest
import snow_scene as s
from test_resume import blender_command, run_blender

PACKAGE = os.environ["SNOWBOUGH_TEST_ADDON"]


@pytest.fixture
def engine():
    """Sets the add-on's preference: engine("GL"). Restores it afterwards."""
    preferences = bpy.context.preferences.addons[PACKAGE].preferences
    before = preferences.engine

    def choose(name):
        preferences.engine = name

    yield choose
    preferences.engine = before


@pytest.fixture
def needs_gl(native):
    """Skips if the engine GL is not available."""
    try:
        with native.Engine("GL") as held:
            return held.info
    except RuntimeError as error:
        pytest.skip(f"no OpenGL here: {error}")


@pytest.fixture
def without_egl(tmp_path):
    """An environment in which neither EGL nor OpenGL can be loaded."""
    if os.name == "nt":
        pytest.skip("Windows has no EGL")
    folder = tmp_path / "no_gl"
    folder.mkdir()
    for name in ("libEGL.so.1", "libOpenGL.so.0"):
        (folder / name).write_text("no library")
    path = os.pathsep.join(filter(None, (str(folder), os.environ.get("LD_LIBRARY_PATH"))))
    return {**os.environ, "LD_LIBRARY_PATH": path}


def logs(root):
    """The lines of each bake's log, without their times, the oldest first."""
    found = sorted(root.glob("Scene*/logs/*"), key=lambda path: path.stat().st_mtime_ns)
    return [[line.split(" ", 1)[1] for line in path.read_text().splitlines()] for path in found]


def checkpoint_drivers(root):
    """The engines that the checkpoints in a cache name."""
    return {json.loads(path.read_text())["driver"] for path in root.rglob("state_*.json")}


# -- the choice ---------------------------------------------------------------------------------------


def test_the_preference_decides_and_is_automatic_at_first(addon, engine):
    make_request = addon("bake.from_scene").make_request
    s.receive(s.square("Ground"))
    s.settings("/nowhere")
    assert make_request(bpy.context.scene).engine == "AUTO"
    for name in ("GL", "CPU"):
        engine(name)
        assert make_request(bpy.context.scene).engine == name
        assert make_request(bpy.context.scene, engine="AUTO").engine == "AUTO"


def test_the_preference_is_described_and_drawn(addon):
    preferences = addon("settings.preferences").SnowboughPreferences
    prop = preferences.bl_rna.properties["engine"]
    assert [item.identifier for item in prop.enum_items] == ["AUTO", "GL", "CPU"]
    assert prop.description and all(item.description for item in prop.enum_items)
    drawn = []

    class Layout:
        def prop(self, _owner, name):
            drawn.append(name)

    class Shown:
        layout = Layout()

    preferences.draw(Shown(), bpy.context)
    assert drawn == ["engine", "preview_resolution", "preview_memory"]


def test_without_preferences_it_is_automatic(addon):
    preferred_engine, enabled = addon("settings.preferences").preferred_engine, bpy.context.preferences.addons
    before = enabled[PACKAGE].preferences.engine
    enabled[PACKAGE].preferences.engine = "CPU"
    assert preferred_engine() == "CPU"
    enabled.remove(enabled[PACKAGE])
    try:
        assert preferred_engine() == "AUTO"
    finally:
        enabled.new().module = PACKAGE
        enabled[PACKAGE].preferences.engine = before


def start_preview(addon):
    """Without a picture, which needs a window."""
    addon("preview.live").start(bpy.context.scene, bpy.context.evaluated_depsgraph_get(), draws=False)


def test_the_preview_takes_the_engine_of_the_preference(addon, engine, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    engine("CPU")
    start_preview(addon)
    try:
        info = addon("base.session").preview.simulation.engine
        assert (info["name"], info["reason"]) == ("CPU", "requested")
    finally:
        addon("preview.live").stop()


def test_the_preview_takes_opengl_where_the_preference_says_so(addon, engine, needs_gl, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    engine("GL")
    start_preview(addon)
    try:
        assert addon("base.session").preview.simulation.engine == needs_gl
    finally:
        addon("preview.live").stop()


def test_the_check_says_what_computes_the_snow(addon, engine, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    engine("CPU")
    issues = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    (finding,) = [issue for issue in issues if "computed" in issue.text]
    assert finding.severity == "INFO"
    assert finding.text.startswith("Snow is computed by engine CPU, processor, ")


def test_the_processor_refuses_the_mapping_of_opengl_and_says_what_to_do(addon, engine, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache", mapping="GEOMETRY")
    engine("CPU")
    wanted = "mapping GEOMETRY needs OpenGL: use engine GL, or mapping COMPUTE"
    with pytest.raises(RuntimeError, match=wanted):
        s.bake()
    with pytest.raises(ValueError, match=wanted):
        start_preview(addon)
    issues = addon("bake.preflight").check(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    assert [issue.text for issue in issues if issue.severity == "ERROR"] == [wanted]
    assert not (tmp_path / "cache").exists()


# -- messages of a bake -------------------------------------------------------------------------------


def test_the_log_begins_with_engine_driver_and_reason(native, engine, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    engine("CPU")
    s.bake()
    with native.Engine("CPU") as held:
        driver = held.info["driver"]
    ((cache, first, second, *_),) = logs(tmp_path)
    assert cache.startswith("cache ")
    assert first == f"engine CPU, {driver}: requested"
    assert second == "v001; Ground"


def test_a_checkpoint_carries_engine_and_driver(addon, native, engine, tmp_path):
    s.moving_scene(tmp_path)
    engine("CPU")
    assert s.bake_part(addon, 1, 6).error is None
    with native.Engine("CPU") as held:
        assert checkpoint_drivers(tmp_path) == {f"CPU, {held.info['driver']}"}


class CardThatFails:
    """An Engine that is gone when the simulation takes its first step."""

    def __init__(self, engine, mapping):
        self.info = {"name": "GL", "driver": "A Card, 4.6", "reason": "a graphics driver for A Card"}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


@pytest.fixture
def card_fails(native, stand_in):
    def simulation(engine, **settings):
        return native.SnowSimulation(engine="CPU", **settings)

    return lambda: stand_in(Engine=CardThatFails, SnowSimulation=simulation)


def test_after_a_fallback_log_and_checkpoint_name_what_really_ran(addon, native, card_fails, tmp_path):
    s.moving_scene(tmp_path)
    card_fails()
    assert s.bake_part(addon, 1, 6).error is None
    with native.Engine("CPU") as held:
        ran = f"CPU, {held.info['driver']}"
    assert checkpoint_drivers(tmp_path) == {ran}
    (lines,) = logs(tmp_path)
    assert [line for line in lines if line.startswith("engine ")] == [
        "engine GL, A Card, 4.6: a graphics driver for A Card",
        f"engine {ran}: requested",
    ]


def test_a_fallback_does_not_continue_what_opengl_began(addon, card_fails, tmp_path):
    s.moving_scene(tmp_path)
    assert s.bake_part(addon, 1, 4).error is None
    for path in tmp_path.rglob("state_*.json"):
        folder, frame = addon("cache.folder"), int(path.stem[-4:])
        sidecar = folder.read_sidecar(path.parent, frame)
        folder.write_sidecar(path.parent, frame, {**sidecar, "driver": "GL, A Card, 4.6"})
    card_fails()
    error = s.bake_part(addon, 5, 12).error
    assert isinstance(error, addon("cache.errors").InputsChanged)
    assert "GL, A Card, 4.6; this is CPU, processor" in str(error)
    assert not list(tmp_path.rglob("height_0005.exr"))
    assert s.bake_part(addon, 5, 12, allow_other_driver=True).error is None
    assert len(list(tmp_path.rglob("height_0012.exr"))) == 3


# -- both engines -------------------------------------------------------------------------------------


@pytest.mark.parametrize("flutter", [0.0, 0.05])
def test_the_engines_bake_the_same_snow(native, engine, needs_gl, tmp_path, flutter):
    s.moving_scene(tmp_path / "GL", flutter=flutter, repose=math.pi / 2)
    for name in ("GL", "CPU"):
        engine(name)
        bpy.context.scene.snowbough.cache_directory = str(tmp_path / name)
        s.bake()
        assert logs(tmp_path / name)[0][1].startswith(f"engine {name}, ")
    depth_of_a_step = 0.1 / 12
    for receiver in ("Ground", "Cart", "Flag"):
        for frame in (1, 2, 12):
            drawn, computed = (
                s.height(native, tmp_path / name, receiver, frame).astype(np.float64)
                for name in ("GL", "CPU")
            )
            away = ~near_an_edge(drawn) & ~near_an_edge(computed)
            assert np.abs(drawn - computed)[away].max(initial=0.0) <= 1e-4 * depth_of_a_step, (
                receiver,
                frame,
            )
            both, either = (drawn > 0) & (computed > 0), (drawn > 0) | (computed > 0)
            assert both.sum() >= 0.9999 * either.sum(), (receiver, frame)
            assert abs(drawn.sum() - computed.sum()) <= 1e-5 * abs(drawn.sum()), (receiver, frame)
            print(receiver, frame, f"{away.mean():.2f} of the map, {np.abs(drawn - computed).max():.2e} m")
        assert away.mean() > 0.3 and drawn.max() > 0.03, receiver


def near_an_edge(map_):
    """Texels within two of a jump in height: where a shadow's edge lies or passed."""
    jumps = np.zeros(map_.shape, bool)
    for axis in (0, 1):
        step = np.abs(np.diff(map_, axis=axis)) > 1e-3 * max(map_.max(), 1e-9)
        before = [(0, 0), (0, 0)]
        after = [(0, 0), (0, 0)]
        before[axis], after[axis] = (1, 0), (0, 1)
        jumps |= np.pad(step, before) | np.pad(step, after)
    wide = np.pad(jumps, 2)
    rows, columns = map_.shape
    return np.any([wide[i : i + rows, j : j + columns] for i in range(5) for j in range(5)], axis=0)


@pytest.mark.parametrize("begun, resumed", [("GL", "CPU"), ("CPU", "GL")])
def test_an_engine_continues_the_others_bake_only_when_allowed(
    addon, engine, needs_gl, tmp_path, begun, resumed
):
    s.moving_scene(tmp_path)
    engine(begun)
    assert s.bake_part(addon, 1, 6).error is None
    before = s.files_of(tmp_path)
    engine(resumed)
    error = s.bake_part(addon, 1, 12, resume=True).error
    assert isinstance(error, addon("cache.errors").InputsChanged)
    assert f"another engine or driver ({begun}, " in str(error) and f"this is {resumed}, " in str(error)
    assert s.files_of(tmp_path) == before
    assert s.bake_part(addon, 1, 12, resume=True, allow_other_driver=True).error is None
    assert len(list(tmp_path.rglob("height_0012.exr"))) == 3


# -- without EGL and OpenGL ---------------------------------------------------------------------------


@pytest.fixture
def shot(addon, engine, tmp_path):
    """The moving scene, saved as shot.blend with its cache in tmp/cache, and the bytes of its whole bake by the
    processor in this Blender."""
    s.moving_scene(tmp_path / "whole", noise_density=0.5, substeps=2, blur_radius=2.0)
    # Before the bake: a saved file gives its cache a name.
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    engine("CPU")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    s.bake()
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "cache")
    bpy.ops.wm.save_mainfile()
    return s.files_of(tmp_path / "whole")


def test_without_egl_a_bake_is_the_processors(addon, shot, without_egl, tmp_path):
    done = run_blender(addon, tmp_path / "shot.blend", "--engine", "AUTO", env=without_egl)
    assert done.returncode == 0, done.stderr
    ((_, first, *_),) = logs(tmp_path / "cache")
    assert first.startswith("engine CPU, processor, ") and "libEGL.so.1" in first
    assert s.files_of(tmp_path / "cache") == shot


def test_without_egl_opengl_is_refused_with_what_to_do(addon, shot, without_egl, tmp_path):
    done = run_blender(addon, tmp_path / "shot.blend", "--engine", "GL", env=without_egl)
    assert done.returncode == 6
    assert "OpenGL" in done.stderr and "libEGL.so.1" in done.stderr and "engine CPU" in done.stderr
    assert "Traceback" not in done.stderr and not (tmp_path / "cache").exists()


def test_without_egl_the_native_module_has_no_opengl(native, without_egl):
    """The environment of these tests has no OpenGL."""
    program = (
        "import importlib.util, sys\n"
        f"sys.path.insert(0, {os.path.dirname(native.__file__)!r})\n"
        f"spec = importlib.util.spec_from_file_location('snowbough_native', {native.__file__!r})\n"
        "module = importlib.util.module_from_spec(spec)\n"
        "spec.loader.exec_module(module)\n"
        "try:\n"
        "    module.Engine('GL').info\n"
        "except RuntimeError as error:\n"
        "    print('refused:', error, flush=True)\n"
    )
    command = [sys.executable, "-c", program]
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--python-expr", program]
    done = subprocess.run(command, env=without_egl, capture_output=True, text=True, timeout=120)
    assert "refused: OpenGL needs libEGL.so.1, which cannot be loaded" in done.stdout


# Ends the process, as kill -9 does, when a frame is reported and the ones after it are being baked and written;
# not before a first file is there, for which a busy machine may take longer than for the frames.
KILL = """
import os, signal, time
from pathlib import Path
frame_line = cli.frame_line
def line_or_end(result, left):
    if result.frame == {frame}:
        while not any(Path({cache!r}).rglob("height_0001.exr")):
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGKILL)
    return frame_line(result, left)
cli.frame_line = line_or_end
"""


@pytest.mark.parametrize("frame", [2, 6, 9])
def test_without_egl_a_killed_bake_resumes_to_the_same_bytes(addon, shot, without_egl, tmp_path, frame):
    *command, program = blender_command(addon, tmp_path / "shot.blend", "--engine", "AUTO")
    killed = program.replace(
        "sys.exit(", KILL.format(frame=frame, cache=str(tmp_path / "cache")) + "sys.exit("
    )
    done = subprocess.run([*command, killed], env=without_egl, capture_output=True, text=True, timeout=120)
    assert done.returncode == -signal.SIGKILL, done.stderr
    left = s.files_of(tmp_path / "cache")
    assert any(name.endswith("height_0001.exr") for name in left)
    assert not any(name.endswith("height_0012.exr") for name in left)
    done = run_blender(addon, tmp_path / "shot.blend", "--engine", "AUTO", "--resume", "yes", env=without_egl)
    assert done.returncode == 0, done.stderr
    assert s.files_of(tmp_path / "cache") == shot


def test_without_egl_receivers_in_two_runs_make_the_same_bytes(addon, shot, without_egl, tmp_path):
    for objects in ("Cart", "Ground,Flag"):
        done = run_blender(
            addon, tmp_path / "shot.blend", "--engine", "AUTO", "--objects", objects, env=without_egl
        )
        assert done.returncode == 0, done.stderr
    assert s.files_of(tmp_path / "cache") == shot


# -- the command line ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["AUTO", "GL", "CPU"])
def test_the_command_line_takes_an_engine(native, needs_gl, tmp_path, name):
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache", (1, 2))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    done = child.bake(tmp_path / "shot.blend", "--engine", name)
    assert done.returncode == 0, done.stderr
    with native.Engine(name) as held:
        info = held.info
    assert logs(tmp_path / "cache")[0][1] == f"engine {info['name']}, {info['driver']}: {info['reason']}"


def test_the_command_line_refuses_an_engine_that_is_none(tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path / "cache", (1, 2))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    done = child.bake(tmp_path / "shot.blend", "--engine", "VULKAN")
    # Some Pythons put choices in quotes, others do not.
    assert done.returncode == 2 and "AUTO, GL, CPU" in done.stderr.replace("'", "")
    assert not (tmp_path / "cache").exists()


# -- older bakes --------------------------------------------------------------------------------------


def test_a_bake_of_an_older_format_stays_and_baking_again_makes_a_new_version(addon, tmp_path):
    s.receive(s.square("Ground"))
    s.settings(tmp_path)
    s.bake()
    for path in tmp_path.rglob("object.json"):
        path.write_text(json.dumps({**json.loads(path.read_text("utf-8")), "format": 2}))
    before = s.files_of(tmp_path)
    with pytest.raises(addon("cache.errors").CacheError, match="written by another version .*format 2"):
        addon("cache.manifest").read_manifest(s.folder_of(tmp_path, "Ground"))
    addon("base.session").manifests.clear()
    s.bake()
    assert s.height(addon("base.native").load(), tmp_path, "Ground", 4, version=2).max() > 0.09
    assert before.items() <= s.files_of(tmp_path).items()
