#!/usr/bin/env bash
# Runs tests/blender in Debian sid's Blender (5.2 LTS with Python 3.14) on any Debian machine.
#
#   tools/blender_sid.sh REPORT.xml [pytest arguments]
#   tools/blender_sid.sh --run COMMAND...           runs a command in there instead, in the checkout, which is
#                                                   /snowbough; SNOWBOUGH_TEST_ZIP names the add-on's zip
#
# Makes a Debian sid folder with debootstrap in build/blender-sid (kept, about 4 GB), builds the native
# module in there in a folder of its own (build/sid) and runs the tests. The mirror is the one that this
# machine's apt uses. Needs root, for debootstrap and chroot; all mounts live in a private mount namespace
# and end with this script. What cannot be had is reported as a skip.
set -euo pipefail
run=
if [ "$1" = --run ]; then
  run=yes
else
  report="$(realpath -m "$1")"
fi
shift
cd "$(dirname "$0")/.."
sid="$PWD/build/blender-sid"

skip() {
  echo "blender 5.2: skipped: $1"
  [ -z "$run" ] || exit 1
  /usr/bin/python3 tools/skip_report.py "$report" "Blender 5.2" "$1"
  exit 0
}

# Once more from the top, in a mount namespace of our own: nothing stays mounted whatever happens.
if [ "${SNOWBOUGH_OWN_MOUNTS:-}" != yes ]; then
  [ "$(id -u)" -eq 0 ] || skip "debootstrap and chroot need root"
  unshare --mount true 2>/dev/null || skip "this machine does not allow mounts"
  SNOWBOUGH_OWN_MOUNTS=yes exec unshare --mount --propagation private "$0" "${run:+--run}${report:-}" "$@"
fi

if ! command -v debootstrap >/dev/null; then
  echo "blender 5.2: to be installed with apt-get: debootstrap (makes the Debian sid folder)"
  { DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap ||
    { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap; }
  } </dev/null || skip "debootstrap could not be installed"
fi

if [ ! -e "$sid/.base-complete" ]; then
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | sed -n 1p)
  [ -n "$mirror" ] || skip "apt on this machine knows no Debian mirror"
  rm -rf "$sid"
  echo "blender 5.2: making a Debian sid folder from $mirror"
  debootstrap --variant=minbase sid "$sid" "$mirror" || skip "debootstrap could not fetch Debian sid from $mirror"
  touch "$sid/.base-complete"
fi

mount -t proc proc "$sid/proc"
mount --rbind /dev "$sid/dev"
mount --rbind /sys "$sid/sys"
cp /etc/resolv.conf "$sid/etc/resolv.conf"
in_sid() {
  chroot "$sid" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root \
    DEBIAN_FRONTEND=noninteractive PYTHONUNBUFFERED=1 "$@" </dev/null
}

# Debian's Blender 5.2 does not name python3-cattr and python3-requests, which its extension manager imports.
packages="$(awk '!/^#/ && NF { print $1 }' tools/dependencies.txt)
python3-cattr
python3-requests"
if [ "$(cat "$sid/.packages-complete" 2>/dev/null)" != "$packages" ]; then
  echo "blender 5.2: installing Blender and the build's packages in the Debian sid folder"
  # A mirror's copy of sid may be days old, which apt would refuse.
  in_sid apt-get -o Acquire::Check-Valid-Until=false update || skip "the mirror's package lists of Debian sid could not be read"
  # Some packages' first configure fails outside a booted system; the second pass mends it.
  # shellcheck disable=SC2086
  in_sid apt-get install -y --no-install-recommends $packages ||
    in_sid apt-get install -y -f --no-install-recommends ||
    skip "Blender could not be installed from Debian sid"
  # shellcheck disable=SC2086
  in_sid dpkg --status $packages >/dev/null || skip "Blender could not be installed from Debian sid"
  echo "$packages" >"$sid/.packages-complete"
fi
version=$(in_sid blender --version | sed -n 's/^Blender //p')
echo "blender 5.2: Debian sid has Blender $version with $(in_sid /usr/bin/python3 --version)"
case "$version" in
  5.2*) ;;
  *) skip "Debian sid has moved on to Blender $version" ;;
esac

mkdir -p "$sid/snowbough" "$sid/shared"
mount --bind . "$sid/snowbough"
# The command line run from the checkout looks for the module in build/python: in there it is sid's.
mkdir -p build/python build/sid/python
mount --bind build/sid/python "$sid/snowbough/build/python"
if [ -d ../shared ]; then
  mount --bind ../shared "$sid/shared"
fi
in_sid cmake -S /snowbough -B /snowbough/build/sid/release -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DPython_EXECUTABLE=/usr/bin/python3 -DSNOWBOUGH_PYTHON_DIR=/snowbough/build/sid/python \
  -DSNOWBOUGH_TESTS=OFF -DSNOWBOUGH_BENCHMARKS=OFF
in_sid cmake --build /snowbough/build/sid/release
in_sid /snowbough/tools/package.sh build/sid/python build/sid/snowbough.zip
mkdir -p build/sid
if [ -n "$run" ]; then
  in_sid SNOWBOUGH_TEST_ZIP=/snowbough/build/sid/snowbough.zip /usr/bin/env -C /snowbough "$@"
  exit
fi
in_sid /usr/bin/python3 /snowbough/tests/blender/run.py --blender /usr/bin/blender \
  --zip /snowbough/build/sid/snowbough.zip --junitxml /snowbough/build/sid/blender.xml "$@" || status=$?
[ ! -e build/sid/blender.xml ] || mv build/sid/blender.xml "$report"
exit "${status:-0}"
