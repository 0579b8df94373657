#!/usr/bin/env bash
# Runs the fuzzers of tests/fuzz: each reader's under libFuzzer with the address and undefined-behaviour sanitizers, then
# the module's interface in child processes.
#
#   tools/fuzz.sh [MINUTES [NAME...]]     MINUTES for each fuzzer (default 1); NAME: obj, mtl, ..., module (default: all)
#
# Twice as many run at once as there are cores. Installs Debian's Clang if it is missing. Found inputs stay in
# build/fuzz/inputs. An input that fails is saved in build/fuzz/failed, and `build/fuzz/tests/fuzz/fuzz_NAME FILE` repeats
# it: add it to tests/fuzz/corpus/NAME with the fix. Prints a line per fuzzer; SNOWBOUGH_FUZZ_REPORT=FILE also writes them
# as JUnit. The exit status is 1 if any failed.
set -euo pipefail
cd "$(dirname "$0")/.."
minutes="${1:-1}"
[[ "$minutes" =~ ^[0-9]+(\.[0-9]+)?$ ]] || { sed -n '5s/^# *//p' "$0" >&2; exit 2; }
shift || true
seconds=$(/usr/bin/python3 -c "print(max(1, round(60 * $minutes)))")
all=(obj mtl checkpoint exr texel_table seams surface module)
[ $# -gt 0 ] || set -- "${all[@]}"

packages=(clang libclang-rt-14-dev)
if ! dpkg-query -W "${packages[@]}" >/dev/null 2>&1; then
  sudo=()
  [ "$(id -u)" -eq 0 ] || sudo=(sudo)
  echo "fuzz: to be installed with apt-get: ${packages[*]}"
  as_root_apt_get() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" </dev/null; }
  install=(install -y --no-install-recommends "${packages[@]}")
  as_root_apt_get "${install[@]}" || { as_root_apt_get update && as_root_apt_get "${install[@]}"; }
fi
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cmake --preset fuzz "${launcher[@]}" >/dev/null
cmake --build --preset fuzz

run_module() {
  PYTHONPATH=build/python /usr/bin/python3 tests/fuzz/fuzz_module.py --seconds "$seconds"
}

# The entropic schedule would take twice as long as the readers of meshes themselves.
run_reader() {
  mkdir -p "build/fuzz/inputs/$1" "build/fuzz/failed/$1"
  build/fuzz/tests/fuzz/fuzz_"$1" -max_total_time="$seconds" -max_len=1024 -timeout=10 -entropic=0 -rss_limit_mb=2048 \
    -malloc_limit_mb=512 -print_final_stats=1 -artifact_prefix="build/fuzz/failed/$1/" \
    "build/fuzz/inputs/$1" "tests/fuzz/corpus/$1"
}

# Runs a fuzzer and prints its line; its exit status goes to a file.
run_one() {
  local log="build/fuzz/$1.log" started=$SECONDS status=0 count took
  if [ "$1" = module ]; then run_module >"$log" 2>&1 || status=$?; else run_reader "$1" >"$log" 2>&1 || status=$?; fi
  count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  took=$((SECONDS - started))
  printf 'fuzz: %-12s %9s executions %7s per second  %s\n' "$1" "${count:-0}" \
    "$((${count:-0} / (took > 0 ? took : 1)))" "$([ $status -eq 0 ] && echo 'nothing found' || echo "FAILED, see $log")"
  echo $status >"build/fuzz/$1.exit"
}

# Two on each core: a minute by the clock, since other tests run beside.
for name in "$@"; do
  rm -f "build/fuzz/$name.exit"
  while [ "$(jobs -rp | wc -l)" -ge $((2 * $(nproc))) ]; do wait -n || true; done
  run_one "$name" &
done
wait

failed=0
cases=
for name in "$@"; do
  status=$(cat "build/fuzz/$name.exit" 2>/dev/null || echo 1)
  if [ "$status" -ne 0 ]; then failed=1; fi
  cases+="<testcase classname=\"fuzz\" name=\"$name\">"
  cases+="$([ "$status" -eq 0 ] || echo "<failure message=\"see build/fuzz/$name.log\"/>")</testcase>"
done
if [ -n "${SNOWBOUGH_FUZZ_REPORT:-}" ]; then
  echo "<testsuite name=\"fuzz\">$cases</testsuite>" >"$SNOWBOUGH_FUZZ_REPORT"
fi
exit $failed
