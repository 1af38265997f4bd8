#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The site: made without a warning, no link leads nowhere, no page stands alone; in a browser the search finds, light
# and dark change, a phone need not scroll sideways. Skipped, and said so, without what scripts/setup --release installs.
#   site_test.sh <source tree> <prospect> <scratch folder>
set -uo pipefail
root="$1" prospect="$2" work="$3"
for tool in sphinx-build doxygen; do
  command -v "$tool" >/dev/null || { echo "site: skipped: no $tool (scripts/setup --release)"; exit 77; }
done
/usr/bin/python3 -c 'import furo, myst_parser, sphinx_copybutton' 2>/dev/null ||
  { echo "site: skipped: no furo, myst-parser or sphinx-copybutton (scripts/setup --release)"; exit 77; }
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"
here="$(realpath "$(dirname "${BASH_SOURCE[0]}")")"

"$prospect" explore corridor --seed 1 --time-limit 2 --quiet --out "$work/run" >/dev/null 2>&1
"$root/scripts/site" --out "$work/site" --report "$work/run/report.html" || { fail "the site is not made"; exit 1; }
/usr/bin/python3 "$here/site_links.py" "$work/site" || fail "links lead nowhere"
"$root/scripts/site" --out "$work/site" 2>"$work/err" && fail "a site is made over another"
grep -q "holds something; expected" "$work/err" || fail "a folder that is not empty: $(<"$work/err")"

# Versions beside each other: the one that is here, and an older one with a page less.
"$root/scripts/site" --out "$work/versions" --version ../x 2>"$work/err" && fail "a version that leads elsewhere passes"
mkdir -p "$work/versions/0.0.9"
echo '<p>old' >"$work/versions/0.0.9/index.html"
"$root/scripts/site" --out "$work/versions" --version 0.0.10 --without-api --report "$work/run/report.html" ||
  fail "a version of the site is not made"
grep -q 'url=0.0.10/index.html' "$work/versions/index.html" || fail "the newest version is not led to: $(<"$work/versions/index.html")"
grep -q '^window.prospectVersions = {"0.0.10": \[.*"index.html".*"0.0.9": \["index.html"\]};$' "$work/versions/versions.js" ||
  fail "versions: $(<"$work/versions/versions.js")"

# What is wrong would be seen.
mkdir "$work/wrong"
printf '<a href="b.html#none">b</a><a href="gone.html">c</a>' >"$work/wrong/index.html"
printf '<p id="some">' >"$work/wrong/b.html"
printf '<p>' >"$work/wrong/alone.html"
/usr/bin/python3 "$here/site_links.py" "$work/wrong" >/dev/null 2>"$work/err" && fail "broken links pass"
for problem in "b.html#none: no such anchor" "gone.html: no such file" "alone.html: no page leads there"; do
  grep -q "$problem" "$work/err" || fail "'$problem' is not told: $(<"$work/err")"
done

if ! command -v chromium >/dev/null; then
  echo "site: not opened: no chromium"
else
  # dom URL: the page as its scripts leave it.
  dom() {
    timeout 100 chromium --headless=new --no-sandbox --disable-gpu --user-data-dir="$work/browser" \
      --allow-file-access-from-files --virtual-time-budget=15000 --dump-dom "$1" 2>/dev/null
  }
  dom "file://$work/site/search.html?q=retreat" >"$work/found.html"
  grep -q 'reference/behaviour.html' "$work/found.html" || fail "the search does not find the page on behaviour"
  dom "file://$work/versions/0.0.10/docs/reference/report.html" >"$work/versioned.html"
  grep -q 'class="versions"[^>]*><option value="0.0.10"[^>]*>0.0.10</option><option value="0.0.9">' "$work/versioned.html" ||
    fail "a page offers no other version: $(grep -o '<select.*</select>' "$work/versioned.html")"
  cat >"$work/site/test.html" <<'PAGE'
<!doctype html><p id="result">none</p><script>
const pages = ["index", "reference/configuration", "tutorials/first_mission", "results/comparison"];
const result = document.getElementById("result");
const look = (page) => new Promise((done) => {
  const frame = document.createElement("iframe");
  frame.style.cssText = "width: 390px; height: 800px";
  frame.src = (page === "index" ? "" : "docs/") + page + ".html";
  frame.onload = () => setTimeout(() => {
    const inside = frame.contentDocument;
    const wide = inside.scrollingElement.scrollWidth;
    const said = [wide <= 390 ? "fits" : "is " + wide + " wide"];
    const colour = () => frame.contentWindow.getComputedStyle(inside.body).backgroundColor;
    const light = colour();
    inside.querySelector(".theme-toggle").click();
    said.push(colour() !== light && inside.body.dataset.theme === "dark" ? "darkens" : "stays " + colour());
    said.push(page === "index" || inside.querySelector("button.copybtn, td") ? "whole" : "nothing to copy");
    frame.contentWindow.localStorage.clear();
    frame.remove();
    done(page + " " + said.join(" "));
  }, 300);
  document.body.append(frame);
});
(async () => {
  const lines = [];
  for (const page of pages) lines.push(await look(page));
  result.textContent = lines.join("; ");
})();
</script>
PAGE
  dom "file://$work/site/test.html" >"$work/looked.html"
  expected=""
  for page in index reference/configuration tutorials/first_mission results/comparison; do
    expected+="${expected:+; }$page fits darkens whole"
  done
  grep -qF ">$expected<" "$work/looked.html" || fail "in a browser: $(grep -o 'id="result">[^<]*' "$work/looked.html")"
fi

((failures == 0)) && echo "site: all checks pass"
exit "$((failures > 0))"
