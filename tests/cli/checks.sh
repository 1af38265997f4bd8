# SPDX-License-Identifier: Apache-2.0
# What the tests of the command line share. Sourced in the scratch folder that they run in; $prospect is the
# program. Each ends with `finish`.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154
source "${BASH_SOURCE[0]%/*}/../checks.sh"
# run ARGUMENT...: of the program; leaves exit code, standard output and error in $code, $out, $err.
run() {
  code=0
  "$prospect" "$@" >out.txt 2>err.txt </dev/null || code=$?
  out="$(<out.txt)"
  err="$(<err.txt)"
}
# succeeds WHAT ARGUMENT...
succeeds() {
  local what="$1"
  shift
  run "$@"
  ((code == 0)) || fail "$what: exit $code, expected 0; '$err'"
}
# timed_out WHAT ARGUMENT...: a mission that ran well until its time was up: its task is not done.
timed_out() {
  local what="$1"
  shift
  run "$@"
  ((code == 1)) || fail "$what: exit $code, expected 1: its time is up; '$err'"
  grep -q 'time limit' out.txt || fail "$what: no word of its time limit in '$out'"
}
# refused WHAT NAMED EXPECTED ARGUMENT...: bad input, whose message names the culprit and what was
# expected (both as fixed text), and which leaves nothing behind.
refused() {
  local what="$1" named="$2" expected="$3"
  shift 3
  run "$@"
  ((code == 2)) || fail "$what: exit $code, expected 2"
  [[ ! -s out.txt ]] || fail "$what: wrote to standard output: '$out'"
  [[ -s err.txt ]] || fail "$what: no message"
  ! grep -qv '^prospect: ' err.txt || fail "$what: a line without 'prospect: ' in '$err'"
  grep -F -- "$named" err.txt | grep -qF -- "$expected" ||
    fail "$what: no line with '$named' and '$expected' in '$err'"
  [[ ! -e run && ! -e runs ]] || fail "$what: left a run folder behind"
  rm -rf run runs
}
# finish: the exit code of the test.
finish() {
  ((failures == 0)) || { echo "$failures failed" >&2; exit 1; }
  echo "all as promised"
}
