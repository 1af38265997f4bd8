#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What every release has written is read today: problem files, run folders, logs, studies (releases/VERSION/).
#   formats_test.sh <source tree> <prospect> <scratch folder>
set -uo pipefail
root="$1" prospect="$2" work="$3"
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"

releases=0
for release in "$root"/releases/*/; do
  name="$(basename "$release")"
  here="$work/$name"
  cp -r "$release" "$here"
  releases=$((releases + 1))
  # Its planning problem: the same size, and the optimum that the release has found, whatever solves it now.
  run "$prospect" solve "$here/problem.h5" --solver sqp
  read -r variables constraints cost <"$here/problem.txt"
  ((code == 0)) && [[ "$out" == *"$variables variables, $constraints constraints"* ]] || fail "$name: problem.h5: exit $code: $out $err"
  awk -v expected="$cost" '$1 == "sqp" && NF > 3 && !found { found = 1; bad = ($2 - expected > 1e-3) }
    END { exit !(found && !bad) }' "$work/out" || fail "$name: problem.h5: no cost of at most $cost: $out"
  # Its run: figures, its configuration, the mission again. (Plans may be others by now: exit code 1, and it says so.)
  run "$prospect" report "$here/run" --figure path,map --format svg --out "$here/figures"
  ((code == 0)) && [[ -s "$here/figures/path.svg" && -s "$here/figures/map.svg" ]] || fail "$name: run: exit $code: $err"
  run "$prospect" config "$here/run/config.yaml"
  ((code == 0)) || fail "$name: run/config.yaml: exit $code: $err"
  run "$prospect" replay "$here/run" --quiet --out "$here/replay"
  ((code <= 1)) && [[ "$out$err" == *"6 steps"* ]] || fail "$name: replay: exit $code: $out $err"
  # Its log: the page, and what it holds.
  run "$prospect" report "$here/run/mission.mcap" --out "$here/log"
  ((code == 0)) && [[ -s "$here/log/mission.html" ]] || fail "$name: run/mission.mcap: exit $code: $err"
  # Its study: both missions are gathered without being run again, by what the defaults were then.
  echo "base: $name-defaults.yaml" >>"$here/study.yaml"
  cp "$root/tests/releases/$name-defaults.yaml" "$here/"
  run "$prospect" study "$here/study.yaml" --out "$here/study" --gather --any-version
  ((code == 0)) && [[ "$out" == *"2 runs, 0 failed, 0 missing"* ]] || fail "$name: study: exit $code: $out $err"
  [[ "$(wc -l <"$here/study/results.csv")" == 3 ]] || fail "$name: study/results.csv has other rows than its two"
done
((releases > 0)) || fail "releases/ holds none"

((failures == 0)) && echo "formats of $releases releases: all checks pass"
exit "$((failures > 0))"
