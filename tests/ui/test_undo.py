# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl+Z and Ctrl+Shift+Z after the buttons that change the scene."""

from snow_shot import SNOW_SCENE, START
from window import ROOT

# Two meshes to snow on: one without a UV map but with a material of its own, and Blender's cube.
UNDRESSED = """
bpy.ops.mesh.primitive_plane_add(size=8.0, calc_uvs=False)
ground = bpy.context.object
ground.data.materials.append(bpy.data.materials.new("Soil"))
bpy.data.objects["Cube"].select_set(True)
bpy.ops.ed.undo_push(message="Scene")
result = True
"""
LOOK = """
def look():
    meshes = [
        [
            obj.name,
            [layer.name for layer in obj.data.uv_layers],
            [modifier.name for modifier in obj.modifiers],
            [[slot.link, slot.material and slot.material.name] for slot in obj.material_slots],
        ]
        for obj in sorted(bpy.data.objects, key=lambda obj: obj.name)
        if obj.type == "MESH"
    ]
    receivers = [[entry.object and entry.object.name, entry.uv_map] for entry in bpy.context.scene.snowbough.receivers]
    blocks = [len(getattr(bpy.data, kind)) for kind in ("objects", "meshes", "materials", "node_groups", "images")]
    return [receivers, meshes, blocks]


result = look()
"""


def assert_undone_and_redone(window, before, after):
    window.move(500, 500)
    window.key("ctrl+z")
    window.wait_until(f"look() == {before!r}")
    window.key("ctrl+shift+z")
    window.wait_until(f"look() == {after!r}")


def test_undo_takes_back_all_of_add_snow_and_of_remove_snow(window):
    window.run(UNDRESSED)
    before = window.run(LOOK)
    window.open_sidebar_tab()
    window.press_button("snowbough.add_receivers")
    window.wait_until("len(bpy.context.scene.snowbough.receivers) == 2")
    snowy = window.run(LOOK)
    meshes = {name: (layers, modifiers, slots) for name, layers, modifiers, slots in snowy[1]}
    # The snow surface, which is the default, comes with the first bake.
    assert meshes["Plane"][0] == ["snow"] and meshes["Plane"][1] == []
    assert meshes["Plane"][2] == [["DATA", "Soil"]]
    assert_undone_and_redone(window, before, snowy)

    window.run("result = list(bpy.ops.snowbough.setup_displacement('EXEC_DEFAULT', True, mode='MODIFIER'))")
    dressed = window.run(LOOK)
    modifiers, slots = next(mesh[2:] for mesh in dressed[1] if mesh[0] == "Plane")
    assert modifiers == ["Snowbough Subdivision"] and slots == [["OBJECT", "Soil snow"]]
    assert_undone_and_redone(window, snowy, dressed)

    window.run("result = list(bpy.ops.snowbough.remove('EXEC_DEFAULT', True))")
    bare = window.run(LOOK)
    assert [name for name, *_ in bare[1]] == ["Cube", "Plane"]
    assert [slots for name, _, _, slots in bare[1] if name == "Plane"] == [[["DATA", "Soil"]]]
    assert_undone_and_redone(window, dressed, bare)


SURFACES = "sorted(obj.name for obj in bpy.context.scene.objects if obj.snowbough.is_shell)"


def test_undo_takes_back_the_surfaces_of_a_bake_and_redo_shows_them(window, tmp_path):
    window.run(SNOW_SCENE.format(frames=3, resolution=256, path=str(tmp_path / "shot.blend")))
    window.run("bpy.ops.ed.undo_push(message='Scene')\nresult = True")
    window.run(START)
    window.wait_for_bake()
    window.wait_until(f"{SURFACES} == ['Cube Snow', 'Plane Snow']")
    window.move(500, 500)
    window.key("ctrl+z")
    window.wait_until(f"{SURFACES} == []")
    window.key("ctrl+shift+z")
    window.wait_until(f"{SURFACES} == ['Cube Snow', 'Plane Snow']")
    assert (
        window.run(
            """
evaluated = bpy.data.objects["Plane Snow"].evaluated_get(bpy.context.evaluated_depsgraph_get())
result = max(vertex.co.z for vertex in evaluated.data.vertices)
"""
        )
        > 0.05
    )


def test_a_deleted_receiver_takes_its_surface_along_and_undo_brings_both_back(window, tmp_path):
    window.run(SNOW_SCENE.format(frames=3, resolution=256, path=str(tmp_path / "shot.blend")))
    window.run(START)
    window.wait_for_bake()
    window.run(
        "for obj in bpy.context.scene.objects: obj.select_set(obj.name == 'Cube')\n"
        "bpy.ops.ed.undo_push(message='Select')\nresult = True"
    )
    window.move(500, 500)
    window.key("Delete")
    window.wait_until(f"{SURFACES} == ['Plane Snow']")
    window.key("ctrl+z")
    window.wait_until(f"'Cube' in bpy.context.scene.objects and {SURFACES} == ['Cube Snow', 'Plane Snow']")


def test_update_surface_is_a_step_of_its_own(window, tmp_path):
    window.run(SNOW_SCENE.format(frames=3, resolution=256, path=str(tmp_path / "shot.blend")))
    window.run(START)
    window.wait_for_bake()
    (points,) = tmp_path.rglob("Plane-*/surface.pc2")
    before = points.stat().st_mtime_ns
    window.run(
        "bpy.context.scene.snowbough.surface_relief = 0.0\nbpy.ops.ed.undo_push(message='Relief')\nresult = 1"
    )
    window.run(
        "window, area = view3d()\n"
        "with bpy.context.temp_override(window=window, area=area):\n"
        "    bpy.ops.snowbough.update_surface('INVOKE_DEFAULT')\n"
        "result = True"
    )
    # Blender lists an operator when it has ended.
    window.wait_until(
        "'SNOWBOUGH_OT_update_surface' in [each.bl_idname for each in bpy.context.window_manager.operators]"
    )
    assert points.stat().st_mtime_ns > before
    window.move(500, 500)
    window.key("ctrl+z")
    # What it wrote stays; the slider's own step is there still.
    window.wait_until(f"{SURFACES} == ['Cube Snow', 'Plane Snow']")
    assert window.run("result = bpy.context.scene.snowbough.surface_relief") == 0.0


def test_the_sidebar_lets_a_selected_tree_sway_and_undo_stops_it(window):
    tree = ROOT / "tests" / "data" / "small_maple.obj"
    window.run(
        f"bpy.ops.import_scene.xfrog_tree(filepath={str(tree)!r})\n"
        "rig = next(obj for obj in bpy.data.objects if obj.type == 'ARMATURE')\n"
        "bpy.context.view_layer.objects.active = rig\n"
        "bpy.ops.ed.undo_push(message='Tree')\n"
        "result = rig.name"
    )
    window.open_sidebar_tab()
    window.press_button("snowbough.add_sway")
    window.wait_until("len(bpy.data.actions) == 1")
    window.screenshot("sway")
    window.move(500, 500)
    window.key("ctrl+z")
    window.wait_until("len(bpy.data.actions) == 0 and 'ARMATURE' in {obj.type for obj in bpy.data.objects}")
