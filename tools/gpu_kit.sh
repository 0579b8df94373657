#!/usr/bin/env bash
# Packs the scripts for the real-time tables with a Python of their own, for machines that have only a graphics driver.
#
#   ./tools/gpu_kit.sh linux|windows       writes build/snowbough-gpu-kit-<system>.tar.gz
#
# Uses the wheel in build/packages: run `./tools/package.sh release` first. On the other machine, in a terminal:
#
#   tar xf snowbough-gpu-kit-linux.tar.gz
#   snowbough-gpu-kit/measure > tables.md          Windows: snowbough-gpu-kit\measure.bat > tables.md
#
# --quick: a short run; --only: see --help. The kit contains CPython and NumPy. It uses the machine's OpenGL driver and
# needs, on Linux, a glibc of version 2.28 or later.
set -euo pipefail
cd "$(dirname "$0")/.."
exec /usr/bin/python3 tools/gpu_kit.py "$@"
