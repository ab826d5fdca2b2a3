# Enables ccache. Sourced by scripts that build the library again with the same flags, for the tests and for the Python
# package. ccache compares paths relative to the build directory, so builds share results only if their directories have
# the same parent. Keeps a launcher that is already set. Ignores differences in locale, because Python sets a locale for the
# compilers that it starts if none is set.
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache} CXX=${CXX-c++}
export CCACHE_DIR=${CCACHE_DIR-$PWD/build-ccache} CCACHE_BASEDIR=$PWD CCACHE_DEPEND=1 CCACHE_SLOPPINESS=locale
