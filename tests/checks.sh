# SPDX-License-Identifier: Apache-2.0
# What tests in shell share. Sourced; $work is the scratch folder of the test that does.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154
failures=0
fail() { echo "FAILED: $*" >&2; failures=$((failures + 1)); }
# run COMMAND...: leaves exit code, standard output and error in $code, $out, $err.
run() {
  code=0
  "$@" >"$work/out" 2>"$work/err" </dev/null || code=$?
  out="$(<"$work/out")"
  err="$(<"$work/err")"
}
