#!/usr/bin/env bash
# Installs what is missing of the Debian 12 packages that Crumple needs; does nothing, and asks nobody, if all are there.
#   (nothing)  to build the library and the command line
#   --tests    and the tests
#   --ci       and what .ci/run checks with
#   --arm64    and what scripts/test_arm64.sh cross-compiles with
set -euo pipefail

packages=(cmake ninja-build g++ pkg-config
    libtbb-dev libhwy-dev libboost-dev
    libcli11-dev libfmt-dev nlohmann-json3-dev libtinygltf-dev libzip-dev)
for option in "$@"; do
    case $option in
        --tests) packages+=(libgtest-dev librapidcheck-dev) ;;
        --ci) packages+=(clang clang-format clang-tidy clang-tools) ;;
        --arm64) packages+=(g++-aarch64-linux-gnu qemu-user-static) ;;
        *) echo "usage: $0 [--tests] [--ci] [--arm64]" >&2; exit 2 ;;
    esac
done

missing=()
for package in "${packages[@]}"; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
((${#missing[@]})) || exit 0

if ((EUID == 0)); then
    as_root=()
elif command -v sudo >/dev/null; then
    as_root=(sudo)
else
    echo "$0: these packages are missing, and neither root nor sudo is here to install them: ${missing[*]}" >&2
    exit 1
fi
echo "Installing ${missing[*]}"
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@" >/dev/null; }
apt update
apt install --no-install-recommends -y "${missing[@]}"
