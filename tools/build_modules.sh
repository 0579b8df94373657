#!/usr/bin/env bash
# Builds the native modules of the packages in build/<system>/modules: self-contained, one per Python version.
#
#   ./tools/build_modules.sh linux|windows|macos [...]
#
# Runs on any x86-64 Debian 12 with the packages of tools/dependencies.txt. tools/check_modules.py
# checks the modules.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/third_party.sh "$@"
launcher=()
if command -v ccache >/dev/null; then
  export CCACHE_COMPILERTYPE=clang
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
for system in "$@"; do
  # The compilers of all systems are scripts of equal names and sizes: ccache must not tell them apart by their times.
  CCACHE_COMPILERCHECK="string:$system $(grep ziglang tools/third_party.sha256)"
  export CCACHE_COMPILERCHECK
  cmake -S . -B "build/$system" -G Ninja --toolchain cmake/Zig.cmake "${launcher[@]}" -DCMAKE_BUILD_TYPE=Release \
    -DSNOWBOUGH_SYSTEM="$system" -DSNOWBOUGH_BUNDLED=ON -DSNOWBOUGH_TESTS=OFF \
    -DSNOWBOUGH_PYTHON_DIR="$PWD/build/$system/modules" -DPython_EXECUTABLE=/usr/bin/python3
  cmake --build "build/$system" --target snowbough_native
done
