#!/usr/bin/env bash
# Runs tests/blender in the official build of Blender as a Python module, PyPI's `bpy` for this Python.
#
#   tools/blender_bpy.sh REPORT.xml [pytest arguments]
#
# Installs it into the virtual environment build/blender-bpy (kept, about 1 GB). If PyPI has none for this Python, the
# report contains a skip.
set -euo pipefail
report="$(realpath -m "$1")"
shift
cd "$(dirname "$0")/.."
python=build/blender-bpy/bin/python

skip() {
  echo "bpy: skipped: $1"
  /usr/bin/python3 tools/skip_report.py "$report" "bpy from PyPI" "$1"
  exit 0
}

if ! [ -x "$python" ] || ! "$python" -c "import bpy, pytest" 2>/dev/null; then
  rm -rf build/blender-bpy
  /usr/bin/python3 -m venv build/blender-bpy || skip "no virtual environment could be made (package python3-venv)"
  echo "bpy: fetching bpy from PyPI (about 400 MB)"
  "$python" -m pip install --quiet --only-binary :all: bpy pytest ||
    skip "PyPI has no bpy for $(/usr/bin/python3 --version) on this machine"
  "$python" -c "import bpy" || skip "PyPI's bpy does not load on this machine"
fi
echo "bpy: Blender $("$python" -c "import bpy; print(bpy.app.version_string)" | tail -n 1)"
zip=$(tools/package.sh)
"$python" tests/blender/run.py --bpy --zip "$zip" --junitxml "$report" "$@"
