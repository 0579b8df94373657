#!/usr/bin/env bash
# Makes the add-on's zip, with the native module inside: build/snowbough-<version>.zip.
#
#   ./tools/package.sh [FOLDER_OF_THE_NATIVE_MODULE [ZIP]]
#
# One zip for all versions: Blender 3.4 to 4.1 install it as an add-on (Preferences > Add-ons > Install), 4.2 and later
# as an extension (Install from Disk) or as a legacy add-on. The native module works only with the Python that it was
# built for; tools/setup.sh builds it in build/python. Equal input gives equal bytes.
set -euo pipefail
cd "$(dirname "$0")/.."

/usr/bin/env python3 - "${1:-build/python}" "${2:-}" <<'PYTHON'
import re
import sys
import zipfile
from pathlib import Path

addon = Path("addon/snowbough")
manifest = (addon / "blender_manifest.toml").read_text(encoding="utf-8")
version = re.search(r'^version = "([^"]+)"', manifest, re.MULTILINE).group(1)
in_python = re.search(r'"version": \((\d+), (\d+), (\d+)\)', (addon / "__init__.py").read_text(encoding="utf-8"))
if ".".join(in_python.groups()) != version:
    sys.exit(f"package: blender_manifest.toml says {version}, bl_info in __init__.py {in_python.groups()}")

native = sorted(Path(sys.argv[1]).glob("snowbough_native*.so"))
if not native:
    sys.exit(f"package: no snowbough_native in {sys.argv[1]}; run ./tools/setup.sh first")

files = [(path, path.relative_to(addon)) for path in sorted(addon.rglob("*"))]
files = [(path, to) for path, to in files if path.is_file() and "__pycache__" not in to.parts and to.parts[0] != "lib"]
files += [(path, Path("lib") / path.name) for path in native]
files.append((Path("LICENSE"), Path("LICENSE")))

target = Path(sys.argv[2] or f"build/snowbough-{version}.zip")
target.parent.mkdir(parents=True, exist_ok=True)
partial = target.with_name(target.name + ".part")
with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
    for path, to in files:
        entry = zipfile.ZipInfo(f"snowbough/{to.as_posix()}", date_time=(1980, 1, 1, 0, 0, 0))
        entry.external_attr = 0o644 << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(entry, path.read_bytes())
partial.replace(target)
print(target)
PYTHON
