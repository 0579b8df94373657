#!/usr/bin/env bash
# Runs tools/setup.sh, then the tests.
#
#   ./tools/test.sh                        all layers
#   ./tools/test.sh native|python|blender|ui [...]   only these
#   ./tools/test.sh fuzz                   a minute of each fuzzer (tools/fuzz.sh); not among "all layers"
#   ./tools/test.sh --blender 4.3|5.2      tests/blender in Debian trixie's or sid's Blender (made under build/)
#   ./tools/test.sh --blender bpy[=VERSION]   tests/blender in PyPI's official bpy; with a version, on the package
#   ./tools/test.sh --platform windows     tests/python on the wheel for Windows, under wine
#
# The last lines give the reasons for skips and `N passed, N failed, N skipped`; the exit code is 0 only if nothing
# failed. SNOWBOUGH_SETUP=0 skips tools/setup.sh.
set -uo pipefail
cd "$(dirname "$0")/.."
# Absolute: the layers run in different folders.
results="$PWD/build/tests"

usage() {
  sed -n '2,12s/^# \{0,1\}//p' "$0"
}

layers=()
blender=
platform=
while [ $# -gt 0 ]; do
  case "$1" in
    native | python | blender | ui | fuzz) layers+=("$1") ;;
    --blender)
      blender="${2:-}"
      shift
      ;;
    --platform)
      platform="${2:-}"
      shift
      ;;
    -h | --help)
      usage
      exit 0
      ;;
    *)
      echo "test: unknown argument '$1'" >&2
      usage >&2
      exit 2
      ;;
  esac
  shift
done
case "$blender" in
  '') [ ${#layers[@]} -gt 0 ] || layers=(native python blender ui) ;;
  4.3 | 5.2 | bpy | bpy=[0-9]*)
    if [ "${layers[*]:-blender}" != blender ]; then
      echo "test: --blender $blender runs the layer blender only" >&2
      exit 2
    fi
    layers=(blender)
    ;;
  *)
    echo "test: --blender takes 4.3 (Debian trixie), 5.2 (Debian sid) or bpy[=VERSION] (PyPI), not '$blender'" >&2
    exit 2
    ;;
esac
case "$platform" in
  '') ;;
  windows)
    if [ -n "$blender" ] || { [ "${layers[*]}" != "native python blender ui" ] && [ "${layers[*]}" != python ]; }; then
      echo "test: --platform windows runs the layer python only" >&2
      exit 2
    fi
    layers=(python)
    ;;
  *)
    echo "test: --platform takes windows, not '$platform'" >&2
    exit 2
    ;;
esac

# The tests must not depend on the caller's Python settings.
unset PYTHONPATH PYTHONHOME
export PYTHONUNBUFFERED=1

run_native() {
  ctest --test-dir build/release --output-on-failure --no-tests=error --timeout 120 \
    -j "$(nproc)" --output-junit "$results/native.xml"
}

run_python() {
  if [ "$platform" = windows ]; then
    tools/test_windows.sh "$results/python.xml"
    return
  fi
  PYTHONPATH=build/python /usr/bin/python3 -m pytest tests/python -v -rfE \
    -o junit_family=xunit2 --junitxml="$results/python.xml"
}

run_blender() {
  case "$blender" in
    4.3 | 5.2) tools/blender_debian.sh "$blender" "$results/blender.xml" ;;
    bpy*) tools/blender_bpy.sh "$results/blender.xml" "${blender#bpy}" ;;
    *) /usr/bin/python3 tests/blender/run.py --blender /usr/bin/blender --junitxml "$results/blender.xml" ;;
  esac
}

run_fuzz() {
  SNOWBOUGH_FUZZ_REPORT="$results/fuzz.xml" tools/fuzz.sh 1
}

run_ui() {
  /usr/bin/python3 -m pytest tests/ui -v -rfE -o junit_family=xunit2 --junitxml="$results/ui.xml"
}

rm -rf "$results"
mkdir -p "$results"
if [ "${SNOWBOUGH_SETUP:-1}" != 0 ]; then
  tools/setup.sh || exit 1
fi

for layer in "${layers[@]}"; do
  echo
  echo "== $layer =="
  started=$SECONDS
  "run_$layer" </dev/null
  echo $? >"$results/$layer.exit"
  echo "== $layer: $((SECONDS - started)) s =="
done

echo
/usr/bin/python3 tools/test_summary.py "$results" "${layers[@]}"
