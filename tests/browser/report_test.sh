#!/usr/bin/env bash
# Opens a report in a headless browser and lets it test itself (report.html#selftest): it must load
# without an error, and moving the slider must move what is drawn. The positions that the browser
# reports are compared with those of the run itself, and a copy of the page whose slider leads
# nowhere must fail.
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

sed 's/\$("slider").addEventListener("input"/$("slider").addEventListener("nothing"/' "$folder/report.html" >"$folder/dead.html"
cmp -s "$folder/report.html" "$folder/dead.html" && fail "the slider's listener was not found in the page"
seen="$(selftest "$folder/dead.html")"
grep -qx "selftest failed" <<<"$seen" || fail "a page with a dead slider passes" "$seen"
echo "passed: the page loads without errors and its slider moves the robot"
