# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the renderer's frames in a 3D view.

Blender's main thread requests a frame, continues, and draws the newest finished frame. Only the renderer's own thread
uses our OpenGL context. A timer checks for new frames between redraws and then redraws the view.
"""

import time

import bpy
import gpu

from ..base import view_drawing
from ..base.names import is_software
from . import frame_code, sync
from .pacing import Pacing
from .records import Light, View

POLL_SECONDS = 0.01

_shader = None
_open = []


def texture_of(frame):
    """A GPUTexture with one 32-bit channel, from (H, W) float32."""
    height, width = frame.shape
    pixels = gpu.types.Buffer("FLOAT", height * width, frame.reshape(-1))
    return gpu.types.GPUTexture((width, height), format="R32F", data=pixels)


def draw_frame(texture):
    """Fills the region with a packed frame. The shader is compiled on first use."""
    global _shader
    if _shader is None:
        _shader = view_drawing.make_shader(frame_code.VERTEX, frame_code.FRAGMENT, **frame_code.INPUTS)
    indices = view_drawing.index_buffer([(0, 1, 2)])
    batch = view_drawing.make_batch(frame_code.INPUTS["attributes"], [frame_code.CORNERS], indices)
    with view_drawing.state("NONE", False, "NONE"):
        _shader.bind()
        _shader.uniform_sampler("frame", texture)
        batch.draw(_shader)


class Viewport:
    """The renderer of one 3D view, and the frame that the view shows.

    redraw: called when there is a new frame to draw. Raises the errors of the native Renderer.
    """

    def __init__(self, native, redraw):
        self._native = native
        self._renderer = native.Renderer(waits=False)
        self._sync = sync.Sync(self._renderer)
        self._redraw = redraw
        self._pacing = Pacing()
        self.light = Light()
        self._key = None
        self._asked = {}
        self._arrived = None
        self._texture = None
        self._last_wish = None
        self._generation = 0
        self.error = None
        _open.append(self)

    def update(self, scene):
        """Passes a records.Scene to the renderer."""
        if self._sync.update(scene):
            self._generation += 1
        self.light = scene.light

    def draw(self, view, light, options, flakes=None):
        """Draws the newest frame and requests a frame of this records.View, records.Light and records.Flakes. options:
        additional fields of RenderSettings."""
        self._fetch_frame()
        key = (view, light, flakes, self._generation, tuple(sorted(options.items())))
        now = time.monotonic()
        if key != self._key:
            self._key = key
            self._last_wish = None
            self._pacing.changed(now)
        self._show_arrived()
        quality = self._pacing.wanted(now)
        if quality != self._last_wish and not self._pacing.is_done():
            self._ask(view, light, flakes, options, quality)
        if self._texture is not None:
            draw_frame(self._texture)
        if not self._is_settled():
            _start_timer()

    def _ask(self, view, light, flakes, options, quality):
        settings = sync.settings(
            self._native, light, flakes, antialias=quality.antialias, draft=quality.divisor > 1, **options
        )
        camera = sync.camera(self._native, view.divided(quality.divisor))
        ticket = self._renderer.request_frame(camera, settings)
        self._asked[ticket] = (self._key, quality)
        self._last_wish = quality

    def _fetch_frame(self):
        try:
            frame = self._renderer.take_frame()
        except (RuntimeError, ValueError) as error:
            self.error = str(error)
            return False
        if frame is None:
            return False
        self._arrived = frame
        return True

    def _show_arrived(self):
        if self._arrived is None:
            return
        ticket, frame = self._arrived
        self._arrived = None
        self._texture = texture_of(frame)
        if self._renderer.is_ready:
            self._pacing.software = is_software(self._renderer.driver)
        key, quality = self._asked.get(ticket, (None, None))
        self._asked = {later: what for later, what in self._asked.items() if later > ticket}
        if key == self._key:
            self._pacing.shown(quality)

    def _is_settled(self):
        return self._pacing.is_done() or self.error is not None

    def poll(self):
        """Checks for a new frame between redraws. Returns whether to check again."""
        if self._is_settled():
            return False
        if self._fetch_frame() or self.error is not None:
            self._redraw()
        elif not self._renderer.is_busy and self._pacing.wanted(time.monotonic()) != self._last_wish:
            self._redraw()
        return True

    @property
    def shown(self):
        """The Quality of the shown frame if it shows the current view and scene, otherwise None."""
        return self._pacing.last_shown

    def close(self):
        if self in _open:
            _open.remove(self)
        self._renderer.close()


def _start_timer():
    if not bpy.app.timers.is_registered(_poll):
        bpy.app.timers.register(_poll, first_interval=POLL_SECONDS)


def _poll():
    waiting = False
    for viewport in list(_open):
        try:
            waiting |= viewport.poll()
        except ReferenceError:  # Blender has freed the view
            viewport.close()
    return POLL_SECONDS if waiting else None


def view_of(region, region_data):
    """The records.View of a 3D view."""

    def rows(matrix):
        return tuple(tuple(row) for row in matrix)

    return View(rows(region_data.view_matrix), rows(region_data.window_matrix), region.width, region.height)


def close_all():
    global _shader
    for viewport in list(_open):
        viewport.close()
    _shader = None
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
