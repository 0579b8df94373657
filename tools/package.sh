#!/usr/bin/env bash
# Makes the add-on's zips. Equal input gives equal bytes.
#
#   ./tools/package.sh [FOLDER_OF_THE_NATIVE_MODULE [ZIP]]
#       build/snowbough-<version>.zip, for the Python that the module in the folder (build/python) was built for.
#       Blender 3.4 to 4.1 install it as an add-on, 4.2 and later as an extension.
#   ./tools/package.sh release [linux|windows|macos ...]
#       build/packages: the release for these systems (default: linux and windows; macos has never been run). It
#       has one zip per system for Blender 4.2 and later, one zip for 3.4 to 4.1, the wheels, and a repository that users add in Blender by path or URL.
#       Builds missing modules (tools/build_modules.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" != release ]; then
  exec /usr/bin/env python3 tools/package.py develop "${1:-build/python}" "${2:-}"
fi
shift
[ $# -gt 0 ] || set -- linux windows
tools/build_modules.sh "$@" >&2
exec /usr/bin/env python3 tools/package.py release "$@"
