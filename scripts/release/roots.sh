#!/usr/bin/env bash
# Installs the content of dist/ in root file systems of bare Debian, without a compiler, and runs it. On Debian 12: a wheel, and
# the Debian package with its dependencies; then installs a compiler and builds a project that finds the package. On Debian 13:
# the wheel of the stable ABI. Needs root and debootstrap; $MIRROR is Debian's mirror. If $PREVIOUS_DEB is the path of the
# previous release's Debian package, installs that first and tests the upgrade. Works in a temporary folder.
set -euo pipefail
. "$(dirname "$0")/common.sh"
mirror=${MIRROR:-http://deb.debian.org/debian}
# Restarts this script in a mount namespace of its own, so that the /proc file systems that it mounts below disappear even if it
# is killed.
[[ ${CRUMPLE_ROOTS_APART-} ]] || CRUMPLE_ROOTS_APART=1 exec unshare --mount --propagation private "$0" "$@"

folder=$(mktemp -d)
cleanup() {
    local root
    for root in "$folder"/*/proc; do ! mountpoint -q "$root" || umount "$root"; done
    rm -rf --one-file-system "$folder"
}
trap cleanup EXIT
in_root() {
    local settings=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
    env -i "${settings[@]}" chroot "$root" "$@"
}
no_compiler() {
    local name
    for name in cc c++ gcc g++ clang clang++; do
        ! in_root sh -c "command -v $name" >/dev/null || fail "$suite has a compiler: $name"
    done
}

# bare SUITE: makes a root file system with Python only, and copies dist/ and the tests into it.
bare() {
    suite=$1 root=$folder/$1
    step "bare Debian, $suite"
    quietly "$work/$suite.log" debootstrap --variant=minbase --include=python3,python3-venv "$suite" "$root" "$mirror"
    mount -t proc proc "$root/proc"
    cp --remove-destination "$(readlink -f /etc/resolv.conf)" "$root/etc/resolv.conf"
    cp -r "$dist" "$numpy" "$here/quick_start.py" "$top/docs/python.md" "$top/tests/consumer" "$root/root"
    no_compiler
}

# wheel: installs and runs the wheel in dist/ that fits the root's Python.
wheel() {
    local of
    of=$(in_root python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    "$work/tools/bin/python" -m pip --quiet --disable-pip-version-check download --dest "$root/root/numpy" --no-deps \
        --only-binary=:all: --python-version "$of" --platform manylinux_2_28_x86_64 --platform manylinux_2_27_x86_64 \
        --platform manylinux2014_x86_64 numpy
    in_root python3 -m venv /root/venv
    in_root /root/venv/bin/python -m pip --quiet --disable-pip-version-check install --no-index \
        --find-links /root/dist --find-links /root/numpy "crumple==$version"
    in_root sh -c 'cd /root && ls -d venv/lib/*/site-packages/crumple/_core*.so &&
        venv/bin/python quick_start.py python.md'
    no_compiler
}

# Installs the Debian package of the previous release, $PREVIOUS_DEB, which the new one then upgrades.
previous() {
    cp "$PREVIOUS_DEB" "$root/root/previous.deb"
    quietly "$work/$suite-apt.log" in_root apt-get -qq install --no-install-recommends -y /root/previous.deb
    in_root sh -ec 'crumple --version; dpkg --listfiles crumple | sort >/root/previous.txt'
}
# Fails if the upgrade has left files of the previous package behind that the new one does not contain.
upgraded() {
    in_root sh -ec 'dpkg --listfiles crumple | sort >/root/new.txt
        comm -23 /root/previous.txt /root/new.txt | while read -r file; do test ! -f "$file" || { echo "left: $file"; exit 1; }; done
        echo "upgrade: $(comm -12 /root/previous.txt /root/new.txt | wc -l) paths stay," \
            "$(comm -23 /root/previous.txt /root/new.txt | wc -l) went, $(comm -13 /root/previous.txt /root/new.txt | wc -l) are new"'
}

# package: tests the Debian package without a compiler, then installs one and builds a project that uses the package.
package() {
    in_root apt-get -qq update
    [[ ! ${PREVIOUS_DEB-} ]] || previous
    quietly "$work/$suite-apt.log" in_root apt-get -qq install --no-install-recommends -y "/root/dist/${deb##*/}"
    no_compiler
    [[ ! ${PREVIOUS_DEB-} ]] || upgraded
    in_root sh -ec 'cd /root
        crumple --version
        crumple make cloth --triangles 2000 -o cloth.ply
        crumple detect cloth.ply --stats -o hits.glb -o pairs.csv
        test -s hits.glb && test -s pairs.csv
        ls /usr/share/doc/crumple'
    quietly "$work/$suite-apt.log" in_root apt-get -qq install --no-install-recommends -y cmake ninja-build g++
    in_root sh -c 'cd /root && cmake -G Ninja -S consumer -B build >/dev/null && cmake --build build && build/consumer'
}

bare bookworm
wheel
deb=$(compgen -G "$dist/crumple_*.deb" || true)
if [[ $deb ]]; then package; else echo "There is no Debian package in $dist, so none is tested"; fi
bare trixie
wheel
