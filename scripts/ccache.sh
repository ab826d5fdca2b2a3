# Sourced where the library is built once more with the same flags, for the tests and for the Python package: ccache
# remembers. Paths are taken relative to build directories, which therefore lie side by side. A launcher that has been
# chosen already is left alone. Locales are not told apart: where
# none is set, Python sets one for the compilers that it starts.
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache} CXX=${CXX-c++}
export CCACHE_DIR=${CCACHE_DIR-$PWD/build-ccache} CCACHE_BASEDIR=$PWD CCACHE_DEPEND=1 CCACHE_SLOPPINESS=locale
