#!/usr/bin/env bash
# Runs tests/python on the packaged wheel for Windows, in the Windows build of CPython 3.11 under wine.
#
#   tools/test_windows.sh REPORT.xml [pytest arguments]
#
# Needs wine (apt-get install wine). It installs only into build/wine and build/third_party.
set -euo pipefail
report="$(realpath -m "$1")"
shift
cd "$(dirname "$0")/.."
python="$PWD/build/third_party/python/3.11/windows-x86_64/python.exe"
# Python's own site-packages, so that subprocesses of the tests find it too.
site="$(dirname "$python")/lib/site-packages"

if ! command -v wine >/dev/null; then
  echo "windows: skipped: there is no wine (apt-get install wine)"
  /usr/bin/python3 tools/skip_report.py "$report" "tests under wine" "there is no wine"
  exit 0
fi
[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/package.sh release windows
if ! [ -e "$site/.complete" ]; then
  /usr/bin/python3 -m pip --disable-pip-version-check install --quiet --target "$site" --only-binary :all: \
    --platform win_amd64 --python-version 3.11 --implementation cp numpy==1.26.4 pytest colorama
  touch "$site/.complete"
fi
rm -rf "$site"/snowbough_native*
/usr/bin/python3 -m zipfile -e build/packages/snowbough_native-*-win_amd64.whl "$site"

as_windows() {
  printf 'Z:%s' "${1//\//\\}"
}
export WINEPREFIX="$PWD/build/wine/prefix" WINEARCH=win64 WINEDEBUG=-all
# OpenGL on Windows needs a window, and a window needs a screen.
screen=()
if command -v xvfb-run >/dev/null; then
  screen=(xvfb-run -a)
fi
# Use a pipe, because programs in wine cannot write their output to a file. The other tests concern the checkout's
# tools.
PYTHONDONTWRITEBYTECODE=1 PYTHONUTF8=1 "${screen[@]}" wine "$python" -m pytest tests/python/native tests/python/addon -v -rfEs \
  -p no:cacheprovider -o junit_family=xunit2 --junitxml="$(as_windows "$report")" "$@" </dev/null | cat
