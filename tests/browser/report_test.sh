#!/usr/bin/env bash
# Opens a report in a headless browser and lets it test itself (report.html#selftest): it must load
# without an error, and moving the slider must move what is drawn. The positions that the browser
# reports are compared with those of the run itself, and a copy of the page whose slider leads
# nowhere must fail.
# usage: report_test.sh WRITE_SAMPLE_REPORT. Exit code 77: no browser, skipped.
set -euo pipefail
write_sample_report="$1"
browser=""
for name in chromium chromium-browser google-chrome; do
  if command -v "$name" >/dev/null; then browser="$name"; break; fi
done
if [[ -z "$browser" ]]; then
  echo "skipped: no Chromium here; scripts/setup --browser installs it"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
"$write_sample_report" "$folder"

# What the self-test wrote into the page, as plain lines. A new profile each time, as a browser
# refuses one that is in use; the network switches keep it from calling out.
selftest() {
  local profile
  profile="$(mktemp -d "$folder/profile.XXXXXX")"
  timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --disable-extensions \
    --user-data-dir="$profile" --window-size="${2:-1400,1000}" --dump-dom "file://$1#selftest" 2>"$folder/browser.log" |
    sed -n '/<pre id="selftest">/,/<\/pre>/p' | sed -e 's/.*<pre id="selftest">//' -e 's/<\/pre>.*//'
}
fail() {
  echo "FAILED: $1"
  echo "the page says:"; sed 's/^/  /' <<<"${2:-nothing}"
  grep -a CONSOLE "$folder/browser.log" || true
  exit 1
}

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
