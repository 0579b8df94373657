#!/usr/bin/env bash
# Runs tests/python on the packaged wheel for Windows, in the Windows build of CPython 3.11 under wine.
#
#   tools/test_windows.sh REPORT.xml [pytest arguments]
#
# Needs wine (apt-get install wine). All it installs lies in build/wine.
set -euo pipefail
report="$(realpath -m "$1")"
shift
cd "$(dirname "$0")/.."
python="$PWD/build/third_party/python/3.11/windows-x86_64/python.exe"
site="$PWD/build/wine/site"

if ! command -v wine >/dev/null; then
  echo "windows: skipped: there is no wine (apt-get install wine)"
  /usr/bin/python3 tools/skip_report.py "$report" "tests under wine" "there is no wine"
  exit 0
fi
[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/package.sh release windows
if ! [ -e "$site/.complete" ]; then
  rm -rf "$site"
  /usr/bin/python3 -m pip --disable-pip-version-check install --quiet --target "$site" --only-binary :all: \
    --platform win_amd64 --python-version 3.11 --implementation cp numpy==1.26.4 pytest colorama
  touch "$site/.complete"
fi
rm -rf build/wine/wheel
/usr/bin/python3 -m zipfile -e build/packages/snowbough_native-*-win_amd64.whl build/wine/wheel

as_windows() {
  printf 'Z:%s' "${1//\//\\}"
}
export WINEPREFIX="$PWD/build/wine/prefix" WINEARCH=win64 WINEDEBUG=-all
PYTHONPATH="$(as_windows "$PWD/build/wine/wheel");$(as_windows "$site")" PYTHONDONTWRITEBYTECODE=1 PYTHONUTF8=1 \
  exec wine "$python" -m pytest tests/python -v -rfEs -p no:cacheprovider -o junit_family=xunit2 \
  --junitxml="$(as_windows "$report")" "$@"
