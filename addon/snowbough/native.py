# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads the native module ``snowbough_native``.

Looked for, in this order: the folder in the environment variable ``SNOWBOUGH_NATIVE``, the add-on's
own ``lib`` folder (an installed zip), and ``build/python`` of the checkout the add-on runs from.
It is loaded from its path, never through ``sys.path``, which extensions must leave alone.
"""

import importlib.machinery
import importlib.util
import os
import sys
from pathlib import Path

MODULE_NAME = "snowbough_native"
ENVIRONMENT_VARIABLE = "SNOWBOUGH_NATIVE"


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
    for folder in _folders():
        for suffix in importlib.machinery.EXTENSION_SUFFIXES:
            path = folder / (MODULE_NAME + suffix)
            if path.is_file():
                return path
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    raise NativeModuleMissing(
        f"Snowbough's native module for Python {version} was not found in "
        f"{', '.join(str(folder) for folder in _folders())}. "
        "Install the add-on's zip that was built for this Blender, or run ./tools/setup.sh in the checkout"
    )


def load():
    """Returns the module ``snowbough_native``, loading it on first use.

    Raises NativeModuleMissing with what to do when it cannot be loaded.
    """
    if MODULE_NAME in sys.modules:
        return sys.modules[MODULE_NAME]
    path = _module_file()
    spec = importlib.util.spec_from_file_location(MODULE_NAME, path)
    try:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError as error:
        raise NativeModuleMissing(
            f"{path} could not be loaded ({error}). Run ./tools/setup.sh to install what it needs and build it"
        ) from error
    sys.modules[MODULE_NAME] = module
    return module


def error_text(error):
    """The text for people on an exception: foreseen ones explain themselves."""
    foreseen = (RuntimeError, ValueError, OSError)
    return str(error) if isinstance(error, foreseen) and str(error) else f"{type(error).__name__}: {error}"
