# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that one module of the add-on takes from another are there. ruff finds undefined names within a file (F821);
this finds those that a moved or split file lost, which otherwise fail only when Blender runs the line."""

import ast

import pytest
from test_addon_rooms import ADDON, module_names


def lost_names(package):
    """`file:line: module.name` of each name that is imported, or read from an imported module, and is not there."""
    names = module_names(package)
    trees = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in names.items()}
    defined = {name: _top_level(tree) for name, tree in trees.items()}
    for name in names:
        room, _, module = name.rpartition(".")
        defined.setdefault(room, set()).add(module)
    for module, tree in trees.items():
        path = names[module].relative_to(package)
        yield from (f"{path.as_posix()}:{lost}" for lost in _lost_in(tree, path.parent.parts, names, defined))


def _top_level(tree):
    """Names that a module binds outside functions and classes."""
    bound, waiting = set(), list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            bound.add(node.name)
            continue
        if isinstance(node, ast.alias):
            bound.add((node.asname or node.name).partition(".")[0])
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            bound.add(node.id)
        waiting += ast.iter_child_nodes(node)
    return bound


def _lost_in(tree, folder, names, defined):
    modules = {}  # as called here -> name within the package
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom) or node.level == 0:
            continue
        parts = [*folder[: len(folder) - (node.level - 1)], *(node.module or "").split(".")]
        source = ".".join(part for part in parts if part)
        for alias in node.names:
            inner = f"{source}.{alias.name}".lstrip(".")
            if inner in names:
                modules[alias.asname or alias.name] = inner
            elif alias.name not in defined.get(source, ()) and source:
                yield f"{node.lineno}: {inner}"
    bound_elsewhere = {arg.arg for arg in ast.walk(tree) if isinstance(arg, ast.arg)} | {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = modules.get(node.value.id)
            if module and node.value.id not in bound_elsewhere and node.attr not in defined[module]:
                yield f"{node.lineno}: {module}.{node.attr}"


def test_every_name_that_a_module_takes_from_another_is_there():
    assert list(lost_names(ADDON)) == []


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        ("from .coal import lump", "1: cellar.coal.lump"),
        ("from . import coke", "1: cellar.coke"),
        ("def f():\n    from ..attic.trunk import lid", "2: attic.trunk.lid"),
        ("from . import coal\n\nprint(coal.lump)", "3: cellar.coal.lump"),
        ("from . import coal as fuel\nfuel.burn()", "2: cellar.coal.burn"),
    ],
)
def test_a_lost_name_is_named_with_file_and_line(tmp_path, text, lost):
    cellar = tmp_path / "house" / "cellar"
    cellar.mkdir(parents=True)
    (cellar / "__init__.py").touch()
    (cellar / "coal.py").write_text("from os import path\nsack = 1\n\ndef shovel():\n    lump = 2\n")
    (cellar / "fine.py").write_text(
        "from . import coal\nfrom .coal import path, sack\ncoal.shovel(coal.sack)\n"
    )
    (cellar / "stoker.py").write_text(text)
    assert list(lost_names(tmp_path / "house")) == [f"cellar/stoker.py:{lost}"]
