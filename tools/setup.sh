# Sourced by ./run, ./test, tools/package, .ci/run and .ci/nightly: what a bare Debian 12 lacks, and how it is built.
# Messages go to stderr; stdout belongs to the program.
# shellcheck shell=bash disable=SC2034

set -euo pipefail

vbond_root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")

vbond_build_packages=(
  g++ cmake ninja-build
  libcli11-dev          # command line
  libmicrohttpd-dev     # the page of a run that goes on
  libfmt-dev            # text
  libtomlplusplus-dev   # case files
  nlohmann-json3-dev    # run.json
  libhdf5-dev           # checkpoints
  zlib1g-dev            # the report page
  libassimp-dev         # walls: STL, OBJ, PLY
  voro++-dev            # Voronoi cells of packings
  libsuitesparse-dev libopenblas-pthread-dev  # statics: sparse factors
  libeigen3-dev libspectra-dev                # statics: matrices, eigenvalues
  libceres-dev                                # statics: vbond fit
)
vbond_petsc_packages=(libpetsc-real-dev libhdf5-openmpi-dev pkg-config)  # multigrid, in ./test --petsc
vbond_test_packages=(libgtest-dev librapidcheck-dev python3-pytest)
vbond_lammps_packages=(liblammps-dev lammps libopenmpi-dev mpi-default-bin)   # vbond-lammps; CMake files of the first name the program of the second
vbond_python_packages=(pybind11-dev python3-dev python3-numpy)
vbond_python_test_packages=(python3-pytest python3-matplotlib python3-pandas jupyter-nbconvert python3-ipykernel)
vbond_python=/usr/bin/python3   # Debian's packages are for this one
vbond_python_options=(-D VBOND_PYTHON=ON -D "Python3_EXECUTABLE=$vbond_python")
vbond_site_packages=(doxygen furo pandoc python3-sphinx python3-myst-parser python3-nbsphinx python3-sphinx-copybutton)   # tools/site
vbond_clang_packages=(clang-14 libclang-rt-14-dev)   # the fuzzers, in .ci/nightly
vbond_format_packages=(clang-format-14)
vbond_package_packages=(dpkg-dev file xz-utils)   # tools/package
vbond_page_packages=(nodejs npm)   # the page that `vbond report` fills

say() { printf 'vbond: %s\n' "$*" >&2; }
die() { say "$@"; exit 1; }

# For --yes: packages are installed with sudo without a question.
install_unasked=

# may_use_sudo PACKAGE...: asks whoever sits at a terminal; elsewhere nobody could answer.
may_use_sudo() {
  [[ ! $install_unasked && -t 0 && -t 2 ]] || return 0
  say "these packages are missing: $*"
  local answer=
  read -r -p "vbond: install them with 'sudo apt-get install'? [y/N] " answer || true
  [[ ${answer,,} == y || ${answer,,} == yes ]]
}

# need PACKAGE...: installs those that are missing. Where there is no dpkg the packages are not
# checked: CMake then names what it cannot find.
need() {
  command -v dpkg-query >/dev/null || return 0
  local package installed missing=()
  # Fails when a package was never heard of, which here only means that it is missing.
  installed=$(dpkg-query --show --showformat='${db:Status-Status}:${Package} ' "$@" 2>/dev/null) || true
  for package in "$@"; do
    [[ " $installed" == *" installed:$package "* ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0

  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      die "these packages are missing: ${missing[*]}" $'\n' \
        " Installing them needs root, and there is no sudo here. As root, run:" $'\n' \
        "   apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    may_use_sudo "${missing[@]}" || die "nothing was installed; as root, run:" $'\n' \
      "   apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  command -v apt-get >/dev/null || die "these packages are missing, and there is no apt-get: ${missing[*]}"

  say "installing ${missing[*]}"
  mkdir -p "$vbond_root/build"
  local log=$vbond_root/build/install.log
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
    apt-get install --yes --no-install-recommends "${missing[@]}")
  # Package lists may be absent or stale. One broken source among them need not matter, so it is
  # installing that decides.
  "${as_root[@]}" apt-get update >"$log" 2>&1 || true
  if ! "${install[@]}" >>"$log" 2>&1; then
    tail -n 30 "$log" >&2
    die "the packages above could not be installed; the whole log is $log"
  fi
}

# build PRESET [TARGET...]: configures when needed, with $configure_options, and builds into build/PRESET.
# Silent on success; on failure the output is shown. Two calls at once take turns.
configure_options=()
build() {
  local preset=$1
  shift
  local dir=$vbond_root/build/$preset
  local log=$dir/build.log stamp=$dir/.configured
  mkdir -p "$dir"
  exec {lock}>"$dir/.lock"
  if ! flock --nonblock "$lock"; then
    say "waiting for another build in $dir"
    flock "$lock"
  fi
  discard_build_of_other_tree "$dir"
  local options=()
  mapfile -t options < <(all_options "$stamp")
  if [[ ! -e $stamp || $vbond_root/CMakePresets.json -nt $stamp || $(cat "$stamp") != "${options[*]-}" ]]; then
    say "configuring $dir"
    (cd "$vbond_root" && cmake --preset "$preset" "${options[@]}") >"$log" 2>&1 || build_failed "$log"
    printf '%s\n' "${options[*]-}" >"$stamp"
  fi
  # told once it takes seconds: ninja's dry run takes each glob for changed, and so cannot tell whether there is work
  local note failed=
  say_after 2 "building in $dir (minutes, the first time)" &
  note=$!
  cmake --build "$dir" ${1:+--target "$@"} >"$log" 2>&1 || failed=yes
  kill "$note" 2>/dev/null || true
  wait "$note" 2>/dev/null || true
  [[ ! $failed ]] || build_failed "$log"
  exec {lock}>&-
}

# say_after SECONDS TEXT...: without a process beside the shell that would outlive it.
say_after() {
  local never
  exec {never}<> <(:)
  read -r -t "$1" -u "$never" || say "${@:2}"
}

# all_options STAMP: those that a build was configured with before, and $configure_options, which come first, in lines of
# -DNAME=VALUE. What one call asked for stays for the next: ./run --python and ./test take turns in one build.
all_options() {
  local option
  local -A seen=()
  for option in "${configure_options[@]}" $(cat "$1" 2>/dev/null); do
    option=${option#-D}
    [[ $option == *=* && ! ${seen[${option%%=*}]-} ]] || continue
    seen[${option%%=*}]=yes
    printf '%s\n' "-D$option"
  done | sort
}

# A tree that was copied or moved with its build folder would compile the sources it came from: CMake keeps
# their place. The folder's lock stays.
discard_build_of_other_tree() {
  local dir=$1 sources
  sources=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$dir/CMakeCache.txt" 2>/dev/null) || true
  [[ -n $sources && ! $sources -ef $vbond_root ]] || return 0
  say "$dir was built from the sources in $sources: building it anew from those here"
  find "$dir" -mindepth 1 -maxdepth 1 ! -name .lock -exec rm -rf {} +
}

# build_page: bundles web/ into build/page/report.html when its sources have changed.
# Only `vbond report` needs it, so that a failure is told and nothing more. It is told once and remembered for a day:
# a machine without node, npm or a registry for npm must not lose time with each run.
page_failed=$vbond_root/build/page/.failed
build_page() {
  local dir=$vbond_root/build/page sources seconds=5 why=
  mkdir -p "$dir"
  ! page_is_built || return 0
  sources=$(page_sources)
  ! page_failed_lately "$sources" || return 0
  has_node || seconds=40
  say "building the page for reports (npm, about $seconds s, once)"
  # packages first, and outside of the log: need may ask
  if ! has_node && ! (need "${vbond_page_packages[@]}"); then
    why="nodejs and npm could not be installed"
  elif ! (page_packages "$dir/build.log"); then
    why="npm cannot get the page's packages from its registry ($dir/build.log)"
  elif ! (bundle_page "$dir/build.log"); then
    why="it takes node 18 or newer ($dir/build.log)"
  else
    printf '%s\n' "$sources" >"$dir/.sources"
    rm -f "$page_failed"
    return 0
  fi
  printf '%s\n' "$sources" >"$page_failed"
  say "the page was not built: $why; 'vbond report' will not work until then" $'\n' \
    " ./run and ./test do not try again for a day; to try again at once: $vbond_root/tools/package page"
}

has_node() { command -v node >/dev/null && command -v npm >/dev/null; }

page_sources() {
  (cd "$vbond_root/web" && cat package-lock.json .npmrc build.mjs page.html page.css src/*.js | sha256sum)
}

page_is_built() {
  local dir=$vbond_root/build/page
  [[ -s $dir/report.html && $(cat "$dir/.sources" 2>/dev/null) == "$(page_sources)" ]]
}

# page_failed_lately SOURCES: within a day, for these sources, and nobody has brought the packages since.
page_failed_lately() {
  [[ $(cat "$page_failed" 2>/dev/null) == "$1" && -n $(find "$page_failed" -mmin -1440) ]] || return 1
  [[ ! $vbond_root/web/node_modules/.package-lock.json -nt $page_failed ]]
}

# page_packages LOG: npm's packages for the page, from npm's cache or its registry. npm itself waits for more than a
# minute where no registry answers: a small request, which must not come from the cache, asks that first.
page_packages() {
  exec >"$1" 2>&1
  command -v flock && { exec {lock}>"$1.lock"; flock "$lock"; }
  cd "$vbond_root/web" || return
  [[ ! node_modules/.package-lock.json -nt package-lock.json ]] || return 0
  local install=(npm ci --ignore-scripts --omit=dev --fetch-retries=1 --fetch-retry-mintimeout=1000)
  "${install[@]}" --offline && return 0
  echo "not all packages are in npm's cache; whether its registry answers:"
  local empty_cache
  empty_cache=$(mktemp -d) || return
  timeout 15 npm view d3-scale-chromatic version --cache "$empty_cache" --fetch-retries=0 --fetch-timeout=5000
  local status=$?
  rm -rf -- "$empty_cache"
  ((status == 0)) && "${install[@]}"
}

# bundle_page LOG: the page from its sources and packages.
bundle_page() {
  exec >>"$1" 2>&1
  command -v flock && { exec {lock}>"$1.lock"; flock "$lock"; }
  cd "$vbond_root/web" && node build.mjs
}

build_failed() {
  # Ninja ends with what failed; a long log is mostly what did not.
  tail -n 200 "$1" >&2
  die "the build failed; the whole log is $1 (see docs/install.md)"
}
