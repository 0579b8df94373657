# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators ``snowbough.bake``, ``snowbough.stop_bake`` and ``snowbough.free_bake``.

make_request turns the scene's settings into plain data, in Blender's main thread, before anything starts.
"""

import math
from pathlib import Path

import bpy

from . import (
    bake_engine,
    bake_job,
    bake_lock,
    bake_request,
    cache,
    compat,
    displacement,
    native,
    scene_reader,
    simulations,
)

POPUP_LETTERS = 80

# How the last bake in this Blender went, for the panel: (severity, text).
last_outcome = ("INFO", "")


def cache_directory(scene):
    """Absolute folder of the scene's cache. Raises ValueError where the .blend was never saved."""
    path = scene.snowbough.cache_directory
    if not path.strip():
        raise ValueError("The cache folder is empty: choose one in the Snowbough panel")
    if path.startswith("//") and not bpy.data.filepath:
        raise ValueError(
            "Save the .blend first: its cache lies beside it. Or choose an absolute cache folder in the panel"
        )
    return str(Path(bpy.path.abspath(path)).resolve())


def existing_cache(scene):
    """The scene's folder in the cache that holds its bakes: the one the settings say, else, after Save As
    elsewhere, the one that the last bake wrote to. Returns a Path that need not exist."""
    try:
        root = cache.scene_folder(cache_directory(scene), scene.name)
    except ValueError:
        root = None
    if root is None or not cache.versions(root):
        used = scene.snowbough.cache_used
        if used and cache.versions(cache.scene_folder(used, scene.name)):
            return cache.scene_folder(used, scene.name)
    return root


def constant_rates(scene, frame_start, frame_end):
    """The rate of every frame as a tuple, or None where only evaluating the scene can tell (drivers, NLA)."""
    settings, animation = scene.snowbough, scene.animation_data
    frames = range(frame_start, frame_end + 1)
    if animation is not None:
        if any(driver.data_path == "snowbough.rate" for driver in animation.drivers):
            return None
        if animation.use_nla and len(animation.nla_tracks):
            return None
        for curve in compat.curves_of(scene):
            if curve.data_path == "snowbough.rate" and not curve.mute:
                return tuple(max(0.0, curve.evaluate(frame)) for frame in frames)
    return (settings.rate,) * len(frames)


def make_request(scene, resume=False, first=None, last=None, objects=(), directory=None,
                 allow_other_driver=False):  # fmt: skip
    """Everything a bake of the scene needs to know, without references into it. Raises ValueError."""
    if bpy.app.autoexec_fail:
        raise ValueError(
            f"Blender has disabled scripts in this file ({bpy.app.autoexec_fail_message or 'drivers'}), so it "
            "would not move as it should: start Blender with -y, or allow Auto Run Python Scripts and reload"
        )
    settings, render = scene.snowbough, scene.render
    frame_start, frame_end = settings.frame_start, settings.frame_end
    return bake_request.BakeRequest(
        scene_name=scene.name,
        cache=str(Path(directory).absolute()) if directory else cache_directory(scene),
        frame_start=frame_start,
        frame_end=frame_end,
        first=frame_start if first is None else first,
        last=frame_end if last is None else last,
        fps=render.fps / render.fps_base,
        start_depth=settings.start_depth,
        end_depth=settings.end_depth,
        rates=constant_rates(scene, frame_start, frame_end),
        flutter=math.degrees(settings.flutter),
        max_depth=settings.max_depth,
        slide_half_life=settings.slide_half_life,
        texel_size=settings.texel_size,
        pixel_size=settings.pixel_size,
        blur_radius=settings.blur_radius,
        substeps=settings.substeps,
        seed=settings.seed,
        checkpoint_interval=settings.checkpoint_interval,
        write_normals=settings.write_normals,
        noise_density=settings.noise_density,
        mapping=settings.mapping,
        receivers=tuple(scene_reader.receiver_specs(scene)),
        objects=tuple(objects),
        resume=resume,
        allow_other_driver=allow_other_driver,
    )


def make_session(scene, request, on_frame=None):
    """A Session for bake_engine.run or start. Raises what make_request and native.load raise, and
    ValueError for a simulation that is not baked and would not move."""
    simulations.require_cached(scene)
    job = bake_job.BakeJob(request, native.load())
    return bake_engine.Session(job, request.receivers, scene_reader.scale_length(scene), on_frame)


def outcome(running):
    """(severity, one clear line) on how a session ended."""
    if running.error is not None:
        return "ERROR", one_line(running.error)
    if running.cancelled:
        return "WARNING", "The bake was stopped. What was baked is kept: Resume goes on from there"
    results = running.job.results
    if not results:
        return "INFO", "Everything was baked already, from the scene as it is now"
    seconds = sum(result.seconds["total"] for result in results)
    return "INFO", f"Baked {len(results)} frames in {seconds:.1f} s"


def one_line(error):
    text = " ".join(str(error).split())
    return text or type(error).__name__


def shown_folder(folder):
    """A folder as Blender stores it: beside a saved .blend relative to it, so that both may move together."""
    if bpy.data.filepath:
        try:
            return bpy.path.relpath(str(folder))
        except ValueError:  # another drive on Windows
            pass
    return str(folder)


def after_bake(scene, running):
    """What the scene learns from a bake: where the files of each receiver lie. What shows older ones is
    wired to the new ones, and images are read again."""
    job = running.job
    scene.snowbough.cache_used = job.request.cache
    by_object = {}
    for receiver in job.baked:
        by_object.setdefault((receiver.spec.name, receiver.spec.library), receiver.folder)
    for entry in scene.snowbough.receivers:
        if entry.object is None:
            continue
        folder = by_object.get((entry.object.name, scene_reader.library_path(entry.object)))
        if folder is not None and cache.baked_frames(folder):
            entry.folder = shown_folder(folder)
            displacement.refresh(scene, entry)
    for image in bpy.data.images:
        if image.source == "SEQUENCE" and str(job.root) in bpy.path.abspath(image.filepath):
            image.reload()


@bpy.app.handlers.persistent
def _forget_outcome(*_):
    """How a bake of another file went is no news here."""
    global last_outcome
    last_outcome = ("INFO", "")


@bpy.app.handlers.persistent
def heal_folders(*_):
    """After Save As elsewhere the image paths are remapped by Blender, our folders beside the .blend are
    not: finds them again in the cache that the last bake wrote to."""
    for scene in bpy.data.scenes:
        used = scene.snowbough.cache_used
        for entry in scene.snowbough.receivers:
            if not entry.folder or not used or Path(bpy.path.abspath(entry.folder)).is_dir():
                continue
            # <cache>/<scene>/<version>/<receiver>
            candidate = Path(used).joinpath(*Path(entry.folder.lstrip("/").replace("\\", "/")).parts[-3:])
            if candidate.is_dir():
                entry.folder = shown_folder(candidate)


def _finished_in_window(running):
    global last_outcome
    last_outcome = outcome(running)
    scene = bpy.data.scenes.get(running.job.request.scene_name)
    if scene is not None:
        after_bake(scene, running)
        # A step of its own: else the next undo would take back what was done before the bake as well.
        bpy.ops.ed.undo_push(message=SNOWBOUGH_OT_bake.bl_label)
    severity, text = last_outcome
    if severity == "ERROR":

        def draw(self, _context):
            for part in wrapped(text, lambda line: len(line) <= POPUP_LETTERS):
                self.layout.label(text=part)

        bpy.context.window_manager.popup_menu(draw, title="Snowbough", icon="ERROR")


def wrapped(text, fits):
    """The lines of a text that panels and pop-ups show, which do not wrap by themselves.

    fits(line) says whether a line has room; a word that has none even by itself is broken, as paths have to be.
    """
    line = ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if line and not fits(longer):
            yield line
            longer = word
        while not fits(longer):
            length = next((length for length in range(len(longer) - 1, 1, -1) if fits(longer[:length])), 1)
            yield longer[:length]
            longer = longer[length:]
        line = longer
    yield line


class SNOWBOUGH_OT_bake(bake_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.bake"
    bl_label = "Bake Snow"
    bl_description = (
        "Let snow fall over the shot and write a height map per receiver and frame. "
        "Esc stops between frames and keeps what is done"
    )
    bl_options = {"REGISTER"}

    resume: bpy.props.BoolProperty(
        name="Resume",
        description="Go on from the last checkpoint of a bake that was stopped",
        default=False,
    )

    @classmethod
    def ready(cls, context):
        if not any(entry.object for entry in context.scene.snowbough.receivers):
            cls.poll_message_set("Add snow to objects first")
            return False
        return True

    def _session(self, context):
        return make_session(context.scene, make_request(context.scene, resume=self.resume))

    def invoke(self, context, _event):
        try:
            bake_engine.start(context, self._session(context), _finished_in_window)
            bake_lock.lock(context)
        except (ValueError, RuntimeError) as error:
            return self._refuse(error)
        return {"FINISHED"}

    def execute(self, context):
        global last_outcome
        try:
            running = self._session(context)
            if bpy.app.background:  # nobody sees a progress bar there: a line a frame
                running.on_frame = lambda _result: print(f"Snowbough: baked {running.status()}", flush=True)
            bake_engine.run(context, running)
        except (ValueError, RuntimeError) as error:
            return self._refuse(error)
        last_outcome = outcome(running)
        after_bake(context.scene, running)
        self.report({last_outcome[0]}, last_outcome[1])
        return {"CANCELLED"} if running.error or running.cancelled else {"FINISHED"}

    def _refuse(self, error):
        global last_outcome
        last_outcome = ("ERROR", one_line(error))
        self.report({"ERROR"}, last_outcome[1])
        return {"CANCELLED"}


class SNOWBOUGH_OT_stop_bake(bpy.types.Operator):
    bl_idname = "snowbough.stop_bake"
    bl_label = "Stop Baking"
    bl_description = "Stop after the frame that is being baked and keep what is done"

    @classmethod
    def poll(cls, _context):
        if bake_engine.session() is None:
            cls.poll_message_set("No bake is running")
            return False
        return True

    def execute(self, _context):
        bake_engine.stop()
        return {"FINISHED"}


class SNOWBOUGH_OT_free_bake(bake_lock.NotWhileBaking, bpy.types.Operator):
    bl_idname = "snowbough.free_bake"
    bl_label = "Free Bake"
    bl_description = (
        "Remove the files of all bakes of this scene from the cache, and nothing else. "
        "Files do not come back with undo"
    )
    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        root = existing_cache(context.scene)
        try:
            removed = cache.free(root) if root is not None else 0
        except cache.CacheError as error:
            self.report({"ERROR"}, one_line(error))
            return {"CANCELLED"}
        for entry in context.scene.snowbough.receivers:
            entry.folder = ""
            if entry.object is not None:
                displacement.refresh(context.scene, entry)
        self.report({"INFO"}, f"Removed {removed} files")
        return {"FINISHED"}


CLASSES = (SNOWBOUGH_OT_bake, SNOWBOUGH_OT_stop_bake, SNOWBOUGH_OT_free_bake)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        handlers.append(heal_folders)
    bpy.app.handlers.load_pre.append(_forget_outcome)


def unregister():
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.save_post):
        if heal_folders in handlers:
            handlers.remove(heal_folders)
    bpy.app.handlers.load_pre.remove(_forget_outcome)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
