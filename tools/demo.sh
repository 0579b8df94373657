#!/usr/bin/env bash
# Runs the whole demo: imports a tree from an OBJ file, rigs it, lets it sway, and bakes and renders a snowfall.
#
#   ./tools/demo.sh            with a maple grown by blend_samples/grow_tree.py
#   ./tools/demo.sh FILE.obj   with your own tree
#
# Writes to build/demo: snowbough.blend, the EXR sequences in snowbough_cache, five rendered frames, a close-up and the
# contact sheet snowbough.png. Runs tools/setup.sh first.
set -euo pipefail
tree="${1:+$(realpath "$1")}"
cd "$(dirname "$0")/.."

if [ -n "$tree" ] && [ ! -f "$tree" ]; then
  echo "demo: there is no file $tree" >&2
  exit 1
fi
started=$SECONDS
echo "demo: the first run also installs packages and compiles the native core; then come snow and renders, which take minutes"
tools/setup.sh module
unset PYTHONPATH PYTHONHOME
rm -rf build/demo
mkdir -p build/demo
if [ -z "$tree" ]; then
  tree="$PWD/build/demo/maple.obj"
  /usr/bin/python3 blend_samples/grow_tree.py --species maple --seed 1 "$tree"
fi

# Blender's output goes to a file; the demo's own lines are also printed at once.
/usr/bin/blender -b --factory-startup --python-exit-code 1 -P blend_samples/demo.py -- "$tree" build/demo \
  </dev/null 2>&1 | tee build/demo/blender.log |
  grep --line-buffered -E '^(demo|snowbough|Snowbough|Error|RuntimeError|Traceback)' || {
  echo "demo: Blender did not finish; the end of build/demo/blender.log:" >&2
  tail -n 30 build/demo/blender.log >&2
  exit 1
}
PYTHONPATH=build/python /usr/bin/python3 blend_samples/contact_sheet.py build/demo
echo "demo: done in $((SECONDS - started)) s; look at build/demo/snowbough.png"
