# Sourced by scripts in the root of the sources: builds through ccache, if it is installed. It gets
# relative paths, so that builds in different folders, such as those of wheels, share results.
if command -v ccache > /dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
fi
