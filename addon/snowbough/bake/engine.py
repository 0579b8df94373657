# SPDX-License-Identifier: GPL-3.0-or-later
"""The hidden render engine that runs a bake.

Only a render evaluates a scene as the render sees it (render subdivision, render visibility), in a thread of its own,
with a progress bar and Esc, in the window and in the background. So a bake is a render with an engine that draws
nothing: its ``render()`` goes through the frames with ``self.frame_set`` and passes what it reads to a BakeJob, which
holds plain data only.

Settings that the render needs are changed before and restored after: engine, size, a temporary camera if there is none,
the view layers, and Snowbough's own displacement, or a second bake would snow on the snow of the first. A bake renders
one view layer with all that the rendered layers show, whichever is active: the only one, or a temporary one. The
settings are stored by name, since an undo would make references invalid. The engine's class is registered only during a
bake, so it appears in no menu.
"""

import math
import os
import sys
import time

import bpy

from ..base import session
from ..result.displacement import Muted
from ..scene import visibility
from ..scene.reader import SceneReader
from .request import BakeCancelled

ENGINE = "SNOWBOUGH_BAKE"
CAMERA = "Snowbough Bake Camera"
LAYER = "Snowbough Bake"

POLL_SECONDS = 0.1

WINDOW_NICENESS = 10

# Blender has one flag for all threads that says whether Python may write to its data. Each draw() of a panel and our
# render() set it and restore the former value at their end. If Python switched threads in the middle of a draw() while
# render() begins or ends, nothing could be written any more. With such a long interval, it switches only where a thread
# waits or leaves Python.
SWITCH_SECONDS = 5.0

# Seconds between redraws of the progress, which take time from the bake.
REDRAW_SECONDS = 0.5

# While surfaces take longer than expected, the rest is at least this share of the time that they have taken.
OVERDUE = 0.25
# Expected seconds of surfaces from which on their real time tells how fast the machine is.
MEASURABLE = 1.0

# Loading a file waits at most this long for the last frame of a bake; even with huge maps a frame takes less.
STOPPING_SECONDS = 120.0

# Render settings of a bake: attribute of scene.render -> value.
RENDER_SETTINGS = {
    "engine": ENGINE,
    "resolution_x": 16,
    "resolution_y": 16,
    "resolution_percentage": 100,
    "use_border": False,
    "use_compositing": False,
    "use_sequencer": False,
    "use_multiview": False,
    "use_freestyle": False,
    # Blender's own lock stops redrawing the 3D view and disables the Stop button; ui.editing_lock blocks edits instead.
    "use_lock_interface": False,
}


class RunningBake:
    """A bake while it runs, and its outcome. Contains only texts and numbers, besides the job."""

    def __init__(self, job, specs, scale_length, on_frame=None, begun=None):
        self.job = job
        self.specs = specs
        self.scale_length = scale_length
        self.on_frame = on_frame
        self.on_surfaces = None
        """Called without arguments, often, while surfaces are made."""
        self.error = None
        self.cancelled = False
        self.stop_requested = False
        self.blocks = False
        """Whether a call of run() waits for the bake."""
        self.begun = time.monotonic() if begun is None else begun
        self.shown = 0.0
        self.in_render = False
        self.done = False
        self.last_result = None
        self.shaping = None
        """Progress of the surfaces, 0 to 1, while they are made."""
        self._shaping_begun = 0.0
        self._fraction = 0.0

    def shape(self, share):
        """Notes the progress of the surfaces, 0 to 1."""
        if self.shaping is None:
            self._shaping_begun = time.monotonic()
        self.shaping = share
        if share >= 1.0 and self.job.surface_seconds > MEASURABLE:
            session.surface_pace = (time.monotonic() - self._shaping_begun) / self.job.surface_seconds

    def _seconds(self):
        """Estimates (of a frame's maps, of all surfaces)."""
        results = self.job.results
        pace = sum(result.seconds["total"] for result in results) / max(len(results), 1)
        return pace, self.job.surface_seconds * session.surface_pace

    @property
    def fraction(self):
        """Progress of maps and surfaces together by the time that they take, 0 to 1. It never falls."""
        result, done, work = self.last_result, 0.0, 0.0
        pace, surfaces = self._seconds()
        if result is not None:
            frames = result.last - result.first + 1
            done = pace * (frames if self.shaping is not None else result.frame - result.first + 1)
            work = pace * frames
        done, work = done + surfaces * (self.shaping or 0.0), work + surfaces
        self._fraction = max(self._fraction, done / work if work > 0.0 else 0.0)
        return self._fraction

    def seconds_left(self):
        """An estimate for maps and surfaces; None before the first frame."""
        pace, surfaces = self._seconds()
        if self.shaping is None:
            last = self.last_result
            return None if last is None else pace * (last.last - last.frame) + surfaces
        spent = time.monotonic() - self._shaping_begun
        expected = max(surfaces, (1.0 + OVERDUE) * spent) - spent
        # While the first receivers are planned, the share stands still and says too little.
        return min(expected, spent * (1.0 / self.shaping - 1.0)) if self.shaping > 0.0 else expected

    def status(self):
        """One line for the user: ``frame 12 of 1-48, 0:34 left``. The time is at least a second until all is done."""
        result = self.last_result
        if self.shaping is not None:
            text = "making snow surfaces"
        elif self.stop_requested:
            return "stopping after this frame"
        elif result is None:
            return "preparing the bake"
        else:
            text = f"frame {result.frame} of {result.first}-{result.last}"
        seconds = max(1, math.ceil(self.seconds_left()))
        return f"{text}, {seconds // 60}:{seconds % 60:02d} left"


def seldom(action, seconds=5.0):
    """A function that calls action() at its first call, and then at most once in this time."""
    last = -math.inf

    def call():
        nonlocal last
        if time.monotonic() - last >= seconds:
            last = time.monotonic()
            action()

    return call


_prepared = None
_finished = None
# Whether this module's handlers belong to the enabled add-on. A bake that ends after the add-on was disabled, and
# perhaps enabled again, ends in the module that started it.
_registered = False
_switch_interval = None


def _lower_priority():
    """Lets the window's thread go first if there are few cores: lowers the priority of this thread and of the threads
    that it starts. Only on Linux; elsewhere it would affect the whole process."""
    if sys.platform == "linux":
        os.nice(WINDOW_NICENESS)


class SNOWBOUGH_BAKE(bpy.types.RenderEngine):
    bl_idname = ENGINE
    bl_label = "Snowbough Bake"

    def render(self, depsgraph):
        running = session.bake
        if running is None or running.in_render:
            return
        running.in_render = True
        reader = SceneReader(running.specs, running.scale_length)
        in_window = not bpy.app.background
        if in_window:
            _lower_priority()

        def evaluate(frame, subframe):
            self.frame_set(frame, subframe)
            return reader.read(depsgraph, frame)

        shown = 0.0

        def show_progress(fraction):
            """Shows the progress, in the window at most every REDRAW_SECONDS: Blender then redraws the window, which
            takes time from the bake."""
            nonlocal shown
            now = time.monotonic()
            if in_window and now - shown < REDRAW_SECONDS:
                return
            shown = now
            self.update_progress(fraction)
            if in_window:
                self.update_stats("Snowbough", running.status())

        def report(result):
            running.last_result = result
            show_progress(running.fraction)
            if running.on_frame is not None:
                running.on_frame(result)

        def shaping(share):
            running.shape(share)
            show_progress(running.fraction)
            if running.on_surfaces is not None:
                running.on_surfaces()

        def cancelled():
            return running.stop_requested or self.test_break()

        try:
            running.job.run(evaluate, report, cancelled, shaping)
        except BakeCancelled:
            running.cancelled = True
        except Exception as error:  # Blender only prints an exception that leaves render()
            running.error = error
        finally:
            running.done = True


def _class_is_registered():
    return "bl_rna" in SNOWBOUGH_BAKE.__dict__


def _common_layer(scene):
    """A view layer with the collections of all rendered ones: the only one, or a new one."""
    layers = visibility.rendered_layers(scene)
    if len(layers) == 1:
        return layers[0]
    made = scene.view_layers.new(LAYER)
    _join_layers(layers, made)
    return made


def _join_layers(layers, joined):
    """Excludes from a view layer the collections that all others exclude."""
    nowhere = set.intersection(*map(visibility.excluded, layers))
    # Parents first: they change their children.
    for path, collection in visibility.layer_collections(joined).items():
        if collection.exclude != (path in nowhere):
            collection.exclude = path in nowhere


def _follow_layers(scene, *_):
    """Frame handlers, which run before this one, may exclude collections."""
    joined = scene.view_layers.get(_prepared.layer) if _prepared is not None else None
    if joined is not None and joined.name not in _prepared.rendered:
        _join_layers([layer for layer in scene.view_layers if layer.name in _prepared.rendered], joined)


class _PreparedScene:
    """The settings that were changed for the bake, by name. restore() reverts them."""

    def __init__(self, scene):
        self._scene_name = scene.name
        render = scene.render
        self._settings = {name: getattr(render, name) for name in RENDER_SETTINGS if hasattr(render, name)}
        self._frame = (scene.frame_current, scene.frame_subframe)
        self._layers = {layer.name: layer.use for layer in scene.view_layers}
        self._muted = Muted(scene)
        preferences = bpy.context.preferences.view
        self._display = preferences.render_display_type
        self._temporary_camera = scene.camera is None

        if not _class_is_registered():
            bpy.utils.register_class(SNOWBOUGH_BAKE)
        self._muted.__enter__()
        for name in self._settings:
            setattr(render, name, RENDER_SETTINGS[name])
        self.rendered = {layer.name for layer in visibility.rendered_layers(scene)}
        self.layer = _common_layer(scene).name
        for layer in scene.view_layers:
            layer.use = layer.name == self.layer
        bpy.app.handlers.frame_change_pre.append(_follow_layers)
        if self._temporary_camera:
            scene.camera = bpy.data.objects.new(CAMERA, bpy.data.cameras.new(CAMERA))
        preferences.render_display_type = "NONE"

    def restore(self, keep_engine=False):
        if _follow_layers in bpy.app.handlers.frame_change_pre:
            bpy.app.handlers.frame_change_pre.remove(_follow_layers)
        bpy.context.preferences.view.render_display_type = self._display
        scene = bpy.data.scenes.get(self._scene_name)
        if scene is not None:
            for name, value in self._settings.items():
                setattr(scene.render, name, value)
            for layer in list(scene.view_layers):
                if layer.name in self._layers:
                    layer.use = self._layers[layer.name]
                elif layer.name.startswith(LAYER):
                    scene.view_layers.remove(layer)
            self._muted.__exit__()
            if self._temporary_camera:
                self._remove_camera(scene)
            scene.frame_set(self._frame[0], subframe=self._frame[1])
        if not keep_engine:
            bpy.utils.unregister_class(SNOWBOUGH_BAKE)

    @staticmethod
    def _remove_camera(scene):
        camera = scene.camera
        if camera is not None and camera.name.startswith(CAMERA):
            data = camera.data
            scene.camera = None
            bpy.data.objects.remove(camera)
            bpy.data.cameras.remove(data)


def _begin(context, running):
    global _prepared
    if session.bake is not None:
        raise RuntimeError("A bake is already running")
    _prepared = _PreparedScene(context.scene)
    session.bake = running


def _end():
    global _prepared
    running, session.bake = session.bake, None
    prepared, _prepared = _prepared, None
    _restore_switching()
    prepared.restore()
    if not running.in_render and running.error is None:
        running.error = RuntimeError("Blender did not start the render that runs the bake")
    return running


def _restore_switching():
    global _switch_interval
    if _switch_interval is not None:
        sys.setswitchinterval(_switch_interval)
        _switch_interval = None


def run(context, running):
    """Bakes and returns when the bake has ended, in the background or in a script. `running` holds the outcome."""
    _begin(context, running)
    running.blocks = True
    try:
        bpy.ops.render.render(scene=context.scene.name)
    finally:
        _end()


def start(context, running, finished):
    """Starts the bake as a Blender job and returns at once. finished(running) is called in the main thread after
    everything is restored, but not if another file is loaded meanwhile."""
    global _finished, _switch_interval
    _begin(context, running)
    _finished = finished
    _switch_interval = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_SECONDS)
    try:
        outcome = bpy.ops.render.render("INVOKE_DEFAULT", scene=context.scene.name)
    except RuntimeError:
        _end()
        raise
    if "CANCELLED" in outcome:
        running.error = RuntimeError("Blender is rendering: wait until it has finished, then bake")
        _end()
        raise running.error
    bpy.app.timers.register(_poll, first_interval=POLL_SECONDS)


def stop():
    """Asks the running bake to stop after the current frame."""
    if session.bake is not None:
        session.bake.stop_requested = True


def stop_and_call(action):
    """Asks the running bake to stop, and registers action() as a timer."""
    stop()
    bpy.app.timers.register(action, first_interval=POLL_SECONDS)


def _poll():
    """Waits in the main thread for the end of the job."""
    global _finished
    if session.bake is None:
        return None
    if time.monotonic() - session.bake.shown > REDRAW_SECONDS:
        session.bake.shown = time.monotonic()
        _redraw_panels()
        _show_status(f"Baking snow: {session.bake.status()}    Esc: stop and keep the finished frames")
    if bpy.app.is_job_running("RENDER") or not (
        session.bake.done or time.monotonic() - session.bake.begun > 5.0
    ):
        return POLL_SECONDS
    running = _end()
    finished, _finished = _finished, None
    _show_status(None)
    if session.enabled:
        finished(running)
    if not _registered:  # the add-on was disabled meanwhile
        _remove_handlers()
    return None


def _redraw_panels():
    """Redraws only the areas that show the progress: drawing the scene would take time from the bake."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
            elif area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


def _show_status(text):
    """Shows a text in the status bar of all windows; None restores Blender's own."""
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(text)


@bpy.app.handlers.persistent
def _before_load(*_):
    """Before another file is loaded: waits until the render thread has left the scene and restores the settings, in
    case loading fails. Blender's own job ends in the middle of loading."""
    global _prepared, _finished
    if _prepared is None:
        return
    running, session.bake = session.bake, None
    running.stop_requested = True
    begun = time.monotonic()
    while running.in_render and not running.done and time.monotonic() - begun < STOPPING_SECONDS:
        time.sleep(0.01)
    _restore_switching()
    _prepared.restore(keep_engine=True)
    _show_status(None)
    _prepared = _finished = None


@bpy.app.handlers.persistent
def _after_load(*_):
    """Unregisters the engine's class, which outlives the job that Blender ended while loading."""
    if session.bake is None and _class_is_registered():
        bpy.utils.unregister_class(SNOWBOUGH_BAKE)


def register():
    global _registered
    _registered = session.enabled = True
    bpy.app.handlers.load_pre.append(_before_load)
    bpy.app.handlers.load_post.append(_after_load)


def _remove_handlers():
    bpy.app.handlers.load_pre.remove(_before_load)
    bpy.app.handlers.load_post.remove(_after_load)


def unregister():
    """While a bake runs, the rest of the add-on is unregistered and the bake is asked to stop. The render thread uses
    the engine until Blender's job ends, so _poll stays until then and restores everything."""
    global _registered
    _registered = session.enabled = False
    stop()
    if _prepared is None:
        _remove_handlers()
