# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads the native module ``snowbough_native``.

Looked for, in this order: the folder in the environment variable ``SNOWBOUGH_NATIVE``, the add-on's
own ``lib`` folder (a zip for Blender before 4.2), ``build/python`` of the checkout the add-on runs from,
and the wheel that Blender installs with an extension. From a folder it is loaded by its path; the wheel is
imported like any other. ``sys.path`` is left alone, as extensions must.
"""

import importlib
import importlib.machinery
import importlib.util
import os
import platform
import sys
from pathlib import Path

MODULE_NAME = "snowbough_native"
ENVIRONMENT_VARIABLE = "SNOWBOUGH_NATIVE"

# The Pythons that packages hold a module for.
PACKAGED_PYTHONS = ("3.10", "3.11", "3.13", "3.14")

_problem = None


class NativeModuleMissing(RuntimeError):
    """The native module is not there or was built for another Python."""


def _folders():
    package = Path(__file__).resolve().parent
    named = os.environ.get(ENVIRONMENT_VARIABLE)
    if named:
        yield Path(named)
    yield package / "lib"
    yield package.parent.parent / "build" / "python"


def _module_file():
    """The module in one of the folders: ``snowbough_native`` as the checkout builds it, or with its version in the
    name as packages hold it. None where none is."""
    for folder in _folders():
        for suffix in importlib.machinery.EXTENSION_SUFFIXES:
            found = sorted(folder.glob(f"{MODULE_NAME}*{suffix}"))
            # Where the suffix is merely .so, modules of other Pythons end with it, too.
            found = [path for path in found if "." not in path.name.removesuffix(suffix)]
            if found:
                return found[-1]
    return None


def _machine():
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    return f"Python {version} on {platform.system()} {platform.machine()}", version


def _load_file(path):
    spec = importlib.util.spec_from_file_location(path.name.partition(".")[0], path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[MODULE_NAME] = module
    return module


def _missing():
    machine, version = _machine()
    if version not in PACKAGED_PYTHONS:
        return (
            f"This Blender has {machine}, for which Snowbough has no module. Use another version of Blender"
        )
    return (
        f"Snowbough's module for {machine} is not installed. Install the add-on's zip for this system, "
        "or run ./tools/setup.sh in the checkout"
    )


def load():
    """Returns the module ``snowbough_native``, loading it on first use.

    Raises NativeModuleMissing with what to do when it cannot be loaded.
    """
    if MODULE_NAME in sys.modules:
        return sys.modules[MODULE_NAME]
    path = _module_file()
    try:
        return _load_file(path) if path else importlib.import_module(MODULE_NAME)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith(MODULE_NAME):
            raise NativeModuleMissing(_missing()) from error
        raise NativeModuleMissing(f"Snowbough needs the Python module {error.name}: install it") from error
    except ImportError as error:
        raise NativeModuleMissing(
            f"Snowbough's module does not load: {error}. docs/install.md of Snowbough says what helps"
        ) from error


def problem():
    """Why the module cannot be had, in one line for a panel; empty where it can. Tried once a session."""
    global _problem
    if _problem is None:
        try:
            load()
            _problem = ""
        except NativeModuleMissing as error:
            _problem = str(error)
    return _problem


def error_text(error):
    """The text for people on an exception: foreseen ones explain themselves."""
    foreseen = (RuntimeError, ValueError, OSError)
    return str(error) if isinstance(error, foreseen) and str(error) else f"{type(error).__name__}: {error}"
