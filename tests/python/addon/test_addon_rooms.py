# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's rooms: imports have one direction and no cycles, and modules without Blender do not import it.

The imports are read from the files, without importing them.
"""

import ast
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

# From the ground up: a module imports from its own room and from those above it in this list. A room is a folder
# of the package or a module beside them. The package's own __init__ imports nothing before register().
ROOMS = (
    "__init__",
    "base",
    "settings",
    "cache",
    "surface",
    "scene",
    "result",
    "tree",
    "bake",
    "gltf",
    "usd",
    "preview",
    "bending",
    "realtime",
    "ui",
    "cli",
)

# Modules that can be imported where there is no Blender.
WITHOUT_BLENDER = (
    "__init__",
    "base.names",
    "base.map_kinds",
    "base.native",
    "base.session",
    "cli",
    "cache.errors",
    "cache.files",
    "cache.journal",
    "cache.location",
    "cache.lock",
    "cache.manifest",
    "cache.folder",
    "cache.versions",
    "cache.owner",
    "cache.sealed",
    "cache.shapes",
    "cache.coverage",
    "surface.compute",
    "surface.mesh_file",
    "surface.neighbours",
    "surface.point_cache",
    "surface.recording",
    "surface.style",
    "scene.inputs",
    "scene.pose",
    "scene.tracker",
    "scene.uv_overlap",
    "scene.card_layout",
    "scene.physics_caches",
    "result.original_state",
    "tree.bone_names",
    "tree.skeleton_text",
    "tree.wind",
    "tree.wind_attributes",
    "gltf.compression",
    "gltf.document",
    "gltf.impostor",
    "gltf.quantise",
    "gltf.snow_maps",
    "gltf.triangle_mesh",
    "gltf.texels",
    "gltf.thinning",
    "gltf.tree_data",
    "gltf.tree_file",
    "usd",
    "usd.instances",
    "usd.materials",
    "usd.stage",
    "usd.wind_json",
    "bake.memory",
    "bake.plan",
    "bake.request",
    "bake.log",
    "bake.map_writer",
    "bake.simulation",
    "bake.baked_receiver",
    "bake.continuing",
    "bake.resuming",
    "bake.frames",
    "bake.job",
    "preview.history",
    "preview.interface",
    "preview.receiver_surface",
    "bending.cantilevers",
    "bending.load",
    "bending.small_bake",
    "realtime.records",
    "realtime.sync",
    "realtime.lights",
    "realtime.pacing",
    "realtime.frame_code",
    "ui.text",
)

BLENDERS = {"bpy", "bpy_extras", "bmesh", "mathutils", "blf", "gpu", "addon_utils"}
MAX_MODULES = 20
ADDON = Path(__file__).resolve().parents[3] / "addon" / "snowbough"


@dataclass(frozen=True)
class Import:
    """One module of the package, or one of Blender's, that a module of the package imports."""

    importer: str
    imported: str
    place: str
    """``<file>:<line>``."""
    on_load: bool
    """False inside a function, where it happens when that is called."""


def module_names(package):
    """{name within the package: file}; a folder's __init__ goes by the folder's name, the package's by its own."""
    names = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package).with_suffix("").parts
        names[".".join(parts[:-1] if len(parts) > 1 and parts[-1] == "__init__" else parts)] = path
    return names


def imports_of(package):
    """Every Import in the package's files."""
    names = module_names(package)
    return [found for name, path in names.items() for found in _imports_in(package, names, name, path)]


def _imports_in(package, names, importer, path):
    folder = path.relative_to(package).parent.parts

    def known(dotted):
        return dotted if dotted in names else None

    def targets(node):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from absolute(alias.name.split("."))
        elif node.level == 0:
            for alias in node.names:
                yield from absolute([*node.module.split("."), alias.name])
        else:
            base = [*folder[: len(folder) - (node.level - 1)], *(node.module or "").split(".")]
            for alias in node.names:
                yield from inside([part for part in (*base, alias.name) if part])

    def absolute(parts):
        if parts[0] in BLENDERS:
            yield parts[0]
        elif parts[0] == package.name:
            yield from inside(parts[1:])

    def inside(parts):
        """The module that a dotted name is, or is part of."""
        found = known(".".join(parts)) or known(".".join(parts[:-1])) or "__init__"
        yield found

    def walk(node, on_load):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.Import, ast.ImportFrom)):
                place = f"{path.relative_to(package).as_posix()}:{child.lineno}"
                for target in targets(child):
                    if target != importer:
                        yield Import(importer, target, place, on_load)
            inner = isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
            yield from walk(child, on_load and not inner)

    return list(walk(ast.parse(path.read_text(encoding="utf-8")), True))


def room_of(module):
    return module.partition(".")[0]


def upward(imports, rooms):
    """A text for each import that runs from a room to one that is not below it."""
    order = {room: number for number, room in enumerate(rooms)}
    for one in imports:
        if one.imported in BLENDERS:
            continue
        here, there = room_of(one.importer), room_of(one.imported)
        for room in (here, there):
            if room not in order:
                yield f"{one.place}: {room} is no room in the list"
        if order.get(there, -1) > order.get(here, len(order)):
            yield f"{one.place}: {here} imports {one.imported}, but {there} is above {here}"


def circles(imports):
    """A text for each import that closes a cycle of modules."""
    graph = {}
    for one in imports:
        if one.imported not in BLENDERS:
            graph.setdefault(one.importer, {}).setdefault(one.imported, one.place)

    def way(begin, end):
        """Modules from begin to end along imports, or None."""
        before, waiting = {begin: None}, [begin]
        while waiting:
            module = waiting.pop()
            if module == end:
                passed = [module]
                while before[passed[-1]] is not None:
                    passed.append(before[passed[-1]])
                return passed[::-1]
            for further in graph.get(module, ()):
                if further not in before:
                    before[further] = module
                    waiting.append(further)
        return None

    for importer, imported in graph.items():
        for module, place in imported.items():
            back = way(module, importer)
            if back:
                yield f"{place}: a circle: {' -> '.join([importer, *back])}"


def needing_blender(imports, modules):
    """A text for each import with which loading one of the modules would load Blender's, itself or through others.
    Loading a module also loads the __init__ of its room."""
    on_load = {}
    for one in imports:
        if one.on_load:
            on_load.setdefault(one.importer, []).append(one)
    for module in modules:
        seen, waiting = set(), [module, room_of(module)]
        while waiting:
            importer = waiting.pop()
            if importer in seen:
                continue
            seen.add(importer)
            for one in on_load.get(importer, ()):
                if one.imported in BLENDERS:
                    yield f"{one.place}: imports {one.imported}, but {module} needs no Blender"
                else:
                    waiting += [one.imported, room_of(one.imported)]


# -- the add-on -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def addon_imports():
    return imports_of(ADDON)


def test_imports_run_one_way_between_rooms(addon_imports):
    assert list(upward(addon_imports, ROOMS)) == []


def test_no_module_imports_itself_through_others(addon_imports):
    assert list(circles(addon_imports)) == []


def test_what_needs_no_blender_does_not_load_it(addon_imports):
    assert list(needing_blender(addon_imports, WITHOUT_BLENDER)) == []


def test_every_module_is_in_a_room_and_every_name_in_the_lists_is_there():
    names = module_names(ADDON)
    assert {room_of(name) for name in names} == set(ROOMS)
    assert set(WITHOUT_BLENDER) <= names.keys()


def test_no_room_is_crowded():
    rooms = [room_of(name) for name in module_names(ADDON) if "." in name]
    assert {room: rooms.count(room) for room in rooms if rooms.count(room) > MAX_MODULES} == {}


def test_the_package_imports_nothing_of_its_own_and_nothing_of_blender_on_load(addon_imports):
    assert [one.place for one in addon_imports if one.importer == "__init__"] == []


def test_the_modules_without_blender_load_where_there_is_none():
    modules = [f"snowbough.{name}" for name in WITHOUT_BLENDER if name != "__init__"]
    program = "\n".join(
        [
            "import importlib, sys",
            f"sys.modules.update(dict.fromkeys({sorted(BLENDERS)!r}))",  # None: importing it fails
            *(f"importlib.import_module({name!r})" for name in modules),
        ]
    )
    environment = {**os.environ, "PYTHONPATH": str(ADDON.parent)}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# -- the checker ----------------------------------------------------------------------------------------


@pytest.fixture
def house(tmp_path):
    """Writes a package of files {path: text} and reads its imports."""

    def write(**files):
        package = tmp_path / "house"
        for name, text in {"__init__": "", **files}.items():
            path = package / (name.replace("__in__", "/") + ".py")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return imports_of(package)

    return write


def test_an_import_upwards_is_named_with_file_and_line(house):
    found = house(cellar__in__coal="x = 1\nfrom ..attic import trunk\n", attic__in__trunk="")
    assert list(upward(found, ("cellar", "attic"))) == [
        "cellar/coal.py:2: cellar imports attic.trunk, but attic is above cellar"
    ]
    assert list(upward(found, ("attic", "cellar"))) == []


@pytest.mark.parametrize(
    "text",
    [
        "from ..attic.trunk import lid",
        "from house.attic import trunk",
        "import house.attic.trunk",
        "def open():\n    from ..attic.trunk import lid",
        "class Lid:\n    from .. attic import trunk",
        "try:\n    from ..attic import trunk\nexcept ImportError:\n    pass",
    ],
)
def test_every_form_of_import_is_seen(house, text):
    found = house(cellar__in__coal=text, attic__in__trunk="lid = 1")
    (text,) = upward(found, ("cellar", "attic"))
    assert "imports attic.trunk" in text


def test_a_folder_outside_the_list_is_named(house):
    found = house(cellar__in__coal="from ..shed import rake", shed__in__rake="")
    assert list(upward(found, ("cellar",))) == ["cellar/coal.py:1: shed is no room in the list"]


def test_a_circle_within_a_room_is_named_with_file_and_line(house):
    found = house(
        cellar__in__a="from . import b",
        cellar__in__b="\nfrom .c import d",
        cellar__in__c="def d():\n    from . import a",
    )
    assert list(upward(found, ("cellar",))) == []
    assert sorted(circles(found)) == [
        "cellar/a.py:1: a circle: cellar.a -> cellar.b -> cellar.c -> cellar.a",
        "cellar/b.py:2: a circle: cellar.b -> cellar.c -> cellar.a -> cellar.b",
        "cellar/c.py:2: a circle: cellar.c -> cellar.a -> cellar.b -> cellar.c",
    ]


def test_blender_at_module_level_is_named_where_it_comes_in(house):
    found = house(
        cellar__in__plain="from . import other",
        cellar__in__other="import numpy\nimport bpy.props",
        cellar__in__late="def f():\n    import bpy",
        cellar__in__checking="if True:\n    from mathutils import Vector",
    )
    assert list(needing_blender(found, ["cellar.plain"])) == [
        "cellar/other.py:2: imports bpy, but cellar.plain needs no Blender"
    ]
    assert list(needing_blender(found, ["cellar.checking"])) == [
        "cellar/checking.py:2: imports mathutils, but cellar.checking needs no Blender"
    ]
    assert list(needing_blender(found, ["cellar.late"])) == []


def test_blender_in_the_init_of_a_room_counts_for_all_that_is_in_it(house):
    found = house(cellar__in____init__="import bpy", cellar__in__coal="")
    assert list(needing_blender(found, ["cellar.coal"])) == [
        "cellar/__init__.py:1: imports bpy, but cellar.coal needs no Blender"
    ]
