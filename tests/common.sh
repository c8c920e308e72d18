# Sourced by the tests of ranks and of the plugin, which are of the shell: reports, expectations, readers of output.
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
