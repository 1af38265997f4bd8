#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the page of `prospect map` in a headless browser and lets it test itself (map.html#selftest):
# with WebGL the voxels must be painted, turn, be cut and change colour; without it the page must say
# so and show the rest. What it shows of frames and cells must be what ground.csv and the maps say. A
# copy whose cut does nothing must fail.
# usage: map_test.sh PROSPECT WRITE_DEPTH_RECORDING. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
write_recording="$2"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"
"$write_recording" "$folder/depth"
"$prospect" map "$folder/depth/posed" --out "$folder/out" --resolution 0.1 --quiet >/dev/null
page="$folder/out/map.html"

# A browser without a graphics card draws in software.
switches=(--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader)
seen="$(selftest "$page")"
grep -qx "selftest passed" <<<"$seen" || fail "the self-test does not pass" "$seen"
grep -qE "^view [1-9][0-9]* voxels [1-9][0-9]* rectangles$" <<<"$seen" || fail "the page has no 3-D view" "$seen"
for k in 0 2 4; do
  # Columns of ground.csv: state 3, rays at obstacles 14, at the floor 15, beyond the range 16.
  expected="$(awk -F, -v k="$k" '$1 == k { printf "frame %d %s rays %d %d %d", k, $3, $14, $15, $16 }' "$folder/out/ground.csv")"
  grep -qxF "$expected" <<<"$seen" || fail "the page does not show '$expected'" "$seen"
done
free="$(sed -n 's/.*"free_cells": \([0-9]*\).*/\1/p' "$folder/out/summary.json")"
occupied="$(sed -n 's/.*"occupied_cells": \([0-9]*\).*/\1/p' "$folder/out/summary.json")"
grep -q "cells unknown [0-9]* free $free occupied $occupied" <<<"$seen" || fail "the page does not show $free and $occupied cells" "$seen"

sed 's/high.addEventListener("input", cut)/high.addEventListener("nothing", cut)/' "$page" >"$folder/dead.html"
cmp -s "$page" "$folder/dead.html" && fail "the cut's listener was not found in the page"
seen="$(selftest "$folder/dead.html")"
grep -qx "selftest failed" <<<"$seen" || fail "a page whose cut does nothing passes" "$seen"

# With loops there are two maps; #drawn leads to that of the poses alone.
"$prospect" map "$folder/depth/posed" --loops --out "$folder/loops" --resolution 0.1 --quiet >/dev/null
seen="$(selftest "$folder/loops/map.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the self-test with loops does not pass" "$seen"
grep -qx "shown with loops" <<<"$seen" || fail "the page does not open with loops" "$seen"
sed 's/drawn = straight.drawn !== undefined \&\& .*, run =/drawn = true, run =/' "$folder/loops/map.html" >"$folder/drawn.html"
seen="$(selftest "$folder/drawn.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the self-test of the map as drawn does not pass" "$seen"
grep -qx "shown as drawn" <<<"$seen" || fail "the page does not show the map as drawn" "$seen"

# On a phone, without WebGL.
switches=(--disable-3d-apis)
seen="$(selftest "$page" 500,900)"
grep -qx "selftest passed" <<<"$seen" || fail "the self-test without WebGL does not pass" "$seen"
grep -q "no view: This browser has no WebGL" <<<"$seen" || fail "the page does not say that it has no WebGL" "$seen"
echo "passed: the page loads without errors and shows what was mapped"
