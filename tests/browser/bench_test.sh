#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the page of a bench in a headless browser and lets it test itself (bench.html#selftest): it
# must load without an error, draw every plot for every choice of set and deadline, and show as many
# solved problems as bench.csv has. A copy of the page that cannot draw must fail.
# usage: bench_test.sh PROSPECT. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"
"$prospect" bench zoo s30 --quick --solver nlopt,sampling --deadline 0,0.05 --max-evaluations 2000 \
  --out "$folder/bench" >/dev/null

seen="$(selftest "$folder/bench/bench.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the self-test does not pass" "$seen"
# count SET DEADLINE SOLVER: how many of how many rows of bench.csv are solved.
count() {
  awk -F, -v set="$1" -v deadline="$2" -v solver="$3" '
    ($1 == set || set == "all") && NR > 1 && $5 == solver && ($6 == "" ? 0 : $6) == deadline { n++; solved += $11 }
    END { printf "%d of %d", solved, n }' "$folder/bench/bench.csv"
}
for set in all zoo s30; do
  for deadline in 0 0.05; do
    expected="$set $deadline solved $(count $set $deadline nlopt), $(count $set $deadline sampling) problems"
    grep -qF "$expected" <<<"$seen" || fail "the page does not show '$expected'" "$seen"
  done
done

sed 's/plot\.build(g)/plot.nothing(g)/' "$folder/bench/bench.html" >"$folder/dead.html"
cmp -s "$folder/bench/bench.html" "$folder/dead.html" && fail "the place to break was not found in the page"
seen="$(selftest "$folder/dead.html")"
! grep -qx "selftest passed" <<<"$seen" || fail "a page that cannot draw passes" "$seen"
echo "passed: the page loads without errors and shows what bench.csv says"
