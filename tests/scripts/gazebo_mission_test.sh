#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A short mission in the real Gazebo, stepped: the same steps beside busy loops as without, and its log gives the same
# plans.
# Skips where scripts/gazebo has not installed one, or nobody may start it.
#   gazebo_mission_test.sh <source tree> <prospect>
set -uo pipefail
root="$1" prospect="$2"
gazebo="${PROSPECT_GAZEBO:-$root/build/gazebo}"
skip() { echo "skipped: $1"; exit 77; }
[[ -x "$gazebo/usr/bin/gzserver" ]] || skip "no Gazebo in $gazebo (scripts/gazebo install)"
((EUID == 0)) || skip "root starts it"
work="$(mktemp -d)"
loops=()
end() {
  ((${#loops[@]} == 0)) || kill "${loops[@]}"
  loops=()
  "$root/scripts/gazebo" stop "$gazebo" 2>/dev/null
}
trap 'end; rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
export GAZEBO_MASTER_URI=http://127.0.0.1:11399

"$prospect" export corridor --sdf "$work/corridor.sdf" >/dev/null || fail "export"
drive() {
  "$root/scripts/gazebo" start --paused "$work/corridor.sdf" "$gazebo" >/dev/null || fail "start"
  for ((n = 0; n < $2; ++n)); do
    while :; do :; done &
    loops+=($!)
  done
  "$prospect" drive corridor --base gazebo --lockstep --measure --time-limit 3 --quiet --out "$work/$1" >"$work/$1.txt"
  code=$?
  end
  ((code == 1)) && grep -q 'time limit' "$work/$1.txt" || fail "drive $1: exit $code: $(head -n 2 "$work/$1.txt")"
}
drive alone 0
drive busy 6
cmp "$work/alone/steps.csv" "$work/busy/steps.csv" || fail "load has changed the mission"
(("$(wc -l <"$work/alone/steps.csv")" > 5)) || fail "hardly a step: $(<"$work/alone.txt")"
"$prospect" replay "$work/busy" | grep -q 'the same bits' || fail "its log gives other plans"

"$prospect" drive --base gazebo --lockstep --out "$work/none" 2>"$work/refused"
(($? == 2)) || fail "no Gazebo: $(<"$work/refused")"
echo "all passed"
