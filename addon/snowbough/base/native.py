# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads the native module ``snowbough_native``.

The search order is: the folder in the environment variable ``SNOWBOUGH_NATIVE``, the add-on's own ``lib`` folder (in
the zip for Blender before 4.2), ``build/python`` of the checkout that the add-on runs from, and the wheel that Blender
installs with an extension. A module in a folder is loaded by its path; the wheel is imported normally. ``sys.path`` is
not changed, because Blender forbids that for extensions.
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

# Python versions for which the packages contain a module.
PACKAGED_PYTHONS = ("3.10", "3.11", "3.13", "3.14")

_problem = None


class NativeModuleMissing(RuntimeError):
    """The native module is missing or was built for another Python version."""


def _folders():
    package = Path(__file__).resolve().parent.parent
    named = os.environ.get(ENVIRONMENT_VARIABLE)
    if named:
        yield Path(named)
    yield package / "lib"
    yield package.parent.parent / "build" / "python"


def module_file():
    """Path of the module in the first folder that contains one, or None. Its name is ``snowbough_native`` in a
    checkout, and also contains the version in packages."""
    for folder in _folders():
        for suffix in importlib.machinery.EXTENSION_SUFFIXES:
            found = sorted(folder.glob(f"{MODULE_NAME}*{suffix}"))
            # The suffix .so also matches modules for other Python versions, such as x.cpython-313.so.
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
    """Returns the module ``snowbough_native`` and loads it on first use.

    Raises NativeModuleMissing if it cannot be loaded. The message says what to do.
    """
    if MODULE_NAME in sys.modules:
        return sys.modules[MODULE_NAME]
    path = module_file()
    try:
        return _load_file(path) if path else importlib.import_module(MODULE_NAME)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith(MODULE_NAME):
            raise NativeModuleMissing(_missing()) from error
        raise NativeModuleMissing(f"Snowbough needs the Python module {error.name}: install it") from error
    except ImportError as error:
        raise NativeModuleMissing(
            f"Snowbough's module does not load: {error}. See Snowbough's docs/install.md for remedies"
        ) from error


def problem():
    """The reason why the module cannot be loaded, as one line for a panel; empty if it can. Tried once per session."""
    global _problem
    if _problem is None:
        try:
            load()
            _problem = ""
        except NativeModuleMissing as error:
            _problem = str(error)
    return _problem


def error_text(error):
    """The message of an exception for users. For unexpected types it begins with the name of the type."""
    foreseen = (RuntimeError, ValueError, OSError)
    return str(error) if isinstance(error, foreseen) and str(error) else f"{type(error).__name__}: {error}"
