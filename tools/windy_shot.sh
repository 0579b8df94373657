#!/usr/bin/env bash
# Renders an animated shot as a contact sheet: a swaying maple, a moving cart and a flapping flag in snow with turning
# wind.
#
#   ./tools/windy_shot.sh [RESOLUTION]      resolution of the maps (default: 512)
#
# Writes to build/windy: shot.blend, its cache, eight rendered frames and sheet.png. Takes a few minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/setup.sh module
unset PYTHONPATH PYTHONHOME
rm -rf build/windy
mkdir -p build/windy
/usr/bin/python3 blend_samples/grow_tree.py --species maple --seed 1 build/windy/maple.obj
/usr/bin/blender -b --factory-startup --python-exit-code 1 -P blend_samples/windy_shot.py -- \
  build/windy/maple.obj build/windy "${1:-512}" </dev/null >build/windy/blender.log 2>&1 || {
  echo "windy_shot: Blender did not finish; the end of build/windy/blender.log:" >&2
  tail -n 30 build/windy/blender.log >&2
  exit 1
}
PYTHONPATH=build/python /usr/bin/python3 blend_samples/windy_sheet.py build/windy
