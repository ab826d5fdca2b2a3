#!/usr/bin/env bash
# Writes the API reference to build-reference/index.html: C++ by Doxygen, Python by pdoc. Builds nothing of the library.
#   scripts/reference.sh [cpp | python]     one of the two; without an argument both
# Prints warnings, including those about public entities without a comment, and fails if there are any. Data members, type
# aliases within classes, friends, operators and move constructors need no comment. build-reference/doxygen.log has all
# warnings of Doxygen.
set -euo pipefail
cd "$(dirname "$0")/.."
case ${1-} in
    '' | cpp | python) ;;
    *) echo "usage: $0 [cpp | python]" >&2; exit 2 ;;
esac
scripts/install_dependencies.sh --reference
out=build-reference
mkdir -p $out
echo '<!doctype html><title>Crumple</title><a href="cpp/index.html">C++</a> <a href="python/crumple.html">Python</a>' \
    >$out/index.html
status=0

if [[ ${1-} != python ]]; then
    rm -rf $out/cpp
    cat >$out/namespaces.dox <<-END
	/// @mainpage Crumple
	/// Start with crumple::Detector: it takes a crumple::Scene and a query, such as crumple::IntersectionQuery.
	/// @namespace crumple
	/// Collision detection.
	/// @namespace crumple::io
	/// Files of meshes, worlds and results. Link crumple::io.
	/// @namespace crumple::mpi
	/// One scene on many processes of MPI. Link crumple::mpi.
	END
    doxygen - <<-END
	PROJECT_NAME = Crumple
	INPUT = include/crumple $out/namespaces.dox
	EXCLUDE_SYMBOLS = *::detail
	STRIP_FROM_PATH = include
	STRIP_FROM_INC_PATH = include
	OUTPUT_DIRECTORY = $out
	HTML_OUTPUT = cpp
	GENERATE_LATEX = NO
	HAVE_DOT = NO
	QUIET = YES
	WARN_LOGFILE = $out/doxygen.log
	JAVADOC_AUTOBRIEF = YES
	DISTRIBUTE_GROUP_DOC = YES
	MACRO_EXPANSION = YES
	EXPAND_ONLY_PREDEF = YES
	PREDEFINED = CRUMPLE_API= CRUMPLE_LIFETIMEBOUND=
	END
    need_none='\((variable|typedef|friend)\) of |Member operator|&&\) noexcept \(function\)'
    sed "s|^$PWD/||" $out/doxygen.log | grep -vE "($need_none).* is not documented" | sort -u >&2 && status=1 || (($? == 1))
fi

if [[ ${1-} != cpp ]]; then
    rm -rf $out/python
    python=$out/venv/bin/python
    [[ -x $python ]] || python3 -m venv $out/venv
    "$python" -c 'import numpy, pdoc, typing_extensions' 2>/dev/null ||
        "$python" -m pip install --quiet --disable-pip-version-check 'pdoc==16.*' numpy typing_extensions
    "$python" scripts/python_reference.py $out/python || status=1
fi
exit $status
