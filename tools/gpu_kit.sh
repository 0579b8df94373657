#!/usr/bin/env bash
# Packs the scripts for the real-time tables into one file, build/snowbough-gpu-kit.pyz, for machines that have only
# Python 3.11 and a graphics driver.
#
#   ./tools/gpu_kit.sh [FILE]
#
# On that machine, one command prints the tables (--quick: a short run; --keep FOLDER: unpack there and keep the files;
# --only: see --help):
#
#   python3.11 snowbough-gpu-kit.pyz > tables.md
#
# The kit contains the native module, the libraries that it links, numpy, the scripts of benchmarks/ and the measured
# tree. It does not contain libEGL, libGL and other libraries of the driver, libc and its parts. The other machine's
# glibc must be at least as new as this machine's. Needs patchelf and readelf (tools/setup.sh installs them).
set -euo pipefail
cd "$(dirname "$0")/.."
exec /usr/bin/python3 tools/gpu_kit.py "$@"
