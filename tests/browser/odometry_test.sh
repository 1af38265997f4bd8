#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the page of an odometry run in a headless browser and lets it test itself
# (odometry.html#selftest): it must load without an error, the slider must lead to the frames' images
# and landmarks, whose numbers must be those of frames.csv, and a copy of the page whose images are
# damaged or whose slider leads nowhere must fail.
# usage: odometry_test.sh PROSPECT WRITE_STEREO_RECORDING. Exit code 77: no browser, skipped.
set -euo pipefail
prospect="$1"
write_recording="$2"
source "$(dirname "${BASH_SOURCE[0]}")/self_testing_page.sh"
frames=30
"$write_recording" "$folder/recording" "$frames" 20
"$prospect" odometry "$folder/recording" --calibrate --out "$folder/out" >/dev/null

for size in 1400,1000 600,900; do
  seen="$(selftest "$folder/out/odometry.html" "$size")"
  grep -qx "selftest passed" <<<"$seen" || fail "the self-test at $size does not pass" "$seen"
done
grep -q "plots 4 images $frames circles [1-9]" <<<"$seen" || fail "not every frame has its image" "$seen"
for k in 0 $((frames / 2)) $((frames - 1)); do
  # Columns of frames.csv: frame 1, tracked 7, new 9. At the first frame all that is
  # tracked is new; later the page counts both kinds.
  expected="$(awk -F, -v k="$k" '$1 == k { printf "frame %d image %d tracked %d new %d", k, k, k == 0 ? $7 : $7 + $9, $9 }' "$folder/out/frames.csv")"
  grep -qF "$expected" <<<"$seen" || fail "the page does not show '$expected'" "$seen"
done

# A run of one frame, without truth, has a page.
"$write_recording" "$folder/one" 1
rm "$folder/one/poses.txt"
"$prospect" odometry "$folder/one" --calibrate --out "$folder/one_out" >/dev/null
seen="$(selftest "$folder/one_out/odometry.html")"
grep -qx "selftest passed" <<<"$seen" || fail "the page of one frame does not pass" "$seen"

sed 's/$("slider").addEventListener("input"/$("slider").addEventListener("nothing"/' "$folder/out/odometry.html" >"$folder/dead.html"
cmp -s "$folder/out/odometry.html" "$folder/dead.html" && fail "the slider's listener was not found in the page"
seen="$(selftest "$folder/dead.html")"
grep -qx "selftest failed" <<<"$seen" || fail "a page with a dead slider passes" "$seen"
sed 's/"jpeg":"\/9j\//"jpeg":"AAAA/g' "$folder/out/odometry.html" >"$folder/blind.html"
cmp -s "$folder/out/odometry.html" "$folder/blind.html" && fail "no image was found in the page"
seen="$(selftest "$folder/blind.html")"
grep -qx "selftest failed" <<<"$seen" || fail "a page without images passes" "$seen"
echo "passed: the page loads without errors and shows what frames.csv says"
