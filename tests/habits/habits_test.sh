#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What the pages at the top of the project say is so, and files of other programs are in their form.
#   habits_test.sh <source tree> <build tree> <scratch folder>
set -uo pipefail
root="$1" build="$2" work="$3"
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"
here="$(dirname "${BASH_SOURCE[0]}")"
truth() { /usr/bin/python3 -B "$here/pages_tell_truth.py" "$root" "$build" "$@"; }

truth "$root"/{CONTRIBUTING,SECURITY,CHANGELOG}.md || fail "a page names what is not there"

# And it would be noticed.
cat >"$work/page.md" <<'PAGE'
[gone](gone.md) `engine/gone.h` `ctest --test-dir build -R no_such_test`
```sh
scripts/gone
cmake --build build --target no_such_target && ctest --test-dir build -L no_such_room
cmake --preset no_such_preset
```
PAGE
truth "$work/page.md" 2>"$work/err" && fail "a page that names what is not there passes"
for name in gone.md engine/gone.h no_such_test scripts/gone no_such_target no_such_room no_such_preset; do
  grep -q "$name" "$work/err" || fail "$name is not missed: $(<"$work/err")"
done

/usr/bin/python3 - "$root" <<'PYTHON' || fail "a file of another program is not in its form"
import glob, json, re, sys
root = sys.argv[1]
container = json.load(open(f"{root}/.devcontainer/devcontainer.json"))
assert "debian:12" in container["image"] and "scripts/setup" in container["postCreateCommand"], container
templates = glob.glob(f"{root}/.github/ISSUE_TEMPLATE/*.md")
assert len(templates) >= 2, templates
for template in templates:
    assert re.match(r"---\nname: .+\nabout: .+\n---\n", open(template).read()), template
citation = open(f"{root}/CITATION.cff").read()
for key in "cff-version: 1.2.0", "title: ", "message: ", "license: Apache-2.0", "authors:\n  - ":
    assert key in citation, key
assert "WarningsAsErrors: '*'" in open(f"{root}/.clang-tidy").read()
PYTHON

# clang-tidy: what passes passes, and what does not is told.
if command -v clang-tidy >/dev/null; then
  "$root/scripts/tidy" models >"$work/out" 2>&1 || fail "scripts/tidy models: $(tail -n 5 "$work/out")"
  mkdir -p "$work/tidy/scripts" "$work/tidy/models"
  cp "$root/scripts/tidy" "$work/tidy/scripts/"
  cp "$root/.clang-tidy" "$work/tidy/"
  echo '#include <string>' >"$work/tidy/models/good.cc"
  cp "$work/tidy/models/good.cc" "$work/tidy/models/bad.cc"
  echo 'bool none(const std::string& s) { return s.size() == 0; }' >>"$work/tidy/models/bad.cc"
  ! "$work/tidy/scripts/tidy" models >"$work/out" 2>&1 && grep -q 'models/bad.cc:2:.*readability-container-size-empty' "$work/out" ||
    fail "a fault is not told: $(<"$work/out")"
else
  echo "habits: no file is tidied: no clang-tidy"
fi

# Pictures of the pages: each is made by the script, which says what it cannot do and makes what it can.
for picture in "$root"/docs/images/*; do
  name="$(basename "$picture")"
  [[ "$name" =~ ^camera_(office|warehouse)_(left|right|depth)\.jpg$ ]] || grep -q " $name$" "$root/scripts/pictures" ||
    fail "$name is made by no script"
done
"$root/scripts/pictures" --build "$work/none" 2>"$work/err" && fail "pictures of no program"
grep -q "none/prospect: no such program; expected a build tree" "$work/err" || fail "no program: $(<"$work/err")"
"$root/scripts/pictures" --only none --build "$build" --out "$work" 2>"$work/err" && fail "a picture that is none"
if command -v chromium >/dev/null; then
  grep -q "'none'; expected report, go, map or cameras" "$work/err" || fail "a picture that is none: $(<"$work/err")"
  "$root/scripts/pictures" --only go --build "$build" --out "$work/pictures" >/dev/null || fail "scripts/pictures --only go"
  cmp -s <(head -c 8 "$work/pictures/go_where_it_is_told.png") <(printf '\x89PNG\r\n\x1a\n') || fail "no picture was made"
else
  echo "habits: no picture is made: no Chromium"
fi

# Key figures: the same build is no worse than itself; what has grown is marked.
mkdir -p "$work/tree/releases/0.0.9" "$work/tree/releases/0.0.10"
cp -r "$root/scripts" "$work/tree/"
figures="$work/tree/scripts/figures"
"$figures" --build "$build" --quick --out "$work/figures.csv" >"$work/out" 2>/dev/null || fail "figures without a release end with $?"
sed 's/^"program, start",ms of processor,.*,lower/"program, start",ms of processor,1e6,lower/' "$work/figures.csv" \
  >"$work/tree/releases/0.0.10/figures.csv"
printf 'figure,unit,value,better,tolerance_percent\n"program, size",MB,1e-3,lower,5\n' >"$work/tree/releases/0.0.9/figures.csv"
"$figures" --build "$build" --quick >"$work/out" 2>"$work/err" || fail "a build is worse than itself: $(<"$work/out")"
grep -q '| 0.0.10 | now |' "$work/out" || fail "not compared with the last release: $(<"$work/out")"
sed -i 's/MB,[^,]*,/MB,1e-3,/' "$work/tree/releases/0.0.10/figures.csv"
"$figures" --build "$build" --quick >"$work/out" 2>"$work/err" && fail "a program of more size passes"
grep -q '^| program, size .*\*\*worse\*\*' "$work/out" && grep -q '1 of 2 figures are worse' "$work/err" ||
  fail "a worse figure is not marked: $(<"$work/out")"

((failures == 0)) && echo "habits: all checks pass"
exit "$((failures > 0))"
