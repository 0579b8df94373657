#!/usr/bin/env bash
# Checks the form of the sources; changes nothing.
#
#   ./tools/lint.sh         ruff over Python, clang-format over C++, shellcheck over scripts and
#                           actionlint over workflows where they are installed
#   ./tools/lint.sh tidy    clang-tidy over C++ (compiles everything: about an hour)
#
# Needs clang-format and python3-venv, for tidy clang-tidy. ruff comes from PyPI into build/lint.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" = tidy ]; then
  cmake --preset tidy
  exec cmake --build build/tidy
fi
ruff=$(command -v ruff || echo build/lint/bin/ruff)
if [ ! -x "$ruff" ]; then
  /usr/bin/python3 -m venv build/lint
  build/lint/bin/python -m pip --disable-pip-version-check install --quiet ruff==0.17.6
fi
"$ruff" check .
"$ruff" format --check .
# The headers of shaders/lib are GLSL too and have GLSL's form.
git ls-files 'native/*.cpp' 'native/*.h' 'tests/*.cpp' 'tests/*.h' 'benchmarks/*.cpp' 'benchmarks/*.h' |
  xargs clang-format --dry-run -Werror
if command -v shellcheck >/dev/null; then
  git ls-files '*.sh' '.ci/*' | xargs shellcheck --severity warning
fi
if command -v actionlint >/dev/null; then
  actionlint
fi
echo "lint: no complaints"
