#!/usr/bin/env bash
# Fetches the inputs of the release packages into build/third_party: the sources of the libraries (Debian 12's source
# packages, through apt), the headers and import libraries of each Python version (Maven Central's
# org.bytedeco:cpython), pybind11, and the compiler zig (both from PyPI).
#
#   ./tools/third_party.sh linux|windows|macos [...]     Python versions for these systems
#
# Every file is compared with tools/third_party.sha256. Existing files are kept.
set -euo pipefail
cd "$(dirname "$0")/.."
checksums="$PWD/tools/third_party.sha256"
root="$PWD/build/third_party"
sources="$root/sources"
mkdir -p "$root/download" "$sources"
cd "$root/download"

checked() {
  awk -v name="$1" '$2 == name' "$checksums" | sha256sum --check --status
}

fetched() {
  [ -f "$1" ] && checked "$1"
}

named() {
  awk '{ print $2 }' "$checksums" | grep -E "$1"
}

# Uses its own deb-src list, so that the machine's package lists stay unchanged.
fetch_debian_sources() {
  local mirror key
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | sed -n 1p)
  key=/usr/share/keyrings/debian-archive-keyring.gpg
  mkdir -p "$root/apt/lists/partial"
  echo "deb-src [signed-by=$key] ${mirror:-http://deb.debian.org/debian/} bookworm main" >"$root/apt/sources.list"
  local options=(-o "Dir::Etc::SourceList=$root/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o "Dir::State::Lists=$root/apt/lists" -o APT::Sandbox::User=root)
  apt-get -qq "${options[@]}" update
  apt-get -qq "${options[@]}" source --download-only --tar-only "$@" >/dev/null
}

missing=()
for file in $(named '\.orig\.tar\.'); do
  fetched "$file" || missing+=("${file%%_*}")
done
[ ${#missing[@]} -eq 0 ] || fetch_debian_sources "${missing[@]}"
for file in $(named '\.whl$'); do
  fetched "$file" && continue
  name=${file%%-*}
  version=${file#*-}
  /usr/bin/env python3 -m pip --disable-pip-version-check download --quiet --no-deps --only-binary :all: \
    "$name==${version%%-*}"
done
for file in $(named '\.jar$'); do
  for system in "$@"; do
    case "$system:$file" in
      linux:*linux-x86_64.jar | windows:*windows-x86_64.jar | macos:*macosx-*.jar) ;;
      *) continue ;;
    esac
    fetched "$file" && continue
    version=$(sed -E 's/^cpython-([0-9.]+-[0-9.]+)-.*/\1/' <<<"$file")
    curl --fail --silent --show-error --location --remote-name \
      "https://repo1.maven.org/maven2/org/bytedeco/cpython/$version/$file"
  done
done

for file in *; do
  checked "$file" || {
    echo "third_party: $root/download/$file does not match tools/third_party.sha256: delete it and run this again" >&2
    exit 1
  }
  unpacked="$sources/.$file.unpacked"
  [ ! -e "$unpacked" ] || continue
  case "$file" in
    *.orig.tar.*)
      name=${file%%_*}
      rm -rf "${sources:?}/$name"
      mkdir -p "$sources/$name"
      tar -x -f "$file" -C "$sources/$name" --strip-components 1
      ;;
    *.whl)
      rm -rf "${root:?}/${file%%-*}"
      /usr/bin/env python3 -m zipfile -e "$file" "$root/${file%%-*}"
      ;;
    *.jar)
      # Move the content of the jar's package to python/3.11/windows-x86_64/{include,libs,...}.
      IFS=- read -r _ version _ system <<<"${file%.jar}"
      to="$root/python/${version%.*}"
      rm -rf "${to:?}/$system" "$root/jar"
      /usr/bin/env python3 -m zipfile -e "$file" "$root/jar"
      mkdir -p "$to"
      mv "$root/jar/org/bytedeco/cpython/$system" "$to/$system"
      rm -rf "$root/jar"
      # Python's zipfile does not restore permissions.
      [ "$system" != linux-x86_64 ] || chmod +x "$to/$system/python${version%.*}"
      ;;
  esac
  touch "$unpacked"
done
chmod +x "$root/ziglang/ziglang/zig"
echo "third_party: $root is complete for ${*:-no system}"
