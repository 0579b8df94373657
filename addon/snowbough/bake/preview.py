# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: while it is on, snow falls as the timeline plays forward and shows in the viewport.

It simulates what the viewport shows, on small maps; each receiver gets a temporary shell that samples an
image the preview writes. Nothing of it is baked, rendered or saved: the shells are gone when the preview
ends, before the file is saved and when another file is loaded. Going back in time starts anew.
"""

import bpy
import numpy as np

from .. import native, session
from ..result import displacement, shell_nodes, snow_shell
from ..scene.pose import TopologyChanged, library_path, metres_per_unit
from ..scene.reader import SceneReader
from ..scene.receivers import receiver_specs
from ..scene.tracker import SceneTracker
from ..settings import preferred_engine, snow_of
from . import baked_receiver, plan, simulation
from .from_scene import constant_rates

RESOLUTION = 256
SUFFIX = "snow preview"
COLLECTION = "Snowbough Preview"
# Frames that playback may drop and the preview still makes up for in one step.
MAX_SKIPPED = 8


class Preview:
    """A running preview: the simulation and, by name, what it shows itself with."""

    def __init__(self, scene):
        self.scene_name = scene.name
        settings = scene.snowbough
        start, end = settings.frame_start, settings.frame_end
        rates = constant_rates(scene, start, end)
        self.snowfall = plan.plan_snowfall(
            start,
            end,
            settings.start_depth,
            settings.end_depth,
            rates or (settings.rate,) * (end - start + 1),
        )
        self.fps = scene.render.fps / scene.render.fps_base
        self.slide_half_life = settings.slide_half_life
        self.frame = None
        self.shells = {}
        self.images = {}
        self.simulation = None
        self.muted = displacement.Muted(scene, "show_viewport")
        # Shells of bakes are out of sight meanwhile: name -> whether they were before.
        self.hidden = {}

    # -- simulation --------------------------------------------------------------------------------

    def begin(self, scene, depsgraph):
        """Starts with the pose of the current frame, and the start depth on it."""
        self._close()
        settings = scene.snowbough
        specs = receiver_specs(scene)
        self.reader = SceneReader(specs, metres_per_unit(scene))
        pose = self.reader.read(depsgraph, scene.frame_current)
        texels = {}
        for key, obj in pose.objects.items():
            if obj.receiver is not None and obj.receiver.enabled:
                areas = baked_receiver.surface_and_uv_area(obj.topology, obj.positions)
                texels[key] = plan.metres_per_map(*areas) / RESOLUTION
        if not texels:
            raise ValueError("There is nothing for snow to lie on: use 'Add Snow to Selected'")
        self.simulation = simulation.make_simulation(
            native.load(),
            snow_of(settings),
            simulation.pixel_size(pose, list(texels.values())),
            preferred_engine(),
        )
        maps = {
            key: (RESOLUTION, settings.blur_radius * texel, pose.objects[key].receiver.sides)
            for key, texel in texels.items()
        }
        self.registry = simulation.Registry(self.simulation, maps)
        self.tracker = SceneTracker()
        self.receivers = {key: pose.objects[key] for key in texels}
        self._step(
            pose, scene.frame_current, plan.preroll_steps(self.snowfall, self.fps, self.slide_half_life)
        )
        self.frame = scene.frame_current

    def _step(self, pose, frame, steps):
        """Takes the steps on a pose; without any, the simulation still hears where everything is."""
        direction = plan.fall_direction(pose.fall_angle, pose.bearing)
        added, moved = self.tracker.register_changes(pose, frame, 0.0)
        self.registry.register_changes(added)
        self.registry.prepare()
        for step in steps or [plan.Step(frame, 0.0, 0.0, 0.0)]:
            self.simulation.step(moved, depth=step.depth, direction=direction, dt=step.dt)
            moved = {}

    def advance(self, scene, depsgraph):
        """Lets the snow of the frames since the last call fall on the current pose."""
        pose = self.reader.read(depsgraph, scene.frame_current)
        steps = []
        for frame in range(self.frame + 1, scene.frame_current + 1):
            if self.snowfall.frame_start <= frame <= self.snowfall.frame_end:
                steps += plan.frame_steps(self.snowfall, frame, self.fps)
        self._step(pose, scene.frame_current, steps)
        self.frame = scene.frame_current

    # -- showing it --------------------------------------------------------------------------------

    def show(self):
        for key, image_name in self.images.items():
            image = bpy.data.images.get(image_name)
            shell = bpy.data.objects.get(self.shells[key])
            if image is None or shell is None or key not in self.receivers:  # undone, deleted or hidden
                continue
            height = self.simulation.output(key, normal=False)["height"]
            pixels = np.ones((*height.shape, 4), dtype=np.float32)
            pixels[..., :3] = height[..., None]
            image.pixels.foreach_set(pixels.reshape(-1))
            image.update()
            shell.update_tag()

    def _collection(self, scene):
        """The one collection that all shells are in: closed in the outliner, out of renders and selections."""
        collection = bpy.data.collections.get(COLLECTION)
        if collection is None:
            collection = bpy.data.collections.new(COLLECTION)
            collection.hide_render = True
            collection.hide_select = True
        if COLLECTION not in scene.collection.children:
            scene.collection.children.link(collection)
        return collection

    def make_shells(self, scene):
        """One shell a receiver that is a mesh of its own; instanced collections show in bakes only."""
        self.muted.__enter__()
        for entry in scene.snowbough.receivers:
            for shell in snow_shell.find(entry):
                self.hidden[shell.name] = shell.hide_viewport
                shell.hide_viewport = True
        for key, pose in self.receivers.items():
            obj = next(
                (
                    entry.object
                    for entry in scene.snowbough.receivers
                    if entry.object is not None
                    and entry.object.type == "MESH"
                    and (entry.object.name, library_path(entry.object)) == (pose.name, pose.library)
                ),
                None,
            )
            if obj is None:
                continue
            name = f"{obj.name} {SUFFIX}"
            image = bpy.data.images.new(name, RESOLUTION, RESOLUTION, float_buffer=True, is_data=True)
            material = snow_shell.make_material(scene, name)
            source = snow_shell.source_of(scene, obj, pose.uv_map, image, RESOLUTION, material, relief=False)
            tree = shell_nodes.build_tree(f"{snow_shell.TREE_PREFIX} {name}", source)
            shell = snow_shell.make_object(scene, name, tree, material, self._collection(scene))
            self.shells[key], self.images[key] = shell.name, image.name

    def _close(self):
        if self.simulation is not None:
            self.simulation.close()
            self.simulation = None

    def end(self):
        self._close()
        for name in self.shells.values():
            shell = bpy.data.objects.get(name)
            if shell is not None:
                snow_shell.delete_object(shell)
        for name in self.images.values():
            image = bpy.data.images.get(name)
            if image is not None:
                bpy.data.images.remove(image)
        for name, was_hidden in self.hidden.items():
            if name in bpy.data.objects:
                bpy.data.objects[name].hide_viewport = was_hidden
        collection = bpy.data.collections.get(COLLECTION)
        if collection is not None and not collection.all_objects:
            bpy.data.collections.remove(collection)
        self.muted.__exit__()


def start(scene, depsgraph):
    """Begins the preview at the current frame. Raises what reading the scene or making the simulation raises."""
    stop()
    preview = Preview(scene)
    try:
        preview.begin(scene, depsgraph)
        preview.make_shells(scene)
        preview.show()
    except Exception:
        preview.end()
        raise
    session.preview = preview
    bpy.app.handlers.frame_change_post.append(_on_frame)


def stop():
    """Ends the preview and takes its shells away."""
    if _on_frame in bpy.app.handlers.frame_change_post:
        bpy.app.handlers.frame_change_post.remove(_on_frame)
    preview, session.preview = session.preview, None
    if preview is not None:
        preview.end()


@bpy.app.handlers.persistent
def _on_frame(scene, depsgraph=None):
    preview = session.preview
    if preview is None or scene.name != preview.scene_name or bpy.app.is_job_running("RENDER"):
        return
    ahead = scene.frame_current - preview.frame
    if ahead == 0 or depsgraph is None:
        return
    try:
        if 0 < ahead <= MAX_SKIPPED:
            try:
                preview.advance(scene, depsgraph)
            except TopologyChanged:  # a receiver that came in, or whose map ends here
                preview.begin(scene, depsgraph)
        else:
            preview.begin(scene, depsgraph)
        preview.show()
    except ValueError:  # nothing to snow on any more: a bake would say so
        stop()


@bpy.app.handlers.persistent
def _before_file(*_):
    stop()


def register():
    bpy.app.handlers.load_pre.append(_before_file)
    bpy.app.handlers.save_pre.append(_before_file)


def unregister():
    stop()
    bpy.app.handlers.save_pre.remove(_before_file)
    bpy.app.handlers.load_pre.remove(_before_file)
