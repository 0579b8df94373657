# SPDX-License-Identifier: GPL-3.0-or-later
"""The entry point of the kit of tools/gpu_kit.sh on the measured machine: unpacks the kit, checks that the module
loads, prints the tables (benchmarks/realtime/tables.py), and names the libraries of the kit and of the machine.
"""

import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

KIT = Path(sys.argv[0]).resolve()
LIBRARIES = Path("build/python/snowbough_native.libs")
LOADED = """
import snowbough_native
snowbough_native.Engine("GL")
import numpy.linalg
print(*sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}), sep="\\n")
"""


def unpack(folder):
    with zipfile.ZipFile(KIT) as archive:
        for entry in archive.infolist():
            path = Path(archive.extract(entry, folder))
            path.chmod(entry.external_attr >> 16)
    return folder


def check_python(folder):
    """Exits with a remedy if this Python cannot load the module."""
    module = (folder / "module.txt").read_text().strip()
    version = re.search(r"cpython-(\d)(\d+)", module)
    wanted = (int(version[1]), int(version[2]))
    if sys.version_info[:2] != wanted or sys.implementation.name != "cpython":
        sys.exit(
            f"The kit holds the module for CPython {wanted[0]}.{wanted[1]}, and this is "
            f"{sys.implementation.name} {sys.version_info[0]}.{sys.version_info[1]}: "
            f"run it with python{wanted[0]}.{wanted[1]}"
        )


def python(environment, *arguments, **how):
    return subprocess.run([sys.executable, *arguments], env=environment, text=True, **how)


def working_environment(folder):
    """The environment in which the module loads: with the machine's own C++ runtime, otherwise with the kit's. Exits
    with the reason if it loads with neither."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    plain["PYTHONPATH"] = str(folder / "build" / "python")
    plain["PYTHONNOUSERSITE"] = "1"
    own = ":".join(filter(None, [str(folder / LIBRARIES / "runtime"), plain.get("LD_LIBRARY_PATH", "")]))
    for environment in (plain, {**plain, "LD_LIBRARY_PATH": own}):
        tried = python(environment, "-c", "import numpy, snowbough_native", capture_output=True)
        if tried.returncode == 0:
            return environment
    sys.exit(f"The module does not load here: {tried.stderr.strip().splitlines()[-1]}")


def provenance(folder, environment):
    """Markdown about the libraries in use."""
    done = python(environment, "-c", LOADED, capture_output=True)
    if done.returncode:
        return f"OpenGL does not start: {done.stderr.strip().splitlines()[-1]}"
    paths = [Path(line) for line in done.stdout.splitlines()]
    own = [path for path in paths if folder in path.parents]
    names = [sorted({path.name for path in part}) for part in (own, set(paths) - set(own))]
    return "\n".join(
        f"- {title}: {', '.join(part)}" for title, part in zip(("the kit's", "the machine's"), names)
    )


def tables(folder, arguments):
    check_python(folder)
    environment = working_environment(folder)
    done = python(environment, str(folder / "benchmarks" / "realtime" / "tables.py"), *arguments)
    if "--help" not in arguments and done.returncode in (0, 1):
        print(f"\n## Libraries\n\n{provenance(folder, environment)}")
    return done.returncode


def main():
    arguments = sys.argv[1:]
    if "--keep" in arguments:
        at = arguments.index("--keep")
        folder = Path(arguments[at + 1] if len(arguments) > at + 1 else "snowbough-gpu-kit").resolve()
        return tables(unpack(folder), arguments[:at] + arguments[at + 2 :])
    with tempfile.TemporaryDirectory(prefix="snowbough-kit-") as name:
        return tables(unpack(Path(name).resolve()), arguments)


if __name__ == "__main__":
    sys.exit(main())
