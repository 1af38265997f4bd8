#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens a report in a headless browser and lets it test itself (report.html#selftest): it must load
# without an error, and moving the slider must move what is drawn and said. The positions and
# sentences that the browser reports are compared with those of the run itself; copies of the page
# whose slider leads nowhere, whose sentence stands still or whose strip leads nowhere must fail.
# usage: report_test.sh WRITE_SAMPLE_REPORT. Exit code 77: no browser, skipped.
set -euo pipefail
write_sample_report="$1"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"
"$write_sample_report" "$folder"

for size in 1400,1000 600,900; do
  seen="$(selftest "$folder/report.html" "$size")"
  grep -qx "selftest passed" <<<"$seen" || fail "the self-test at $size does not pass" "$seen"
  difference="$(diff "$folder/expected.txt" <(grep -v '^selftest' <<<"$seen"))" ||
    fail "the browser at $size shows another run than the one written (< written, > shown):
$difference" "$seen"
done

# A mission that ended at its first step still has a report.
mkdir "$folder/short"
"$write_sample_report" "$folder/short" 1
seen="$(selftest "$folder/short/report.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the report of one step does not pass" "$seen"

# So has a run of a program that recorded neither modes nor targets nor candidates.
mkdir "$folder/bare"
"$write_sample_report" "$folder/bare" 60 bare
seen="$(selftest "$folder/bare/report.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the report without modes does not pass" "$seen"
! grep -qE "^(why|strip) " <<<"$seen" || fail "the report without modes shows some" "$seen"

# broken NAME FROM TO: a copy of the page in which something is broken.
broken() {
  sed "s/$2/$3/" "$folder/report.html" >"$folder/$1.html"
  cmp -s "$folder/report.html" "$folder/$1.html" && fail "the place to break ($1) was not found in the page"
  seen="$(selftest "$folder/$1.html")"
}
broken dead '$("slider").addEventListener("input"' '$("slider").addEventListener("nothing"'
grep -qx "selftest failed" <<<"$seen" || fail "a page with a dead slider passes" "$seen"
broken mute '$("why").textContent = ' '$("why").textContent ||= '
diff -q "$folder/expected.txt" <(grep -v '^selftest' <<<"$seen") >/dev/null && fail "a page whose sentence stands still passes" "$seen"
broken stuck 'box.addEventListener("click"' 'box.addEventListener("nothing"'
grep -qx "selftest failed" <<<"$seen" || fail "a page whose strip leads nowhere passes" "$seen"
echo "passed: the page loads without errors; its slider moves the robot and changes the sentence"
