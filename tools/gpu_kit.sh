#!/usr/bin/env bash
# Packs what the tables of real time need into one file for machines that have Python 3.11 and a graphics driver, and
# nothing else: build/snowbough-gpu-kit.pyz.
#
#   ./tools/gpu_kit.sh [FILE]
#
# There, one command prints them (--quick: whether it runs; --keep FOLDER: unpack there and stay; --only: see --help):
#
#   python3.11 snowbough-gpu-kit.pyz > tables.md
#
# In it: the native module with the libraries that it links beside it, numpy, the scripts of benchmarks/ and the tree
# that they measure. Not in it: libEGL, libGL and what else is the driver's, libc and its parts. glibc must be as new as
# this machine's. Needs patchelf and readelf (tools/setup.sh installs them).
set -euo pipefail
cd "$(dirname "$0")/.."
exec /usr/bin/python3 tools/gpu_kit.py "$@"
