#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the comparison of two runs in a headless browser and lets it test itself: both maps follow
# one slider, and the page opens where the missions part. A copy whose slider leads nowhere must
# fail.
# usage: comparison_test.sh PROSPECT WRITE_SAMPLE_REPORT. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
write_sample_report="$2"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"

cd "$folder"
for seed in 3 4; do
  "$prospect" explore office --time-limit 12 --seed $seed --quiet --out "seed$seed" >/dev/null || (($? == 1))
done
"$prospect" report seed3 seed4 >/dev/null
page="$folder/seed3/compared_with_seed4.html"
for size in 1400,1000 600,900; do
  seen="$(selftest "$page" "$size")"
  grep -qx "selftest passed" <<<"$seen" || fail "the self-test at $size does not pass" "$seen"
  grep -q "^said They part at " <<<"$seen" || fail "it does not say where they part" "$seen"
done

# A run of a program that recorded neither modes nor targets is compared, too.
mkdir bare
"$write_sample_report" bare 60 bare
head -n 1 seed3/steps.csv >bare/steps.csv
"$prospect" report seed3 bare >/dev/null
seen="$(selftest "$folder/seed3/compared_with_bare.html")"
grep -qx "selftest passed" <<<"$seen" || fail "a comparison with an old run does not pass" "$seen"

sed 's/mission?.seek(/mission?.step(/' "$page" >dead.html
cmp -s "$page" dead.html && fail "the place to break was not found in the page"
seen="$(selftest "$folder/dead.html")"
grep -qx "selftest failed" <<<"$seen" || fail "a page whose slider moves no map passes" "$seen"
echo "passed: one slider moves both missions"
