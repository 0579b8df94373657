#!/usr/bin/env bash
# Checks the packages that `tools/package.sh release` made in build/packages: runs auditwheel on the wheel for Linux,
# checks the libraries and symbols of the modules, runs Blender's own checks of extensions and repositories, and a
# quick run of the kit of tools/gpu_kit.sh.
#
#   ./tools/check_packages.sh [BLENDER_EXT.py]
#
# BLENDER_EXT.py is the file scripts/addons_core/bl_pkg/cli/blender_ext.py of a Blender. The default is the file of the
# bpy that tools/blender_bpy.sh has installed.
set -euo pipefail
cd "$(dirname "$0")/.."
packages=build/packages
venv=build/check-packages
[ -x "$venv/bin/auditwheel" ] || {
  /usr/bin/python3 -m venv "$venv"
  "$venv/bin/pip" --disable-pip-version-check install --quiet auditwheel pyelftools macholib
}

for wheel in "$packages"/*linux*.whl; do
  "$venv/bin/auditwheel" show "$wheel" | tee "$venv/auditwheel.txt"
  grep -qE '"manylinux_2_(1[0-9]|2[0-8])_x86_64"' "$venv/auditwheel.txt"
done
"$venv/bin/python" tools/check_modules.py

blender_ext="${1:-$(ls build/blender-bpy*/lib/python3*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py 2>/dev/null | tail -n 1)}"
if [ -z "$blender_ext" ]; then
  echo "check_packages: there is no blender_ext.py: pass its path, or run ./tools/test.sh --blender bpy first" >&2
  exit 1
fi
rm -rf "$venv/repository" "$venv/split"
for zip in "$packages"/repository/*.zip; do
  /usr/bin/python3 "$blender_ext" validate "$zip"
done
# If Blender splits the add-on with the wheels of all systems, the zips must have the same names.
/usr/bin/python3 - "$venv/split" "$packages"/repository/*.zip <<'PYTHON'
import re
import sys
import zipfile
from pathlib import Path

split, platforms, wheels = Path(sys.argv[1]), [], []
for name in sys.argv[2:]:
    with zipfile.ZipFile(name) as archive:
        archive.extractall(split / "source")
        manifest = archive.read("blender_manifest.toml").decode()
    platforms += re.findall(r'^platforms = \[(".*")\]', manifest, re.MULTILINE)
    wheels += re.findall(r'^wheels = \[(".*")\]', manifest, re.MULTILINE)
for key, values in (("platforms", platforms), ("wheels", wheels)):
    manifest = re.sub(rf"^{key} = .*$", f"{key} = [{', '.join(values)}]", manifest, flags=re.MULTILINE)
(split / "source" / "blender_manifest.toml").write_text(manifest)
(split / "built").mkdir()
PYTHON
/usr/bin/python3 "$blender_ext" build --split-platforms --source-dir="$venv/split/source" --output-dir="$venv/split/built"
if [ "$(ls "$venv/split/built")" != "$(cd "$packages/repository" && ls ./*.zip | sed 's|^\./||')" ] &&
  [ "$(ls "$packages"/repository/*.zip | wc -l)" -gt 1 ]; then
  echo "check_packages: Blender splits the add-on into different zips: $(ls "$venv/split/built")" >&2
  exit 1
fi
# Blender must generate the same index for the same zips.
mkdir -p "$venv/repository"
cp "$packages"/repository/*.zip "$venv/repository"
/usr/bin/python3 "$blender_ext" server-generate --repo-dir="$venv/repository"
/usr/bin/python3 - "$packages/repository/index.json" "$venv/repository/index.json" <<'PYTHON'
import json
import sys

own, blenders = (sorted(json.load(open(path))["data"], key=lambda entry: entry["archive_url"]) for path in sys.argv[1:])
if own != blenders:
    sys.exit(f"check_packages: the index differs from Blender's:\n{own}\n{blenders}")
print(f"check_packages: Blender writes the same index of {len(own)} zips")
PYTHON

tools/gpu_kit.sh linux
rm -rf "$venv/snowbough-gpu-kit"
tar -x -f build/snowbough-gpu-kit-linux.tar.gz -C "$venv"
env -i "$venv/snowbough-gpu-kit/measure" --quick --only trees,step | grep '^| 512 x 512 | [0-9]'
echo "check_packages: the kit runs without an environment"
