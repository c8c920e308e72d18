# Sourced by the tests of the program: reports, expectations and a few readers of its output.
# Only what a bare Debian has: grep, sed, awk, cmp.
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

# number FILE KEY: the first number of that key in a JSON file with one key per line.
number() {
  sed -n 's/^ *"'"$2"'": \([-+.0-9eE]*\),\{0,1\}$/\1/p' "$1" | head -n 1
}

# holds EXPRESSION: a relation between numbers, as awk understands it; false for anything missing.
holds() {
  awk "BEGIN { exit !($1) }" 2>/dev/null || return 1
}

# column FILE NAME: all values of a column of a CSV file.
column() {
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) c = i; next } c { print $c }' "$1"
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

# run_example PROGRAM CASE [KEY=VALUE...]: as it is shipped it has no mistakes, and with these changes it runs to its
# end, into NAME.out; the energy balance error stays below 1e-3 where it moves, and below 1e-9 where it breaks at rest.
run_example() {
  local out error at_rest stages static moves change changes=()
  out=$(basename "$2" .toml).out
  for change in "${@:3}"; do changes+=(--set "$change"); done
  expect 0 "$1" check "$2"
  says out "no mistakes found"
  expect 0 "$1" run "$2" -o "$out" "${changes[@]}"
  error=$(number "$out/run.json" energy_balance_error)
  stages=$(grep -c '^\[\[stage\]\]' "$2")
  static=$(grep -cE '^kind = "(equilibrium|path|buckling|modes|fracture)"' "$2") || true
  moves=$((stages > static))
  holds "($error > 0) == $moves && $error < 1e-3" || fail "$2: energy balance error '$error', expected below 1e-3"
  while read -r at_rest; do
    holds "$at_rest < 1e-9 && $at_rest > -1e-9" || fail "$2: energy balance error at rest '$at_rest'"
    echo "$2: error of the energy balance at rest: $at_rest"
  done < <(sed -n 's/^ *"balance_error": \([^,]*\),\{0,1\}$/\1/p' "$out/run.json")
  [[ $(grep -c '"balance_error"' "$out/run.json") == "$(grep -c '^kind = "fracture"' "$2")" ]] ||
    fail "$2: energy balance of a fracture stage is missing"
  [[ $(grep -cE '"(stop|ended)"' "$out/run.json") == "$stages" ]] || fail "$2: a stage is missing"
  ! grep -q '"failed"' "$out/run.json" || fail "$2: a stage has failed"
  echo "$2: largest error of the energy balance: $error"
}
