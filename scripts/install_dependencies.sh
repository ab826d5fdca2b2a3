#!/usr/bin/env bash
# Installs missing Debian 12 packages that Crumple needs; does nothing, without a prompt, if all are installed.
#   (no option)     to build the library and the command line
#   --tests         also to build the tests
#   --python        also for the Python package
#   --mpi           also for crumple::mpi
#   --mpich         also MPICH, which .ci/run builds crumple::mpi with, too
#   --python-peers  also for the packages from PyPI that scripts/test_python.sh --all tests against
#   --ci            also the tools of .ci/run
#   --reference     also for scripts/reference.sh
#   --fuzz          also for scripts/fuzz.sh
#   --arm64         also for scripts/test_arm64.sh
set -euo pipefail

packages=(cmake ninja-build g++ pkg-config
    libtbb-dev libhwy-dev libboost-dev
    libcli11-dev libfmt-dev nlohmann-json3-dev libtinygltf-dev libminizip-dev zlib1g-dev libexpat1-dev)
for option in "$@"; do
    case $option in
        --tests) packages+=(ccache codespell libgtest-dev librapidcheck-dev libboost-context-dev) ;;
        --python) packages+=(python3-dev python3-venv) ;;
        --mpi) packages+=(libopenmpi-dev openmpi-bin) ;;
        --mpich) packages+=(libmpich-dev mpich) ;;
        --python-peers) packages+=(libegl1 libgl1 libgomp1 libusb-1.0-0 libx11-6) ;;
        --ci) packages+=(clang clang-format clang-tidy clang-tools lld) ;;
        --reference) packages+=(doxygen python3-venv) ;;
        --fuzz) packages+=(ccache clang libclang-rt-dev llvm python3) ;;  # libFuzzer, sanitizers, symbols in stack traces
        --arm64) packages+=(g++-aarch64-linux-gnu qemu-user-static) ;;
        *) echo "usage: $0 [--tests] [--python] [--mpi] [--mpich] [--python-peers] [--ci] [--reference] [--fuzz] [--arm64]" >&2; exit 2 ;;
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
    echo "$0: these packages are missing, and installing them needs root or sudo: ${missing[*]}" >&2
    exit 1
fi
echo "Installing ${missing[*]}"
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@" >/dev/null; }
apt update
apt install --no-install-recommends -y "${missing[@]}"
