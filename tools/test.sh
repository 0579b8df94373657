#!/usr/bin/env bash
# Runs tools/setup.sh, then the tests.
#
#   ./tools/test.sh                        all layers
#   ./tools/test.sh native|python|blender|ui|fuzz [...]   only these
#   ./tools/test.sh faults                 kills, full disks, damaged files, long bakes (about half an hour); not among
#                                          "all layers"
#   ./tools/test.sh benchmarks             every benchmark of the manual in its smallest form; not among "all layers"
#   ./tools/test.sh --blender 4.3|5.2      tests/blender in Debian trixie's or sid's Blender (made under build/)
#   ./tools/test.sh --blender bpy[=VERSION]   tests/blender in PyPI's official bpy; with a version, on the package
#   ./tools/test.sh --platform windows[=VERSION]   tests/python on the wheel for Windows, under wine, in Python 3.11
#   ./tools/test.sh --platform windows[=VERSION] blender   tests/blender in PyPI's bpy 4.5.15 for Windows, under wine
#
# build/tests/times.txt has the time of each layer and test. The last lines name the slowest tests and the reasons for
# skips, and count: `N passed, N failed, N skipped`; the exit code is 0 only if nothing failed. SNOWBOUGH_SETUP=0 skips
# tools/setup.sh.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
# Absolute: the layers run in different folders.
results="$PWD/build/tests"

usage() {
  sed -n '2,16s/^# \{0,1\}//p' "$0"
}

all=(native python blender ui fuzz)
layers=()
blender=
platform=
while [ $# -gt 0 ]; do
  case "$1" in
    native | python | blender | ui | faults | fuzz | benchmarks) layers+=("$1") ;;
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
  '') [ ${#layers[@]} -gt 0 ] || layers=("${all[@]}") ;;
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
  windows | windows=[0-9]*)
    [ "${layers[*]}" != "${all[*]}" ] || layers=(python)
    if [ -n "$blender" ] || { [ "${layers[*]}" != python ] && [ "${layers[*]}" != blender ]; }; then
      echo "test: --platform windows runs the layer python or the layer blender" >&2
      exit 2
    fi
    ;;
  *)
    echo "test: --platform takes windows[=VERSION], not '$platform'" >&2
    exit 2
    ;;
esac

# The tests must not depend on the caller's Python settings. They start many Pythons, which compile each module once.
unset PYTHONPATH PYTHONHOME PYTHONDONTWRITEBYTECODE
export PYTHONUNBUFFERED=1 PYTHONPYCACHEPREFIX="$PWD/build/pycache"

run_native() {
  ctest --test-dir build/release --output-on-failure --no-tests=error --timeout 120 \
    -j "$(nproc)" --output-junit "$results/native.xml"
}

run_python() {
  if [ -n "$platform" ]; then
    tools/test_windows.sh python "$results/python.xml" "=${platform#windows}"
    return
  fi
  PYTHONPATH=build/python /usr/bin/python3 -m pytest tests/python -v -rfE \
    -o junit_family=xunit2 --junitxml="$results/python.xml"
}

# The tests inside Blender take two layers, each with every other file, so that both cores have work to the end.
half_of_blender() {
  local layer=$1 first=$2 files=(tests/blender/test_*.py) own=() i
  for ((i = first; i < ${#files[@]}; i += 2)); do own+=("${files[i]}"); done
  /usr/bin/python3 tests/blender/run.py --blender /usr/bin/blender --zip "$SNOWBOUGH_TEST_ZIP" \
    --junitxml "$results/$layer.xml" "${own[@]}"
}

run_blender_2() {
  half_of_blender blender_2 1
}

run_blender() {
  if [ -n "$platform" ]; then
    tools/test_windows.sh blender "$results/blender.xml" "=${platform#windows}"
    return
  fi
  case "$blender" in
    4.3 | 5.2) tools/blender_debian.sh "$blender" "$results/blender.xml" ;;
    bpy*) tools/blender_bpy.sh "$results/blender.xml" "${blender#bpy}" ;;
    *) half_of_blender blender 0 ;;
  esac
}

run_faults() {
  PYTHONPATH=build/python /usr/bin/python3 -m pytest tests/faults -v -rfE -s \
    -o junit_family=xunit2 --junitxml="$results/faults.xml"
}

run_fuzz() {
  SNOWBOUGH_FUZZ_REPORT="$results/fuzz.xml" nice -n 19 tools/fuzz.sh 1
}

run_benchmarks() {
  /usr/bin/python3 -m pytest tests/benchmarks -v -rfE -o junit_family=xunit2 --junitxml="$results/benchmarks.xml"
}

run_ui() {
  /usr/bin/python3 -m pytest tests/ui -v -rfE -o junit_family=xunit2 --junitxml="$results/ui.xml"
}

rm -rf "$results"
mkdir -p "$results"
if [ "${SNOWBOUGH_SETUP:-1}" != 0 ]; then
  tools/setup.sh || exit 1
fi

# Runs a layer; its exit status and its time in seconds go to files. Beside tests/ui, all others step back: its bakes have
# the low priority that the add-on gives them, and would come to nothing.
run_layer() {
  local layer=$1 started=$SECONDS
  [[ "$layer" != ui && " ${beside[*]} " == *" ui "* ]] && renice -n 10 -p $BASHPID >/dev/null
  echo
  echo "== $layer =="
  "run_$layer" </dev/null
  echo $? >"$results/$layer.exit"
  echo $((SECONDS - started)) >"$results/$layer.seconds"
  echo "== $layer: $((SECONDS - started)) s =="
}

if [ -z "$blender$platform" ]; then
  SNOWBOUGH_TEST_ZIP="$PWD/$(tools/package.sh)" || exit 1
  [[ " ${layers[*]} " != *" blender "* ]] || layers+=(blender_2)
fi
export SNOWBOUGH_TEST_ZIP

# The native tests use all cores. Of the other layers each uses about one, and tests/ui mostly waits for its window: they
# run side by side, and the fuzzers in what all others leave. The outputs of those in the background come last.
beside=()
for layer in fuzz native ui blender blender_2 python faults benchmarks; do
  case " ${layers[*]} " in *" $layer "*) ;; *) continue ;; esac
  if [[ ${#layers[@]} -gt 1 && $layer =~ ^(blender|blender_2|fuzz|ui)$ ]]; then
    run_layer "$layer" >"$results/$layer.log" 2>&1 &
    beside+=("$layer")
  else
    run_layer "$layer"
  fi
done
wait
for layer in "${beside[@]}"; do
  cat "$results/$layer.log"
done

echo
/usr/bin/python3 tools/test_summary.py "$results" "${layers[@]}"
