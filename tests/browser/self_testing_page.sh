# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# For tests of pages that test themselves (PAGE.html#selftest): finds a browser, or skips the test
# with exit code 77; makes $folder, which goes when the test ends; defines selftest and fail.
browser=""
for name in chromium chromium-browser google-chrome; do
  if command -v "$name" >/dev/null; then browser="$name"; break; fi
done
if [[ -z "$browser" ]]; then
  echo "skipped: no Chromium here; scripts/setup --tests installs it"
  exit 77
fi
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT

# What the self-test wrote into the page, as plain lines. A new profile each time, as a browser
# refuses one that is in use; the network switches keep it from calling out. $switches
# holds more of them.
switches=()
selftest() {
  local profile
  profile="$(mktemp -d "$folder/profile.XXXXXX")"
  timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --disable-extensions \
    "${switches[@]}" \
    --user-data-dir="$profile" --window-size="${2:-1400,1000}" --dump-dom "file://$1#selftest" 2>"$folder/browser.log" |
    sed -n '/<pre id="selftest">/,/<\/pre>/p' | sed -e 's/.*<pre id="selftest">//' -e 's/<\/pre>.*//'
}
fail() {
  echo "FAILED: $1"
  echo "the page says:"; sed 's/^/  /' <<<"${2:-nothing}"
  grep -a CONSOLE "$folder/browser.log" || true
  exit 1
}
