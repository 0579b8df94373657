#!/usr/bin/env bash
# Runs tests/blender in the official build of Blender as a Python module: PyPI's `bpy`.
#
#   tools/blender_bpy.sh REPORT.xml [=VERSION] [pytest arguments]
#
# Installs it into the virtual environment build/blender-bpy-<version> (kept, about 1 GB). With a version, the add-on is
# the release package (tools/package.sh release linux), otherwise the package of build/python. The Python is this
# machine's, and for bpy 5.1 and later the Python 3.13 of tools/third_party.sh. If PyPI has no bpy for this Python
# version, the report contains a skip.
set -euo pipefail
report="$(realpath -m "$1")"
shift
cd "$(dirname "$0")/.."
version=
case "${1-tests}" in
  '' | =*)
    version="${1#=}"
    shift
    ;;
esac
venv="build/blender-bpy${version:+-$version}"
python="$venv/bin/python"
base=/usr/bin/python3
case "$version" in
  5.[1-9]* | [6-9].*) base="$PWD/build/third_party/python/3.13/linux-x86_64/python3.13" ;;
esac

skip() {
  echo "bpy: skipped: $1"
  /usr/bin/python3 tools/skip_report.py "$report" "bpy${version:+ $version} from PyPI" "$1"
  exit 0
}

if ! [ -x "$python" ] || ! "$python" -c "import bpy, pytest" 2>/dev/null; then
  rm -rf "$venv"
  [ -x "$base" ] || tools/third_party.sh linux
  "$base" -m venv "$venv" || skip "no virtual environment could be made (package python3-venv)"
  echo "bpy: fetching bpy${version:+ $version} from PyPI (about 400 MB)"
  "$python" -m pip install --quiet --only-binary :all: "bpy${version:+==$version}" pytest ||
    skip "PyPI has no bpy${version:+ $version} for $("$base" --version) on this machine"
  "$python" -c "import bpy" || skip "PyPI's bpy does not load on this machine"
fi
echo "bpy: Blender $("$python" -c "import bpy; print(bpy.app.version_string)" | tail -n 1)"
if [ -n "$version" ]; then
  [ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/package.sh release linux
  zip=$(ls build/packages/repository/*linux_x64.zip)
else
  zip=$(tools/package.sh)
fi
"$python" tests/blender/run.py --bpy --zip "$zip" --junitxml "$report" "$@"
