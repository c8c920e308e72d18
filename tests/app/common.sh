# Sourced by the tests of the program that are scripts, where shells and disks are what is tested: reports, expectations.
# shellcheck shell=bash

set -euo pipefail

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

# finish: the exit status of the test.
finish() {
  ((failures == 0)) && echo "passed"
  exit $((failures > 0))
}

# expect STATUS COMMAND...: runs it; its output is in $work/out and $work/err.
expect() {
  local expected=$1 status=0
  shift
  "$@" >"$work/out" 2>"$work/err" </dev/null || status=$?
  ((status == expected)) || fail "$*: status $status, expected $expected; it said: $(cat "$work/err")"
}

# says FILE TEXT...: each text stands in out or err of the last command.
says() {
  local file=$work/$1 text
  shift
  for text; do grep -qF -- "$text" "$file" || fail "no '$text' in: $(cat "$file")"; done
}

# without_times DIR: its run.json without what depends on the machine and its load.
without_times() {
  sed '/"bond_steps_per_second"/d; /"threads/d; /"instruction_set"/d; /"blas_kernel"/d; /"wall_time"/,/}/d' "$1/run.json"
}

# expect_same WHOLE OTHER [OPTION...]: two output folders hold the same but status.json, run.json but for wall times and what it was
# computed with; options are those of diff.
expect_same() {
  diff -rq --exclude=run.json --exclude=status.json "${@:3}" "$1" "$2" || fail "$2 differs from $1"
  diff <(without_times "$1") <(without_times "$2") || fail "$2/run.json differs from $1/run.json"
}
