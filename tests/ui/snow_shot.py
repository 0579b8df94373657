# SPDX-License-Identifier: GPL-3.0-or-later
"""A small snowy shot in the window: set up, baked, and looked at afterwards."""

from window import wait_for

# A ground and a box over it, the default camera, and a saved file, since caches lie beside it.
SNOW_SCENE = """
bpy.ops.mesh.primitive_plane_add(size=8.0)
ground = bpy.context.object
bpy.data.objects["Cube"].location.z = 1.5
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, {frames}
scene.snowbough.surface_detail = "DRAFT"
for mesh in (ground, bpy.data.objects["Cube"]):
    mesh.select_set(True)
bpy.ops.snowbough.add_receivers()
for entry in scene.snowbough.receivers:
    entry.resolution = {resolution}
bpy.ops.wm.save_as_mainfile(filepath={path!r})
result = len(scene.snowbough.receivers)
"""

START = """
window, area = view3d()
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.snowbough.bake("INVOKE_DEFAULT")
result = True
"""


def heights(folder):
    return sorted(folder.rglob("height_*.exr"))


def wait_for_heights(folder, count, timeout=180):
    """Waits until that many maps are written, of all receivers together."""
    wait_for(lambda: len(heights(folder)) >= count, f"{count} maps in {folder}", timeout)


# A bake that leaves the processor to the window: each frame takes its time, and is small. Resuming it evaluates all its
# frames again, without the wait.
SLOW_FRAMES = """
import time
def wait(*_):
    time.sleep(0.15)
bpy.app.handlers.frame_change_pre.append(wait)
result = True
"""


def make_long_shot(window, folder, substeps=1):
    """Sets up a shot of 1500 frames, whose maps and surfaces are small (deep snow has few points): ending its bake and
    resuming it take little time. substeps above 1: a bake that computes all the time."""
    window.run(SNOW_SCENE.format(frames=1500, resolution=256, path=str(folder / "shot.blend")))
    settings = f"scene.snowbough.substeps = {substeps}\nscene.snowbough.end_depth = 30.0\n"
    window.run(f"{settings}bpy.ops.wm.save_mainfile()\nresult = True")
    if substeps == 1:
        window.run(SLOW_FRAMES)


def bake_in_the_background(window, folder, substeps=1):
    """Starts a bake as its button does and comes back when the first frames are written."""
    make_long_shot(window, folder, substeps)
    window.run(START)
    wait_for_heights(folder, 6)
    assert window.run("result = bpy.app.is_job_running('RENDER')")


def assert_resumable(window, folder):
    """No stray data remains, and Resume finds a checkpoint and finishes the (shortened) shot."""
    assert [
        path.name for path in folder.rglob("*") if path.name.startswith("lock") or ".tmp" in path.name
    ] == []
    assert len(list(folder.rglob("state_*.json"))) >= 2
    written = len(heights(folder))
    window.run(
        f"""
import sys
if "wait" in globals() and wait in bpy.app.handlers.frame_change_pre:
    bpy.app.handlers.frame_change_pre.remove(wait)
from_scene, engine = sys.modules[addon + ".bake.from_scene"], sys.modules[addon + ".bake.engine"]
done = max(int(p) for p in {[path.stem.split("_")[1] for path in heights(folder)]!r})
request = from_scene.make_request(bpy.context.scene, resume=True, last=done + 2)
running = from_scene.prepare_bake(bpy.context.scene, request)
engine.run(bpy.context, running)
result = str(running.error or "")
""",
        timeout=120,
    )
    assert window.run("result = [str(running.error or ''), running.cancelled]") == ["", False]
    assert window.run("result = running.job.results[0].frame") > 1
    assert len(heights(folder)) == written + 4
