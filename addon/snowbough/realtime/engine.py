# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine ``SNOWBOUGH_REALTIME``, which Blender calls for 3D views and for F12.

This module makes no OpenGL calls: frames come from the native renderer's own thread, see viewport.
"""

import weakref

import bpy

from ..base import compat, native, session
from ..base.names import FARTHEST
from ..base.names import REALTIME_ENGINE as ENGINE
from ..result import surface_files
from . import lights, viewport
from .final import FinalRenderer
from .flakes import flakes_of
from .reader import Reader

# Seconds between checks for the end of a render job.
POLL_SECONDS = 0.2

_final = None


def _final_renderer():
    """The FinalRenderer of this session, shared by all frames."""
    global _final
    if _final is None:
        _final = FinalRenderer(native.load())
    return _final


class SNOWBOUGH_REALTIME(bpy.types.RenderEngine):
    bl_idname = ENGINE
    bl_label = "Snowbough Realtime"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    _view = None
    _reader = None

    # -- F12 --------------------------------------------------------------------------------------------

    def render(self, depsgraph):
        scene = depsgraph.scene_eval
        camera = self.camera_override or scene.camera
        if camera is None:
            self._fail("The scene has no camera: add one to render")
            return
        try:
            self.update_stats("Snowbough", "Drawing")
            surface_files.require_files(depsgraph.scene)
            renderer = _final_renderer()
            picture = renderer.render(depsgraph, camera.evaluated_get(depsgraph))
        except Exception as error:  # Blender only prints an exception that leaves render()
            self._fail(native.error_text(error))
            return
        if renderer.left_out:
            names = ", ".join(sorted(renderer.left_out))
            self.report(
                {"WARNING"},
                f"Objects or faces farther than {FARTHEST:g} units from the origin are not rendered: {names}",
            )
        height, width = picture.shape[:2]
        result = self.begin_result(0, 0, width, height, layer=depsgraph.view_layer_eval.name)
        compat.set_pass_pixels(result.layers[0].passes["Combined"], picture)
        self.end_result(result)

    def _fail(self, text):
        """Ends the render without a file. The report makes it fail in scripts and on the command line."""
        self.error_set(f"Snowbough Realtime: {text}")
        self.report({"ERROR"}, f"Snowbough Realtime: {text}")

    # -- 3D view ----------------------------------------------------------------------------------------

    def view_update(self, context, depsgraph):
        if self._view is None:
            try:
                module = native.load()
                self._view = viewport.Viewport(module, self.tag_redraw)
            except RuntimeError as error:
                self.report({"ERROR"}, f"Snowbough Realtime: {error}")
                return
            self._reader = Reader(module, shows_live=True)
            # When the engine is freed, its attributes can no longer be read.
            weakref.finalize(self, self._view.close)
        self._reader.forget(depsgraph)
        self._read(context, depsgraph)

    def _read(self, context, depsgraph):
        space = context.space_data
        try:
            self._view.update(self._reader.read(depsgraph, lambda obj: obj.visible_in_viewport_get(space)))
        except Exception as error:  # the view keeps its image and shows the reason
            self.update_stats("Snowbough", native.error_text(error))

    def view_draw(self, context, depsgraph):
        if self._view is None:
            return
        if self._reader.is_outdated(depsgraph):
            self._read(context, depsgraph)
        options = depsgraph.scene_eval.snowbough_realtime.as_render_settings()
        shading = context.space_data.shading
        light = lights.shown(
            self._view.light, shading.use_scene_lights_render, shading.use_scene_world_render
        )
        view = viewport.view_of(context.region, context.region_data)
        self._view.draw(view, light, options, flakes_of(depsgraph.scene_eval))
        if self._view.error is not None:
            self.update_stats("Snowbough", self._view.error)


def _when_no_job_renders(action):
    """Calls action() at once, or after the running render job. Registering or unregistering an engine class frees data
    of all engines, which crashes Blender while an engine renders. A bake is a render job."""
    if not bpy.app.is_job_running("RENDER"):
        action()
        return

    def poll():
        if bpy.app.is_job_running("RENDER"):
            return POLL_SECONDS
        action()
        return None

    bpy.app.timers.register(poll, first_interval=POLL_SECONDS)


def _add_class():
    if session.enabled and not SNOWBOUGH_REALTIME.is_registered:
        bpy.utils.register_class(SNOWBOUGH_REALTIME)


def _remove_class():
    if SNOWBOUGH_REALTIME.is_registered:
        bpy.utils.unregister_class(SNOWBOUGH_REALTIME)


def register():
    _when_no_job_renders(_add_class)


def unregister():
    global _final
    viewport.close_all()
    if _final is not None:
        _final.close()
        _final = None
    _when_no_job_renders(_remove_class)
