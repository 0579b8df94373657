#!/usr/bin/env bash
# Runs tests/blender in the Blender of a newer Debian, on any Debian machine: 4.3 from trixie (4.3.2 with Python 3.13)
# or 5.2 from sid (5.2 LTS with Python 3.14).
#
#   tools/blender_debian.sh 4.3|5.2 REPORT.xml [pytest arguments]
#   tools/blender_debian.sh 4.3|5.2 --run COMMAND...   runs a command there instead; the checkout is /snowbough,
#                                                      and SNOWBOUGH_TEST_ZIP is the path of the add-on's zip
#
# Makes a Debian folder with debootstrap in build/blender-<suite> (kept, about 3 GB), and runs the tests there on the
# release package (tools/package.sh release linux). Uses the mirror of this machine's apt. Needs root, for debootstrap
# and chroot; all mounts are in a private mount namespace and end with this script. If Blender cannot be installed, the
# report contains a skip. Environment variables that begin with SNOWBOUGH_ are passed to the commands.
set -euo pipefail
wanted="${1:-}"
case "$wanted" in
  4.3) suite=trixie ;;
  5.2) suite=sid ;;
  *)
    echo "blender_debian: use 4.3 (Debian trixie) or 5.2 (Debian sid), not '$wanted'" >&2
    exit 2
    ;;
esac
run=
if [ "$2" = --run ]; then
  run=yes
else
  report="$(realpath -m "$2")"
fi
shift 2
cd "$(dirname "$0")/.."
root="$PWD/build/blender-$suite"

skip() {
  echo "blender $wanted: skipped: $1"
  [ -z "$run" ] || exit 1
  /usr/bin/python3 tools/skip_report.py "$report" "Blender $wanted" "$1"
  exit 0
}

# Run this script again in a private mount namespace, so that no mount remains in any case.
if [ "${SNOWBOUGH_OWN_MOUNTS:-}" != yes ]; then
  [ "$(id -u)" -eq 0 ] || skip "debootstrap and chroot need root"
  unshare --mount true 2>/dev/null || skip "this machine does not allow mounts"
  SNOWBOUGH_OWN_MOUNTS=yes exec unshare --mount --propagation private "$0" "$wanted" "${run:+--run}${report:-}" "$@"
fi

if ! command -v debootstrap >/dev/null; then
  echo "blender $wanted: to be installed with apt-get: debootstrap (makes the Debian $suite folder)"
  { DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap ||
    { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap; }
  } </dev/null || skip "debootstrap could not be installed"
fi

if [ ! -e "$root/.base-complete" ]; then
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | sed -n 1p)
  [ -n "$mirror" ] || skip "apt on this machine knows no Debian mirror"
  rm -rf "$root"
  echo "blender $wanted: making a Debian $suite folder from $mirror"
  debootstrap --variant=minbase "$suite" "$root" "$mirror" ||
    skip "debootstrap could not fetch Debian $suite from $mirror"
  touch "$root/.base-complete"
fi

mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --rbind /sys "$root/sys"
cp /etc/resolv.conf "$root/etc/resolv.conf"
# Without it Blender writes warnings to its error output, which tests require to be empty.
[ -e "$root/etc/mtab" ] || ln -s /proc/self/mounts "$root/etc/mtab"
given=()
while IFS= read -r variable; do
  given+=("$variable=${!variable}")
done < <(compgen -e | grep '^SNOWBOUGH_' || true)
inside() {
  chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root \
    DEBIAN_FRONTEND=noninteractive PYTHONUNBUFFERED=1 "${given[@]}" "$@" </dev/null
}

# Debian's package of Blender 5.2 does not depend on python3-cattr and python3-requests, which its extension manager
# imports, and both need NumPy. `--gpu-backend vulkan` needs a software Vulkan driver. The last line is for --run.
packages="blender python3-numpy python3-pytest python3-cattr python3-requests
libegl1 libgl1-mesa-dri mesa-vulkan-drivers
python3-pil xvfb xauth xdotool"
if [ "$(cat "$root/.packages-complete" 2>/dev/null)" != "$packages" ]; then
  echo "blender $wanted: installing Blender in the Debian $suite folder"
  # Without this option apt rejects a mirror's copy of sid that is some days old.
  inside apt-get -o Acquire::Check-Valid-Until=false update ||
    skip "the mirror's package lists of Debian $suite could not be read"
  # Some packages' first configure fails outside a booted system; the second pass succeeds.
  # shellcheck disable=SC2086
  inside apt-get install -y --no-install-recommends $packages ||
    inside apt-get install -y -f --no-install-recommends ||
    skip "Blender could not be installed from Debian $suite"
  # shellcheck disable=SC2086
  inside dpkg --status $packages >/dev/null || skip "Blender could not be installed from Debian $suite"
  echo "$packages" >"$root/.packages-complete"
fi
version=$(inside blender --version | sed -n 's/^Blender //p')
echo "blender $wanted: Debian $suite has Blender $version with $(inside /usr/bin/python3 --version)"
case "$version" in
  "$wanted"*) ;;
  *) skip "Debian $suite has moved on to Blender $version" ;;
esac

[ "${SNOWBOUGH_SETUP:-1}" = 0 ] || tools/package.sh release linux
zip="/snowbough/$(ls build/packages/repository/*linux_x64.zip)"
# The checkout's command line loads the module from build/python: there are the package's modules.
modules="build/blender-$suite-modules"
rm -rf "$modules"
python3 -m zipfile -e build/packages/*linux*.whl "$modules"
mkdir -p "$root/snowbough" "$root/shared" build/python
mount --bind . "$root/snowbough"
mount --bind "$modules" "$root/snowbough/build/python"
if [ -d ../shared ]; then
  mount --bind ../shared "$root/shared"
fi
if [ -n "$run" ]; then
  inside "SNOWBOUGH_TEST_ZIP=$zip" /usr/bin/env -C /snowbough "$@"
  exit
fi
inside /usr/bin/env -C /snowbough /usr/bin/python3 tests/blender/run.py --blender /usr/bin/blender \
  --zip "$zip" --junitxml "/snowbough/build/blender-$suite.xml" "$@" || status=$?
[ ! -e "build/blender-$suite.xml" ] || mv "build/blender-$suite.xml" "$report"
exit "${status:-0}"
