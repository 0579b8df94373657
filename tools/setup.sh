#!/usr/bin/env bash
# Prepares a Debian 12 machine for Snowbough: installs missing packages, then builds.
#
#   ./tools/setup.sh           everything: the module, its tests and benchmarks
#   ./tools/setup.sh module    only the Python module, for the demo
#   ./tools/setup.sh packages  only Debian's packages
#
# Afterwards `PYTHONPATH=build/python /usr/bin/python3 -c "import snowbough_native"` works. Later
# runs install only missing packages and build only changed files.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  '') target=all ;;
  module) target=snowbough_native ;;
  packages) target= ;;
  *)
    echo "setup: unknown argument '$1'" >&2
    sed -n '4,6s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac

is_installed() {
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# apt-get as root, without questions, so that it also runs unattended.
as_root_apt_get() {
  local sudo=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "setup: the installation needs root, but there is no sudo. As root, run: apt-get install ${missing[*]}" >&2
      exit 1
    fi
    sudo=(sudo)
    [ "${CI:-}" = true ] && sudo+=(-n)
  fi
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" </dev/null
}

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this script supports only Debian; install the packages of tools/dependencies.txt yourself" >&2
  exit 1
fi

missing=()
while read -r package reason; do
  case "$package" in '' | '#'*) continue ;; esac
  if ! is_installed "$package"; then
    [ ${#missing[@]} -gt 0 ] || echo "setup: to be installed with apt-get:"
    printf '  %-17s %s\n' "$package" "$reason"
    missing+=("$package")
  fi
done <tools/dependencies.txt

if [ ${#missing[@]} -gt 0 ]; then
  # Fetch package lists only if they are missing or name versions that the mirror no longer has.
  install=(install -y --no-install-recommends "${missing[@]}")
  if ! as_root_apt_get "${install[@]}"; then
    echo "setup: apt-get could not install these packages; fetching new package lists"
    as_root_apt_get update
    as_root_apt_get "${install[@]}"
  fi
else
  echo "setup: all packages are installed"
fi
[ -n "$target" ] || exit 0

launcher=()
if command -v ccache >/dev/null; then
  launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset release "${launcher[@]}"
cmake --build --preset release --target "$target"

PYTHONPATH=build/python /usr/bin/python3 -c "
import snowbough_native
print('setup: snowbough_native', snowbough_native.__version__, 'is built in build/python')"
