# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tests of this folder inside Blender, with the add-on installed from its zip as a user would.

    python3 tests/blender/run.py [--blender BLENDER | --bpy] [--zip ZIP] [--junitxml XML] [pytest arguments]
    blender -b --factory-startup --python-exit-code 1 -P tests/blender/run.py -- [the same arguments]

--blender  the Blender to start (default: `blender` on the PATH)
--bpy      use the module `bpy` of the Python that runs this file instead of a Blender program
--zip      the add-on's zip (default: made with tools/package.sh)

Three steps, each in its own process where a Blender program is used: a fresh user directory is made,
Blender starts with it and installs and enables the zip, pytest runs. The exit code is pytest's.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
USER_DIRECTORY = "SNOWBOUGH_TEST_USER_DIRECTORY"


def arguments():
    inside = USER_DIRECTORY in os.environ or "bpy" in sys.modules
    given = sys.argv[sys.argv.index("--") + 1 :] if inside and "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="run.py", description="Tests inside Blender.")
    parser.add_argument("--blender")
    parser.add_argument("--bpy", action="store_true")
    parser.add_argument("--zip", type=Path)
    parser.add_argument("--junitxml")
    options, rest = parser.parse_known_args(given)
    return options, rest


def user_environment(folder):
    """An environment in which Blender keeps all user files below `folder`."""
    environment = dict(os.environ)
    paths = "PYTHONPATH", "PYTHONHOME", "BLENDER_SYSTEM_SCRIPTS", "SNOWBOUGH_NATIVE"
    for name in (*paths, "PYTHONDONTWRITEBYTECODE"):
        environment.pop(name, None)
    environment[USER_DIRECTORY] = str(folder)
    # Half of the time in which Blender starts goes into compiling its own scripts, which only root could keep.
    environment["PYTHONPYCACHEPREFIX"] = str(folder / "pycache")
    environment["BLENDER_USER_RESOURCES"] = str(folder)
    for kind in ("CONFIG", "SCRIPTS", "DATAFILES", "EXTENSIONS"):
        part = folder / kind.lower()
        part.mkdir(parents=True, exist_ok=True)
        environment[f"BLENDER_USER_{kind}"] = str(part)
    return environment


def packaged(options):
    if options.zip:
        return options.zip.resolve()
    made = subprocess.run(
        [str(ROOT / "tools" / "package.sh")], check=True, stdout=subprocess.PIPE, text=True
    ).stdout.strip()
    return (ROOT / made).resolve()


def start_blender(blender, addon_zip, options, rest):
    """Starts Blender on this file in a fresh user directory; returns its exit code."""
    with tempfile.TemporaryDirectory(prefix="snowbough-user-") as folder:
        command = [
            blender,
            "-b",
            "--factory-startup",
            "--python-exit-code",
            "1",
            "-P",
            str(Path(__file__).resolve()),
        ]
        command += ["--", "--zip", str(addon_zip)]
        command += ["--junitxml", os.path.abspath(options.junitxml)] if options.junitxml else []
        return subprocess.run(command + rest, env=user_environment(Path(folder)), check=False).returncode


def install(addon_zip):
    """Installs and enables the zip; returns the add-on's package name."""
    import bpy

    if bpy.app.version >= (4, 2, 0):
        import addon_utils

        addon_utils.enable("bl_pkg", default_set=False)
        bpy.ops.extensions.package_install_files(
            filepath=str(addon_zip), repo="user_default", enable_on_install=True
        )
        name = "bl_ext.user_default.snowbough"
    else:
        bpy.ops.preferences.addon_install(filepath=str(addon_zip))
        bpy.ops.preferences.addon_enable(module="snowbough")
        name = "snowbough"
    if name not in bpy.context.preferences.addons:
        raise SystemExit(f"run.py: {addon_zip} was installed, but {name} is not enabled")
    return name


def run_pytest(options, rest):
    import pytest

    os.environ["SNOWBOUGH_TEST_ADDON"] = install(packaged(options))
    if not any(not argument.startswith("-") and Path(argument.split("::")[0]).exists() for argument in rest):
        rest = [str(HERE), *rest]
    settings = ["-p", "no:cacheprovider", "--rootdir", str(HERE), "-c", os.devnull, "-v", "-rfE"]
    if options.junitxml:
        settings += ["-o", "junit_family=xunit2", f"--junitxml={options.junitxml}"]
    return int(pytest.main(settings + rest))


def main():
    options, rest = arguments()
    if USER_DIRECTORY in os.environ:
        return run_pytest(options, rest)
    if options.bpy:
        with tempfile.TemporaryDirectory(prefix="snowbough-user-") as folder:
            command = [sys.executable, str(Path(__file__).resolve()), "--zip", str(packaged(options))]
            command += ["--junitxml", os.path.abspath(options.junitxml)] if options.junitxml else []
            return subprocess.run(command + rest, env=user_environment(Path(folder)), check=False).returncode
    if "bpy" in sys.modules:
        blender = sys.modules["bpy"].app.binary_path
    else:
        blender = options.blender or "blender"
    return start_blender(blender, packaged(options), options, rest)


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    if "bpy" in sys.modules and not sys.modules["bpy"].app.binary_path:
        # Blender as a module may crash or wait for ever in its own handler at exit: 4.2.23 and 4.5.15 do.
        os._exit(code)
    sys.exit(code)
