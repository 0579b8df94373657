# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface: tooltips with units, undo, and disabled buttons that give a reason."""

import inspect
import os
import re

import bpy
import child
import pytest
from snow_scene import bake, receive, settings, square

PACKAGE = os.environ["SNOWBOUGH_TEST_ADDON"]

# Units that a tooltip may name, in brackets: "(metres)", "(texels)".
UNITS = re.compile(
    r"\((metres|metres per hour|metres per second|degrees|seconds|frames|texels|pixels|radii of the limb|levels|bones|"
    r"keys|poses per frame|directions per shot|square metres|kilograms|kilograms per cubic metre|gigapascals|"
    r"megapascals|0 to 1)\)"
)
# Units as labels and messages show them.
SHOWN_AS = {
    "metres": "m", "seconds": "s", "degrees": "°", "texels": "texels", "kilograms": "kg",
    "kilograms per cubic metre": "kg/m³", "gigapascals": "GPa", "megapascals": "MPa",
}  # fmt: skip
FRAMES = re.compile(r"frame|checkpoint_interval")
UNITLESS = {
    "rate", "strength", "seed", "samples", "surface_overhang", "surface_hem_variation", "surface_bridging",
    "surface_relief", "active_receiver", "bark_vertices", "spread",
}  # fmt: skip

# These push no undo step.
NOT_UNDOABLE = {
    "export_scene.snowbough_tree": "writes files and changes nothing",
    "import_scene.xfrog_tree": "in a window snowbough.import_tree_job leaves the step",
    "snowbough.bake": "pushes its own step when the job has ended",
    "snowbough.update_surface": "pushes its own step when the job has ended",
    "snowbough.stop_bake": "changes nothing but the running bake",
    "snowbough.lock_editing": "changes nothing",
    "snowbough.preflight": "only looks",
    "snowbough.toggle_preview": "shows what is not part of the file",
}


def all_below(cls):
    for below in cls.__subclasses__():
        yield below
        yield from all_below(below)


def operators():
    """{idname: class} of the add-on's operators."""
    return {
        cls.bl_idname: cls
        for cls in all_below(bpy.types.Operator)
        if cls.__module__.startswith(PACKAGE) and hasattr(cls, "bl_idname")
    }


def options(cls):
    return getattr(cls, "bl_options", set())


def blenders(idname):
    group, name = idname.split(".")
    return getattr(getattr(bpy.ops, group), name)


def described():
    """[(name, RNA property)] of all that an artist can set: settings, and options of operators."""
    owners = [
        (cls, cls.bl_rna) for cls in all_below(bpy.types.PropertyGroup) if cls.__module__.startswith(PACKAGE)
    ]
    for idname, cls in operators().items():
        if "INTERNAL" not in options(cls):
            owners.append((cls, blenders(idname).get_rna_type()))
    return [
        (f"{cls.__name__}.{prop.identifier}", prop)
        for cls, rna in owners
        for prop in rna.properties
        if any(prop.identifier in inspect.get_annotations(base) for base in cls.__mro__)
        and prop.identifier not in {"filepath", "check_existing"}  # Blender's own
    ]


def test_the_walk_finds_the_settings_and_the_operators():
    names = {name for name, _ in described()}
    assert {
        "SnowboughSceneSettings.end_depth",
        "SnowboughReceiver.resolution",
        "SnowboughObjectSettings.occlude",
        "SNOWBOUGH_OT_add_sway.strength",
        "SNOWBOUGH_OT_setup_material.only_selected",
        "IMPORT_SCENE_OT_xfrog_tree.detail",
    } <= names
    assert {"snowbough.bake", "snowbough.add_receivers", "import_scene.xfrog_tree"} <= operators().keys()


def test_every_property_has_a_tooltip_without_a_period_at_its_end():
    assert [name for name, prop in described() if not prop.description] == []
    assert [name for name, prop in described() if prop.description.endswith(".")] == []


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="before 4.5, all fields of paths take //")
def test_folders_of_settings_may_lie_beside_the_blend():
    """Blender 4.5 and later show // in red elsewhere."""
    settings = [(name, prop) for name, prop in described() if name.startswith("Snowbough")]
    paths = {name: prop for name, prop in settings if prop.subtype in {"DIR_PATH", "FILE_PATH"}}
    assert "SnowboughSceneSettings.cache_directory" in paths
    assert [name for name, prop in paths.items() if not prop.is_path_supports_blend_relative] == []


def test_every_number_names_its_unit(addon):
    for name, prop in described():
        if prop.type not in {"FLOAT", "INT"}:
            continue
        unit = UNITS.search(prop.description)
        identifier = prop.identifier
        assert bool(unit) == (identifier not in UNITLESS), f"{name}: {prop.description!r}"
        if not unit:
            continue
        assert (prop.subtype == "ANGLE") == (unit[1] == "degrees"), name
        assert addon("base.names").unit_of(prop.description) == SHOWN_AS.get(unit[1], ""), name
        if FRAMES.search(identifier):
            assert unit[1] == "frames", name


def test_fields_show_the_units_that_blender_does_not_show(addon):
    shown = [
        addon("ui.panel_parts").setting_label(bpy.context.scene.snowbough, name)
        for name in ("end_depth", "slide_half_life", "blur_radius", "repose", "rate")
    ]
    assert shown == ["End Depth (m)", "Slide Half-Life (s)", "Blur Radius (texels)", "Repose", "Rate"]


def test_choices_are_described():
    for name, prop in described():
        if prop.type == "ENUM":
            assert [f"{name}: {item.identifier}" for item in prop.enum_items if not item.description] == []
            assert [item.identifier for item in prop.enum_items if item.description.endswith(".")] == [], name


def test_every_operator_says_what_it_does_without_a_period_at_its_end():
    for idname in operators():
        description = blenders(idname).get_rna_type().description
        assert description, idname
        assert not description.endswith("."), idname


def test_every_operator_that_changes_the_scene_can_be_undone():
    without = {idname for idname, cls in operators().items() if "UNDO" not in options(cls)}
    assert without == NOT_UNDOABLE.keys()


def refusal(idname):
    """Blender's error for a script that calls an operator whose poll fails; None if it succeeds."""
    operator = blenders(idname)
    if operator.poll():
        return None
    with pytest.raises(RuntimeError) as error:
        operator()
    return str(error.value)


def test_greyed_buttons_say_why_in_an_empty_scene():
    refused = {idname: text for idname in operators() if (text := refusal(idname)) is not None}
    expected = {"snowbough.bake", "snowbough.add_receivers", "snowbough.add_sway", "snowbough.remove"}
    assert expected <= refused.keys()
    assert [idname for idname, text in refused.items() if "context is incorrect" in text] == []


def test_nothing_that_changes_the_scene_can_be_pressed_while_a_bake_runs(addon, tmp_path):
    settings(tmp_path)
    ground = square("Ground")
    receive(ground)
    ground.select_set(True)
    bpy.context.view_layer.objects.active = ground
    from_scene, refused = addon("bake.from_scene"), {}

    def press_all(_result):
        for idname in operators():
            if idname not in {"snowbough.stop_bake", "snowbough.lock_editing"} and "import" not in idname:
                refused[idname] = refusal(idname)

    request = from_scene.make_request(bpy.context.scene)
    running = from_scene.prepare_bake(bpy.context.scene, request, press_all)
    addon("bake.engine").run(bpy.context, running)
    assert running.error is None and "snowbough.bake" in refused
    assert [idname for idname, text in refused.items() if "A bake is running" not in (text or "")] == []


def test_sway_is_greyed_without_a_tree():
    ground = square("Ground")
    bpy.context.view_layer.objects.active = ground
    assert "Select a tree" in refusal("snowbough.add_sway")


def test_long_texts_are_wrapped_where_they_fit_and_lose_nothing(addon):
    text = "The cache folder /a/path/that/is/much/longer/than/a/sidebar cannot be written: choose another one"
    lines = list(addon("ui.text").wrapped(text, lambda line: len(line) <= 20))
    assert max(map(len, lines)) <= 20 and lines[0] == "The cache folder"
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    assert list(addon("ui.text").wrapped("Short", lambda line: len(line) <= 20)) == ["Short"]


def test_what_was_said_about_one_file_is_not_said_about_the_next(addon, tmp_path):
    settings(tmp_path)
    receive(square("Ground"))
    bake()
    bpy.ops.snowbough.preflight()
    assert addon("base.session").last_outcome[1].startswith("Baked 4 frames")
    assert addon("base.session").issues
    bpy.ops.wm.read_homefile(use_empty=True)
    assert addon("base.session").last_outcome == ("INFO", "")
    assert addon("base.session").issues == {}


def test_the_report_of_a_bake_goes_with_an_undo(addon, tmp_path):
    settings(tmp_path, (1, 1))
    receive(square("Ground"))
    bpy.ops.ed.undo_push(message="Scene")
    bake()
    bpy.ops.ed.undo_push(message="Bake")
    assert addon("base.session").last_outcome[1].startswith("Baked 1 frame in ")
    bpy.ops.ed.undo()
    assert addon("base.session").last_outcome == ("INFO", "")


def test_freeing_a_bake_leaves_no_missing_file_on_its_receivers(tmp_path):
    settings(tmp_path)
    ground = square("Ground")
    receive(ground)
    bake()
    bpy.ops.snowbough.setup_displacement(mode="MODIFIER")
    entry = bpy.context.scene.snowbough.receivers[0]
    assert [modifier.type for modifier in ground.modifiers] == ["SUBSURF", "DISPLACE"]
    bpy.ops.snowbough.free_bake()
    assert entry.folder == ""
    assert [modifier.type for modifier in ground.modifiers] == ["SUBSURF"]
    shown = [
        node.image.filepath
        for slot in ground.material_slots
        for node in slot.material.node_tree.nodes
        if node.type == "TEX_IMAGE" and node.image
    ]
    assert shown == []


def test_a_bake_on_the_command_line_prints_its_own_lines_only(tmp_path):
    settings(tmp_path / "cache", (1, 3))
    receive(square("Ground"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    done = child.bake(tmp_path / "shot.blend")
    assert done.returncode == 0, done.stderr
    # Output of any Blender in the background.
    blenders_own = re.compile(r"Blender \d|Read blend|Blender quit|\d\d:\d\d\.\d+ +[\w.]+ +\| |$")
    lines = [line for line in done.stdout.splitlines() if not blenders_own.match(line)]
    said = [line.split()[:2] for line in lines]
    assert said[0][0] == "SNOWBOUGH" and said[0][1].startswith("cache=")
    assert said[1:] == [["SNOWBOUGH", word] for word in ("frame=1", "frame=2", "frame=3", "done")]
    assert done.stderr == ""
