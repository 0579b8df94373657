#!/usr/bin/env bash
# Builds a sample scene, bakes its snow and renders its picture.
#
#   ./tools/sample.sh NAME [ARGUMENTS]     a script of blend_samples/scenes: bench, bunny, monkey, ball, cart, maple,
#                                          broad_leaf, spruce, laden, wind, flag, street, tracks, shedding,
#                                          thaw, drifts, sand, dust, bough
#
# Writes to build/samples/NAME: the .blend, the cache, and the picture. ARGUMENTS are those of the script. Takes one to
# five minutes. tools/demo.sh and tools/windy_shot.sh are the full shots.
set -euo pipefail
cd "$(dirname "$0")/.."
name="${1:-}"
if [ ! -f "blend_samples/scenes/$name.py" ]; then
  echo "sample: name one of: $(cd blend_samples/scenes && ls ./*.py | sed 's|^./||; s|.py$||' | xargs)" >&2
  exit 2
fi
shift
folder="build/samples/$name"
[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/setup.sh module
unset PYTHONPATH PYTHONHOME
rm -rf "$folder"
mkdir -p "$folder"
/usr/bin/blender -b --factory-startup --python-exit-code 1 -P blend_samples/sample.py -- "$name" "$folder" "$@" \
  </dev/null >"$folder/blender.log" 2>&1 || {
  echo "sample: Blender did not finish; the end of $folder/blender.log:" >&2
  tail -n 30 "$folder/blender.log" >&2
  exit 1
}
grep '^sample:' "$folder/blender.log"
