#!/usr/bin/env bash
# Publishes build/packages as a release on GitHub, with `gh`. People add the address of its index.json in Blender.
#
#   ./tools/release.sh v<version>   the channel `stable`: the tag must name the manifest's version
#   ./tools/release.sh latest       the channel `latest`: replaces the packages of the commit before
set -euo pipefail
cd "$(dirname "$0")/.."
tag="${1:?the tag is missing: v<version> or latest}"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' addon/snowbough/blender_manifest.toml)
files=(build/packages/*.zip build/packages/*.whl build/packages/repository/*)
if [ "$tag" = latest ]; then
  # A release cannot be moved to another commit: delete it and make it again.
  gh release delete latest --cleanup-tag --yes 2>/dev/null || true
  exec gh release create latest "${files[@]}" --prerelease --target "$(git rev-parse HEAD)" --title latest \
    --notes "Snowbough $version, not released yet. See CHANGELOG.md."
fi
if [ "$tag" != "v$version" ]; then
  echo "release: the tag is $tag, but the manifest says version $version" >&2
  exit 1
fi
exec gh release create "$tag" "${files[@]}" --latest --notes-file CHANGELOG.md
