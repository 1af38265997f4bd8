#!/usr/bin/env bash
# Opens the page of a bench in a headless browser and lets it test itself (bench.html#selftest): it
# must load without an error, draw every plot for every choice of set and deadline, and show as many
# solved problems as bench.csv has. A copy of the page that cannot draw must fail.
# usage: bench_test.sh PROSPECT. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
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
"$prospect" bench zoo s30 --quick --solver nlopt,sampling --deadline 0,0.05 --max-evaluations 2000 \
  --out "$folder/bench" >/dev/null

# What the self-test wrote into the page, as plain lines. A new profile each time, as a browser
# refuses one that is in use; the network switches keep it from calling out.
selftest() {
  local profile
  profile="$(mktemp -d "$folder/profile.XXXXXX")"
  timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --disable-extensions \
    --user-data-dir="$profile" --window-size=1400,1000 --dump-dom "file://$1#selftest" 2>"$folder/browser.log" |
    sed -n '/<pre id="selftest">/,/<\/pre>/p' | sed -e 's/.*<pre id="selftest">//' -e 's/<\/pre>.*//'
}
fail() {
  echo "FAILED: $1"
  echo "the page says:"; sed 's/^/  /' <<<"${2:-nothing}"
  grep -a CONSOLE "$folder/browser.log" || true
  exit 1
}

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
