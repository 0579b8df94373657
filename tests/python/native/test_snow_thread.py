# SPDX-License-Identifier: GPL-3.0-or-later
"""The GPU thread: a caller's own GL context stays unchanged, errors arrive, closed objects are released."""

import ctypes
import gc
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import snowbough_native as native
from snow_meshes import grid, sphere

EGL_NONE, EGL_OPENGL_API = 0x3038, 0x30A2
EGL_PLATFORM_SURFACELESS = 0x31DD
GL_VIEWPORT, GL_CURRENT_PROGRAM, GL_FRAMEBUFFER_BINDING = 0x0BA2, 0x8B8D, 0x8CA6


on_linux = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="looks into /proc, or names an EGL device"
)


@pytest.fixture
def own_context():
    """An EGL context of the test's own, current on this thread: (egl, gl, handle)."""
    if os.name == "nt":
        pytest.skip("Windows has no EGL")
    egl, gl = ctypes.CDLL("libEGL.so.1"), ctypes.CDLL("libGL.so.1")
    for name in ("eglGetPlatformDisplay", "eglCreateContext", "eglGetCurrentContext"):
        getattr(egl, name).restype = ctypes.c_void_p
    egl.eglGetPlatformDisplay.argtypes = [ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p]
    egl.eglInitialize.argtypes = [ctypes.c_void_p] * 3
    egl.eglChooseConfig.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_int,
        ctypes.c_void_p,
    ]
    egl.eglCreateContext.argtypes = [ctypes.c_void_p] * 4
    egl.eglMakeCurrent.argtypes = [ctypes.c_void_p] * 4
    egl.eglDestroyContext.argtypes = [ctypes.c_void_p] * 2
    display = egl.eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS, None, None)
    if not display or not egl.eglInitialize(display, None, None):
        pytest.skip("no surfaceless EGL display for a second context")
    egl.eglBindAPI(EGL_OPENGL_API)
    config, count = ctypes.c_void_p(), ctypes.c_int()
    attributes = (ctypes.c_int * 3)(0x3040, 0x0008, EGL_NONE)  # renderable: OpenGL
    egl.eglChooseConfig(display, attributes, ctypes.byref(config), 1, ctypes.byref(count))
    context = egl.eglCreateContext(display, config if count.value else None, None, None)
    if not context or not egl.eglMakeCurrent(display, None, None, context):
        pytest.skip("no second OpenGL context here")
    yield egl, gl, context
    egl.eglMakeCurrent(display, None, None, None)
    egl.eglDestroyContext(display, context)


def run_snow():
    positions, triangles, uv = grid()
    with native.SnowSimulation(pixel_size=0.05) as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        sim.step({"it": positions}, 0.1)
        sim.output("it")
        return sim.height("it")


def test_the_callers_context_is_never_touched(own_context):
    egl, gl, context = own_context
    gl.glViewport(1, 2, 3, 4)

    def state():
        view = (ctypes.c_int * 4)()
        gl.glGetIntegerv(GL_VIEWPORT, view)
        others = []
        for name in (GL_CURRENT_PROGRAM, GL_FRAMEBUFFER_BINDING):
            value = ctypes.c_int()
            gl.glGetIntegerv(name, ctypes.byref(value))
            others.append(value.value)
        return list(view), others, gl.glGetError(), egl.eglGetCurrentContext()

    assert state() == ([1, 2, 3, 4], [0, 0], 0, context)
    assert run_snow().max() > 0.0
    assert state() == ([1, 2, 3, 4], [0, 0], 0, context)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no EGL")
def test_a_thread_without_a_context_has_none_afterwards():
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetCurrentContext.restype = ctypes.c_void_p
    seen = []

    def work():
        run_snow()
        seen.append(egl.eglGetCurrentContext())

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [None]


def test_simulations_on_several_threads_give_the_same_bits():
    results = [None] * 4

    def work(index):
        positions, triangles, uv = sphere()
        with native.SnowSimulation(
            pixel_size=0.02, noise_density=0.5, flutter=np.radians(2.0), seed=index % 2
        ) as sim:
            sim.add_object("it", triangles, uv, resolution=64)
            for _ in range(4):
                sim.step({"it": positions}, 0.01)
            results[index] = sim.height("it")

    threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(results[0], results[2]) and np.array_equal(results[1], results[3])
    assert not np.array_equal(results[0], results[1])


@on_linux
def test_the_environment_chooses_the_device_and_an_unknown_one_is_an_error():
    module = Path(native.__file__).parent
    code = "import snowbough_native as n; n.Engine('GL').info"
    environment = {**os.environ, "PYTHONPATH": str(module), "SNOWBOUGH_EGL_DEVICE": "no such device"}
    failed = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert failed.returncode != 0 and "RuntimeError" in failed.stderr and "no such device" in failed.stderr
    chosen = {**environment, "SNOWBOUGH_EGL_DEVICE": "surfaceless"}
    again = subprocess.run([sys.executable, "-c", code], env=chosen, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr


@on_linux
def test_a_simulation_takes_over_the_context_of_an_engine_that_is_held():
    def tasks():
        return set(os.listdir("/proc/self/task"))

    positions, triangles, uv = grid()
    engine = native.Engine("GL")
    assert engine.info["driver"]  # waits until the context's own threads are there
    held = tasks()
    sim = native.SnowSimulation(pixel_size=0.05)
    assert tasks() == held
    engine.close()
    sim.add_object("it", triangles, uv, resolution=64)
    sim.step({"it": positions}, 0.1)
    assert sim.height("it").max() > 0.0
    sim.close()
    assert tasks() < held
    with pytest.raises(RuntimeError, match="closed"):
        _ = engine.info


def test_a_gpu_that_is_not_there_is_told_of_when_it_is_asked():
    with native.Engine("GL", device="no such device") as engine:
        with pytest.raises(RuntimeError, match="no such device"):
            _ = engine.info


def test_a_simulation_without_a_gpu_says_so_at_once_or_when_it_is_needed():
    positions, triangles, uv = grid()
    with pytest.raises(RuntimeError, match="no such device"):
        native.SnowSimulation(device="no such device")
    with native.SnowSimulation(device="no such device", wait_for_gpu=False) as sim:
        sim.add_object("it", triangles, uv, resolution=64)
        with pytest.raises(RuntimeError, match="no such device"):
            sim.step({"it": positions}, 0.1)


@on_linux
def test_a_gpu_that_nobody_holds_any_more_is_released():
    before = set(os.listdir("/proc/self/task"))
    for _ in range(3):
        with native.Engine("GL") as engine:
            assert engine.info == native.Engine("GL").info
        native.Engine("GL")
        gc.collect()
        assert set(os.listdir("/proc/self/task")) == before


@on_linux
def test_many_simulations_leave_no_memory_behind():
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    positions, triangles, uv = grid()

    def once():
        sim = native.SnowSimulation(pixel_size=0.02)
        sim.add_object("it", triangles, uv, resolution=256)
        sim.step({"it": positions}, 0.1)
        return sim.memory_estimate()["total"]

    for _ in range(3):
        each = once()
    before = resident()
    for _ in range(8):
        once()
    assert resident() - before < 4 * each
