# Sourced by .ci/run and .ci/nightly: how a step is run, and what both need.
# shellcheck shell=bash
set -euo pipefail
cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.."

scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT

# What the builds by g++ have in common is compiled once, where there is ccache.
# g++ 12 with -O3 warns of its own strings: uninitialised in a struct that has just been made, or overlapping.
strict="-Werror -Wno-error=maybe-uninitialized -Wno-error=restrict"
remember_objects() {
  command -v ccache >/dev/null || return 0
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR=$scratch/ccache CCACHE_BASEDIR=$PWD
}

# step NAME COMMAND...: runs it and says how long it took.
step() {
  local name=$1 start=$SECONDS
  shift
  echo "== $name"
  "$@"
  echo "== $name: passed in $((SECONDS - start)) s"
}

# built SLOW: with vbond-lammps and the Python module, whose tests are then among those to come: they take the library as
# it is. SLOW: whether to build the programs of slow tests (ON, OFF). Twice as many sources at a time as elsewhere: they
# share the headers, and with two processors nothing waits for the longest.
built() {
  local slow=$1 lammps=ON python=ON
  (source tools/setup.sh; need "${vbond_lammps_packages[@]}") ||
    { lammps=OFF; echo "SKIPPED: Ranks.*: no LAMMPS, or no MPI"; }
  (source tools/setup.sh; need "${vbond_python_packages[@]}" "${vbond_python_test_packages[@]}") ||
    { python=OFF; echo "SKIPPED: Python.*: no pybind11, numpy or pytest"; }
  local -x CXXFLAGS=$strict
  (source tools/setup.sh
   configure_options=(-D VBOND_TESTS=ON -D VBOND_SLOW_TESTS=$slow "${vbond_python_options[@]}" -D VBOND_PYTHON=$python -D VBOND_LAMMPS=$lammps
     -D CMAKE_UNITY_BUILD_BATCH_SIZE=16)
   build release)
}

# tested PRESET [OPTIONS of ctest]: the quick tests of a build, but for those of scripts.
tested() {
  ctest --test-dir "build/$1" --output-on-failure --no-tests=error --parallel "$(nproc)" \
    --label-regex quick --label-exclude scripts "${@:2}"
}
