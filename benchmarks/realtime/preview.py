# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview's frame rate.

    xvfb-run -a -s "-screen 0 960x600x24" blender --factory-startup --window-geometry 0 0 960 600 \\
        -P benchmarks/realtime/preview.py -- [--resolution 256] [--frames 20] [--engine AUTO]

Needs a window (a real one works, too). Plays a scene of a ground, a box and two round objects once, keeps the maps of
every frame, and shows them frame by frame. Drawing and simulation are measured separately:

show       a frame's maps until the view can be drawn: the points of the surface
draw       a redraw of the window, minus a redraw without snow; it includes the upload of new points
step       the simulation of a frame, and storing the frame for scrubbing
output     smoothing of its maps

Wall-clock seconds are what a user feels; processor seconds are comparable on a busy machine. Rates are by the clock:
frames per second of show and draw, and of all parts together.
"""

import argparse
import sys
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "addon"))

import snowbough  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(prog="preview.py", description="The live preview's frame rate.")
    parser.add_argument("--resolution", type=int, default=256, help="of all maps (texels)")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--engine", default="AUTO", choices=("AUTO", "GL", "CPU"))
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])


# -- scene ---------------------------------------------------------------------------------------------


def make_scene(resolution, frames):
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    made = []
    bpy.ops.mesh.primitive_plane_add(size=6.0)
    made.append(bpy.context.object)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.5))
    made.append(bpy.context.object)
    for location in ((1.8, 0.0, 0.7), (-1.8, 0.3, 0.7)):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=location)
        bpy.ops.object.shade_smooth()
        made.append(bpy.context.object)
    for obj in made:
        obj.select_set(True)
    bpy.ops.snowbough.add_receivers()
    bpy.ops.object.select_all(action="DESELECT")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    scene.snowbough.end_depth = 0.15
    for receiver in scene.snowbough.receivers:
        receiver.resolution = resolution
    scene.frame_set(1)
    return scene


def fill_window():
    """The 3D view alone, on the scene."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    bpy.context.preferences.system.viewport_aa = "OFF"  # otherwise a still view is redrawn continuously
    view = area.spaces.active.region_3d
    view.view_location, view.view_distance = (0.0, 0.0, 0.5), 8.0
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.screen_full_area()


# -- measuring -----------------------------------------------------------------------------------------


@dataclass
class Clock:
    """Wall-clock and processor seconds, by name."""

    wall: dict = field(default_factory=dict)
    processor: dict = field(default_factory=dict)

    def measure(self, name, work):
        wall, processor = time.perf_counter(), time.process_time()
        result = work()
        self.wall.setdefault(name, []).append(time.perf_counter() - wall)
        self.processor.setdefault(name, []).append(time.process_time() - processor)
        return result

    def of(self, name):
        """(wall, processor) in milliseconds, medians over the frames."""
        return tuple(float(np.median(times[name])) * 1000.0 for times in (self.wall, self.processor))


def redraw():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        area.tag_redraw()
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)


def play(scene, clock):
    """The maps of every frame, [{key: (H, H)}], and the running simulation."""
    from snowbough.preview.playback import Playback

    playback = clock.measure("begin", lambda: Playback(scene, bpy.context.evaluated_depsgraph_get()))
    maps = []
    for frame in range(scene.frame_start + 1, scene.frame_end + 1):
        scene.frame_set(frame)
        clock.measure("step", lambda: playback.go_to(scene, bpy.context.evaluated_depsgraph_get()))
        maps.append(
            clock.measure(
                "output",
                lambda: {
                    key: playback.simulation.output(key, normal=False)["height"].copy()
                    for key in playback.maps
                },
            )
        )
    return playback, maps


# -- drawing --------------------------------------------------------------------------------------


class Drawn:
    """The draw handler."""

    def __init__(self, scene, playback):
        from snowbough.base import view_drawing
        from snowbough.preview import drawing, live
        from snowbough.surface.style import SurfaceStyle

        self.playback = playback
        self.style = SurfaceStyle()
        budget = drawing.SOFTWARE_BUDGET if view_drawing.draws_in_software() else drawing.BUDGET
        self.surfaces = live.make_surfaces(playback, *budget)
        self.drawn = drawing.Drawing(scene.unit_settings.scale_length)
        self.handle = bpy.types.SpaceView3D.draw_handler_add(
            lambda: self.drawn.draw(False), (), "WINDOW", "POST_VIEW"
        )
        print("drawn by", drawing.gpu.platform.renderer_get(), file=sys.stderr)

    def show(self, maps):
        for key, height in maps.items():
            pose = self.playback.pose.objects[key]
            depth = float(np.abs(height).max())
            self.surfaces[key].points(height, depth, pose.positions, self.style)
            self.drawn.show(key, self.surfaces[key])

    def end(self):
        bpy.types.SpaceView3D.draw_handler_remove(self.handle, "WINDOW")


def measure(way, maps, clock, name):
    way.show(maps[0])
    redraw()
    for own in maps:
        clock.measure(f"{name} show", partial(way.show, own))
        clock.measure(f"{name} draw", redraw)
    way.end()
    redraw()


def rows(clock):
    """A Markdown row."""
    step, output = clock.of("step"), clock.of("output")
    for name, text in (("drawn", "draw handler"),):
        show, bare = clock.of(f"{name} show"), clock.of(f"{name} bare")
        draw = [max(0.0, value - empty) for value, empty in zip(clock.of(f"{name} draw"), bare)]
        shown = show[0] + draw[0]
        everything = shown + bare[0] + step[0] + output[0]
        cells = [f"{wall:.1f} / {processor:.1f}" for wall, processor in (show, draw, step, output, bare)]
        yield f"| {text} | {' | '.join(cells)} | {1000.0 / shown:.1f} | {1000.0 / everything:.1f} |"


def work():
    given = arguments()
    snowbough.register()
    from snowbough.preview import playback as module

    module.preview_limits = lambda: (given.resolution, 1 << 30)
    module.preferred_engine = lambda: given.engine
    scene = make_scene(given.resolution, given.frames)
    fill_window()
    clock = Clock()
    playback, maps = play(scene, clock)
    for way, name in ((Drawn, "drawn"),):
        redraw()
        for _ in range(5):
            clock.measure(f"{name} bare", redraw)
        measure(way(scene, playback), maps, clock, name)
    print(
        f"\nMaps of {given.resolution}, engine {playback.simulation.engine}; milliseconds: wall / processor\n"
    )
    print(
        "| shown by | show | draw | step | output | window without snow | show and draw a second | all a second |"
    )
    print("|---|---|---|---|---|---|---|---|")
    print("\n".join(rows(clock)))
    playback.close()


def main():
    try:
        work()
    finally:
        sys.stdout.flush()
        bpy.ops.wm.quit_blender()


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(main, first_interval=0.5)
