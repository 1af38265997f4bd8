#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A replay's page in a headless browser: it opens at the step at which both plans end farthest apart and sums up what
# replay.csv says; of plans that are the same it says so.
# usage: replay_test.sh PROSPECT. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"

# dom PAGE [WIDTH,HEIGHT]: the page as its script leaves it.
dom() {
  timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
    --disable-background-networking --user-data-dir="$(mktemp -d "$folder/profile.XXXXXX")" --window-size="${2:-1400,1000}" \
    --dump-dom "file://$1" 2>"$folder/browser.log"
}
"$prospect" explore corridor --seed 3 --time-limit 6 --quiet --out "$folder/run" >/dev/null || (($? == 1))
"$prospect" replay "$folder/run" --solver sampling --quiet --out "$folder/other" >/dev/null
"$prospect" replay "$folder/run" --from 0 --to 4 --quiet --out "$folder/same" >/dev/null

# The largest horizon_ends_apart of the table, with its step.
read -r step apart < <(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "horizon_ends_apart") column = NF - i; next }
  { v = $(NF - column); if (v != "" && v + 0 > most) { most = v + 0; step = $1 } } END { printf "%d %.2f\n", step, most }' "$folder/other/replay.csv")
page="$(dom "$folder/other/replay.html")"
sum="$(grep -o '<p id="sum">[^<]*' <<<"$page")"
[[ "$sum" == *"at most $apart m, in step $step"* ]] || fail "the largest difference is $apart m in step $step" "$sum"
grep -q "<output id=\"clock\">[^<]*step $step</output>" <<<"$page" || fail "the page opens elsewhere than at step $step" "$(grep -o 'id="clock">[^<]*' <<<"$page")"
page="$(dom "$folder/same/replay.html" 390,800)"
grep -q 'The plans of all 5 steps are the same' <<<"$page" || fail "the same plans are summed up otherwise" "$(grep -o '<p id="sum">[^<]*' <<<"$page")"
echo "passed: the page opens at what differs most, and sums up"
