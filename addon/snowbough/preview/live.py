# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: while it runs, the viewport shows the snow of the current frame and settings.

playback simulates what the viewport shows, and drawing draws the snow over it. The snow is no object, so it is not in
the outliner, in renders, in undo or in files. Baked snow is hidden meanwhile (hidden).
"""

import functools
import time

import bpy

from ..bake.choice import wanted_points
from ..base import native, session, view_drawing
from ..base.names import REALTIME_ENGINE
from ..scene.pose import metres_per_unit
from ..surface.compute import seed_of
from ..surface.style import SurfaceStyle
from . import drawing, hidden
from .playback import QUICK_STEPS, STEPS, Playback
from .receiver_surface import PLANNED_DEPTH, ReceiverSurface

# Seconds between checks of the settings: Blender sends no message when an add-on's setting changes.
INTERVAL = 0.08
ENDED = "The live preview has ended"
# Seconds after the last change of a setting before the snow is simulated in all steps.
PAUSE = 0.4


def make_surfaces(simulated, most_points, scale):
    """{key: ReceiverSurface} of a playback.Playback, without snow. most_points: maximum of all surfaces together;
    scale: factor on edge lengths."""
    objects = {key: simulated.pose.objects[key] for key in simulated.maps}
    snowfall = simulated.settings.snowfall
    wanted = wanted_points(native.load(), objects, snowfall.preroll, snowfall.totals[-1])
    return {
        key: ReceiverSurface(
            native.load(), own.topology, seed_of(own.label), wanted[key].most(scale, most_points), scale
        )
        for key, own in objects.items()
    }


class Preview:
    """A running preview. simulated: playback.Playback; drawn: drawing.Drawing, None without drawing."""

    def __init__(self, scene, depsgraph, draws=True):
        self.scene_name = scene.name
        self.simulated = None
        self.drawn = None
        self.was_undone = False
        """Whether an undo may have changed anything, the frame included; only undo handlers are called for it."""
        self.revision = 0
        """Number of changes of the snow and of its position."""
        self._heights = {}
        self._metres = metres_per_unit(scene)
        self._draws = draws
        self._surfaces = {}
        # The simulation for which the surfaces were made, and the keys of the surfaces whose points are current.
        self._shown = None
        self._computed = set()
        self._handle = None
        # time.monotonic() at which to simulate in all steps, or None.
        self._refine_at = None
        try:
            self._begin(scene, depsgraph)
        except BaseException:
            self.end()
            raise

    def _begin(self, scene, depsgraph):
        hidden.hide(scene)
        depsgraph.update()
        self.simulated = Playback(scene, depsgraph)
        self.show()
        if self._draws:
            self._handle = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_VIEW")

    @property
    def simulation(self):
        return self.simulated.simulation

    def heights(self, key):
        """(H, H) current height of the snow on a receiver in metres, row 0 = v 0, negative on the back."""
        if key not in self._heights:
            self._heights[key] = self.simulation.output(key, normal=False)["height"]
        return self._heights[key]

    @property
    def depths(self):
        """Snow depth in metres on open level ground, now and at the end of the shot."""
        settings = self.simulated.settings
        return settings.total(self.simulated.frame), max(settings.snowfall.totals[-1], PLANNED_DEPTH)

    def surface(self, key):
        """The current ReceiverSurface of a receiver, computed on demand; None if the receiver is not in the view."""
        pose = self.simulated.pose.objects.get(key)
        if pose is None:
            return None
        if key not in self._computed:
            surface = self._surfaces[key] = self._surfaces[key].on(pose.topology)
            surface.points(self.heights(key), self.depths[0], pose.positions, self.style(key))
            self._computed.add(key)
        return self._surfaces[key]

    def style(self, key):
        """The SurfaceStyle of a receiver in the view."""
        receiver = self.simulated.pose.objects[key].receiver
        named = (receiver.name, receiver.library)
        styles = {(spec.name, spec.library): spec.surface for spec in self.simulated.settings.styles}
        return styles.get(named) or SurfaceStyle()

    def show(self):
        """Passes the current snow to the drawing."""
        self.revision += 1
        self._heights = {}
        self._computed = set()
        if self._shown is not self.simulation:
            self._shown = self.simulation
            drawn_by_card = self._draws and not view_drawing.draws_in_software()
            budget = drawing.BUDGET if drawn_by_card else drawing.SOFTWARE_BUDGET
            self._surfaces = make_surfaces(self.simulated, *budget)
            self.drawn = drawing.Drawing(self._metres) if self._draws else None
        if self.drawn is not None:
            for key in self._surfaces:
                self.drawn.show(key, self.surface(key))
            _redraw()

    def _draw(self):
        context = bpy.context
        if self.drawn is None or context.scene is None or context.scene.name != self.scene_name:
            return
        shading = context.space_data.shading
        if shading.type == "RENDERED" and context.engine == REALTIME_ENGINE:
            return  # the engine shows this snow in its own picture
        try:
            self.drawn.draw(shading.type == "WIREFRAME" or (shading.type == "SOLID" and shading.show_xray))
        except Exception as error:
            # Report it once, not at every redraw; the handler cannot be removed while it runs.
            self.drawn = None
            bpy.app.timers.register(functools.partial(_end_with, error), first_interval=0.0)

    def watch(self, scene, depsgraph, now):
        """Follows changed settings and undo. now: time.monotonic()."""
        changed = self.simulated.apply_settings(scene, depsgraph)
        if self.was_undone:
            self.was_undone = False
            self.simulated.apply_scene(scene, depsgraph)
            self.simulated.go_to(scene, depsgraph)
            changed = True
        if self.simulated.stale:
            self.simulated.resimulate(QUICK_STEPS)
            self._refine_at = now + PAUSE
        elif self._refine_at is not None and now >= self._refine_at:
            self._refine_at = None
            self.simulated.resimulate(STEPS)
        elif not changed:
            return
        self.show()

    def end(self):
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None
        self.drawn = None
        if self.simulated is not None:
            self.simulated.close()
        hidden.show_again()
        _redraw()


def start(scene, depsgraph, draws=True):
    """Starts the preview at the current frame. draws: False to simulate only.

    Raises ValueError if drawing is impossible, and the errors of reading the scene and making the simulation.
    """
    stop()
    reason = view_drawing.unavailable_reason() if draws else ""
    if reason:
        raise ValueError(reason)
    session.preview = Preview(scene, depsgraph, draws)
    if session.last_outcome[1].startswith(ENDED):
        session.last_outcome = session.NO_OUTCOME
    bpy.app.handlers.frame_change_post.append(_on_frame)
    bpy.app.handlers.depsgraph_update_post.append(_on_update)
    bpy.app.timers.register(_watch, first_interval=INTERVAL)


def stop():
    """Ends the preview and restores the viewport."""
    for handlers, own in (
        (bpy.app.handlers.frame_change_post, _on_frame),
        (bpy.app.handlers.depsgraph_update_post, _on_update),
    ):
        if own in handlers:
            handlers.remove(own)
    if bpy.app.timers.is_registered(_watch):
        bpy.app.timers.unregister(_watch)
    preview, session.preview = session.preview, None
    if preview is not None:
        preview.end()


def _redraw():
    manager = bpy.context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


# -- handlers ------------------------------------------------------------------------------------------


def _running(scene):
    """The preview of that scene; None while a render runs."""
    preview = session.preview
    if (
        preview is None
        or scene is None
        or scene.name != preview.scene_name
        or bpy.app.is_job_running("RENDER")
    ):
        return None
    return preview


def _end_with(error):
    """Ends the preview and shows the reason in the panel."""
    text = f"{ENDED}: {native.error_text(error)}"
    print(f"Snowbough: {text}")
    session.last_outcome = ("ERROR", text)
    stop()


def _end_without_scene():
    """Ends the preview if its scene was removed or renamed. Returns whether it did."""
    name = session.preview.scene_name
    is_gone = name not in bpy.data.scenes
    if is_gone:
        _end_with(ValueError(f"the scene '{name}' was removed or renamed: start the preview again"))
    return is_gone


@bpy.app.handlers.persistent
def _on_frame(scene, depsgraph=None):
    preview = _running(scene)
    if preview is None or depsgraph is None:
        return
    try:
        preview.simulated.go_to(scene, depsgraph)
        preview.show()
    except Exception as error:  # the next frame would raise it again
        _end_with(error)


@bpy.app.handlers.persistent
def _on_update(scene, depsgraph):
    """An object was changed, by the user or by undo."""
    preview = _running(scene)
    if preview is None or not any(
        update.is_updated_geometry or update.is_updated_transform or isinstance(update.id, bpy.types.Image)
        for update in depsgraph.updates
    ):
        return
    try:
        if preview.simulated.apply_scene(scene, depsgraph):
            preview.show()
    except Exception as error:  # the next update would raise it again
        _end_with(error)


def _watch():
    """Timer: follows the settings."""
    if session.preview is None or _end_without_scene():
        return None
    context = bpy.context
    preview = _running(context.scene)
    if preview is not None:
        try:
            preview.watch(context.scene, context.evaluated_depsgraph_get(), time.monotonic())
        except Exception as error:
            _end_with(error)
    return None if session.preview is None else INTERVAL


@bpy.app.handlers.persistent
def _before_load(*_):
    stop()


@bpy.app.handlers.persistent
def _before_save(*_):
    """Saves the file as if no preview ran."""
    hidden.show_again()


@bpy.app.handlers.persistent
def _update_hidden(*_):
    """After saving, undo and loading: hides baked snow if a preview runs, else shows it; the preview reads the scene
    again."""
    preview = session.preview
    if preview is None or _end_without_scene():
        hidden.show_again()
    else:
        hidden.hide(bpy.data.scenes[preview.scene_name])
        preview.was_undone = True


HANDLERS = (
    ("load_pre", _before_load),
    ("save_pre", _before_save),
    ("save_post", _update_hidden),
    ("undo_post", _update_hidden),
    ("redo_post", _update_hidden),
    ("load_post", _update_hidden),
)


def register():
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    stop()
    for name, handler in reversed(HANDLERS):
        getattr(bpy.app.handlers, name).remove(handler)
