#!/usr/bin/env bash
# Runs tests on the packages for Windows, under wine.
#
#   tools/test_windows.sh python REPORT.xml [=VERSION] [pytest arguments]
#       tests/python on the wheel, in the Windows build of CPython 3.11 or of another VERSION, such as 3.13
#   tools/test_windows.sh blender REPORT.xml [=VERSION] [pytest arguments]
#       tests/blender on the extension, in PyPI's bpy 4.5.15 for Windows or in another VERSION for Python 3.11
#
# Needs wine (apt-get install wine). It installs only into build/wine and build/third_party.
set -euo pipefail
layer="$1"
report="$(realpath -m "$2")"
shift 2
cd "$(dirname "$0")/.."
version=
case "${1-}" in
  =*)
    version="${1##*=}"
    shift
    ;;
esac
case "$layer" in
  python)
    version="${version:-3.11}"
    python_version="$version"
    modules=(pytest colorama pillow)
    ;;
  blender)
    python_version=3.11
    version="${version:-4.5.15}"
    modules=("bpy==$version" pytest colorama)
    ;;
  *)
    sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
# NumPy of the Blenders with this Python.
case "$python_version" in
  3.11) modules+=(numpy==1.26.4) ;;
  *) modules+=(numpy==2.1.3) ;;
esac

if ! command -v wine >/dev/null; then
  echo "windows: skipped: there is no wine (apt-get install wine)"
  /usr/bin/python3 tools/skip_report.py "$report" "tests under wine" "there is no wine"
  exit 0
fi
[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/package.sh release windows
python="$PWD/build/third_party/python/$python_version/windows-x86_64/python.exe"
site="$PWD/build/wine/$layer-$version"
if ! [ -e "$site/.complete" ]; then
  rm -rf "$site"
  /usr/bin/python3 -m pip --disable-pip-version-check install --quiet --target "$site" --only-binary :all: \
    --platform win_amd64 --python-version "$python_version" --implementation cp "${modules[@]}"
  touch "$site/.complete"
fi

as_windows() {
  printf 'Z:%s' "${1//\//\\}"
}
export WINEPREFIX="$PWD/build/wine/prefix" WINEARCH=win64 WINEDEBUG=-all
# A .pth file, not PYTHONPATH, which the tests take away from Blenders that they start.
# Wine does not implement what _wmi calls, and Python's module platform does without it.
printf '%s\nimport sys; sys.modules["_wmi"] = None\n' "$(as_windows "$site")" \
  >"$(dirname "$python")/lib/site-packages/snowbough.pth"
# OpenGL on Windows needs a window, and a window needs a screen.
command=(wine "$python")
if command -v xvfb-run >/dev/null; then
  command=(xvfb-run -a "${command[@]}")
fi
if [ "$layer" = python ]; then
  rm -rf "$site"/snowbough_native*
  /usr/bin/python3 -m zipfile -e build/packages/snowbough_native-*-win_amd64.whl "$site"
  # The other tests concern the checkout's tools.
  command+=(-m pytest tests/python/native tests/python/addon -v -rfEs -p no:cacheprovider -o junit_family=xunit2)
else
  zip=$(ls build/packages/repository/*windows_x64.zip)
  command+=(tests/blender/run.py --bpy --zip "$(as_windows "$PWD/$zip")")
fi
# Use a pipe, because programs in wine cannot write their output to a file.
PYTHONDONTWRITEBYTECODE=1 PYTHONUTF8=1 "${command[@]}" --junitxml="$(as_windows "$report")" "$@" </dev/null 2>&1 | cat
