# SPDX-License-Identifier: GPL-3.0-or-later
"""Each declaration reaches all users: settings reach simulation, manifest and panels; import options reach operators,
presets and the command line."""

import json
from dataclasses import fields

import bpy
import pytest
import snow_scene as s

# Non-default values of the simulation's settings.
OTHER = {
    "flutter": 0.25,
    "max_depth": 0.5,
    "slide_half_life": 1.5,
    "repose": 0.75,
    "cohesion": 0.004,
    "adhesion": 0.25,
    "rising": 0.125,
    "granular": True,
    "density": 250.0,
    "sun_share": 0.5,
    "unevenness": 0.125,
    "rain": 0.001,
    "soak": 0.003,
    "wet_spread": 0.1,
    "drying": 2.0,
    "drift": 0.25,
    "wet": True,
    "points": True,
    "landing": False,
    "throw_speed": 0.7,
    "spread": 0.2,
    "heap_grain": 0.05,
    "fall_time": False,
    "seed": 3,
    "noise_density": 0.5,
    "mapping": "GEOMETRY",
}


@pytest.fixture
def snowy(tmp_path):
    """A shot of two frames on one receiver with non-default values of all settings of the simulation."""
    s.receive(s.square("Ground"))
    s.settings(tmp_path, (1, 2), **OTHER)
    return bpy.context.scene


def test_each_setting_of_the_simulation_is_set_here(addon):
    assert set(addon("settings.simulation").SNOW_SETTINGS) == OTHER.keys()


def test_the_settings_go_into_the_request_as_they_are(addon, snowy):
    snow = addon("bake.from_scene").make_request(snowy).snow
    assert snow == {name: getattr(snowy.snowbough, name) for name in OTHER}
    assert snow == {name: pytest.approx(value) for name, value in OTHER.items()}


@pytest.fixture
def made(addon, stand_in):
    """Keyword arguments of each SnowSimulation that is made."""
    real, made = addon("base.native").load(), []

    def simulation(**arguments):
        made.append(arguments)
        return real.SnowSimulation(**arguments)

    stand_in(SnowSimulation=simulation)
    return made


def preview(addon):
    """Starts and ends one, without a picture, which needs a window."""
    live = addon("preview.live")
    live.start(bpy.context.scene, bpy.context.evaluated_depsgraph_get(), draws=False)
    live.stop()


@pytest.mark.parametrize("call", [lambda addon: s.bake(), preview])
def test_bake_and_preview_hand_all_of_them_to_the_simulation(addon, snowy, made, call):
    call(addon)
    (arguments,) = made
    assert {name: arguments[name] for name in OTHER} == {n: pytest.approx(v) for n, v in OTHER.items()}


def test_the_manifest_names_all_of_them(snowy, tmp_path):
    s.bake()
    manifest = json.loads((s.folder_of(tmp_path, "Ground") / "object.json").read_text())
    snowfall = manifest["settings"]["snowfall"]
    assert {name: snowfall[name] for name in OTHER} == {name: pytest.approx(v) for name, v in OTHER.items()}


def test_panels_show_every_setting_of_the_simulation(addon):
    panels = addon("ui.panels")
    shown = {
        name
        for cls in panels.CLASSES
        for group in getattr(cls, "names", ())
        for name in ([group] if isinstance(group, str) else group)
    }
    assert set(addon("settings.simulation").SNOW_SETTINGS) - shown == set()


# -- options of the import --------------------------------------------------------------------------------


def option_names(addon):
    return {option.name for option in fields(addon("tree.import_options").ImportOptions)}


def test_both_operators_have_every_option(addon):
    names = option_names(addon)
    for operator in (bpy.ops.import_scene.xfrog_tree, bpy.ops.snowbough.import_tree_job):
        assert names <= set(operator.get_rna_type().properties.keys())


def test_the_command_line_has_every_option_with_its_default(addon):
    options, parser = addon("tree.import_options"), addon("cli").parser()
    given = addon("base.options").options_of(options.ImportOptions, parser.parse_args(["import", "tree.obj"]))
    assert given == options.ImportOptions()
    assert given.max_bones == 1000 and given.simplify == "DETAIL" and given.foliage is True


@pytest.mark.parametrize(
    "arguments, name, value",
    [
        (["--up-axis", "Z"], "up_axis", "Z"),
        (["--levels", "Trunk,Branch"], "levels", "Trunk,Branch"),
        (["--tolerance", "1.5"], "tolerance", 1.5),
        (["--detail", "FILM"], "detail", "FILM"),
        (["--unit", "FEET"], "unit", "FEET"),
        (["--height", "12.5"], "height", 12.5),
        (["--show-bones"], "show_bones", True),
        (["--wind-attributes"], "wind_attributes", True),
        (["--mark-asset"], "mark_asset", True),
        (["--lod-chain"], "lod_chain", True),
        (["--max-bone-level", "-1"], "max_bone_level", -1),
        (["--no-foliage"], "foliage", False),
        (["--foliage", "leaf"], "foliage_names", "leaf"),
        (["--snow-resolution", "512"], "snow_resolution", 512),
    ],
)
def test_options_of_the_command_line_arrive(addon, arguments, name, value):
    given = addon("cli").parser().parse_args(["import", "tree.obj", *arguments])
    assert getattr(given, name) == value


@pytest.mark.parametrize(
    "arguments",
    [["--detail", "FINE"], ["--max-bones", "-1"], ["--snow-resolution", "9000"], ["--width", "THIN"]],
)
def test_what_a_property_would_not_take_is_a_wrong_command_line(addon, arguments, capsys):
    assert addon("cli").run(["import", "tree.obj", *arguments]) == 2
    assert arguments[0] in capsys.readouterr().err


def test_every_option_but_that_of_scripts_stands_under_one_heading(addon):
    options = addon("tree.import_options")
    shown = [name for _identifier, _text, names in options.SECTIONS for name in names]
    assert len(shown) == len(set(shown))
    assert option_names(addon) - set(shown) == {"simplify", "tolerance"}
    panels = [cls.names for cls in addon("ui.import_panels").CLASSES]
    assert [name for names in panels for name in names] == shown


def test_every_preset_sets_every_option_but_those_of_the_file(addon):
    presets, names = addon("tree.presets"), option_names(addon)
    assert presets.OF_THE_FILE <= names
    for preset in presets.PRESETS.values():
        lines = [line for line in presets.text_of(preset).splitlines() if line.startswith("op.")]
        assert {line[3:].partition(" = ")[0] for line in lines} == names - presets.OF_THE_FILE
