#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What takes long: it shows its progress, and ends soon when it is interrupted, with what is whole.
#   long_steps_test.sh <prospect> <scratch directory> <write_depth_recording> <write_stereo_recording>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
write_depth_recording="$(realpath "$3")"
write_stereo_recording="$(realpath "$4")"
mkdir -p "$2"
work="$(mktemp -d "$2/long.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

timed_out "problems to solve" explore office --time-limit 5 --seed 3 --quiet --out saved --save-problems 4
succeeds "best costs" bench saved/problems --solver nlopt --deadline 0 --repeat 1 --out kept --keep-best
cat >hut.stl <<'STL'
solid hut
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 6 0 0
vertex 6 6 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 6 6 0
vertex 0 6 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 6 0 0
vertex 6 0 2
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 6 0 2
vertex 0 0 2
endloop
endfacet
endsolid hut
STL

# --- Interrupted: it ends soon, with what is whole.
# interrupt SECONDS ARGUMENT...: is sent SIGINT after so long; leaves $out, $err.
interrupt() {
  local after="$1" process
  shift
  "$prospect" "$@" >out.txt 2>err.txt </dev/null &
  process=$!
  sleep "$after"
  # Again and again: a shell without a terminal starts it with the signal ignored, until it has its own handler.
  for _ in {1..200}; do
    kill -INT $process 2>/dev/null || break
    sleep 0.1
  done
  if kill -KILL $process 2>/dev/null; then fail "$*: still runs 20 s after an interrupt"; fi
  wait $process
  code=$?
  out="$(<out.txt)"
  err="$(<err.txt)"
  ((code == 4)) || fail "$*, interrupted: exit $code, expected 4; '$err'"
}
# The same of what says so, in one line.
interrupted() {
  interrupt "$@"
  # A build with changes says so, which is no matter here.
  err="$(grep -v '^prospect: built from files that differ' err.txt)" && printf '%s\n' "$err" >err.txt
  (($(wc -l <err.txt) == 1)) || fail "$*, interrupted: not one line: '$err'"
}
interrupted 1 solve corridor@99999 --solver sampling
[[ "$err" == "prospect: cancelled" && -z "$out" ]] || fail "solve, interrupted: '$out' '$err'"
endless=(--solver nlopt:GN_ISRES,tolerance=0 --max-evaluations 100000000 --repeat 1)
interrupted 2 bench zoo "${endless[@]}" --deadline 0.5 --out bench_cut
[[ "$err" =~ ^"prospect: cancelled; "([0-9]+)" of 13 problems are in bench_cut; --resume goes on"$ ]] || fail "bench, interrupted: '$err'"
solved="${BASH_REMATCH[1]:-0}"
((solved >= 1 && solved < 11)) || fail "bench, interrupted: $solved problems"
(($(wc -l <bench_cut/bench.csv) == 1 + solved)) || fail "bench.csv of $solved problems: $(<bench_cut/bench.csv)"
grep -q '"cancelled": true' bench_cut/bench.json || fail "bench.json does not say that it was cancelled"
(($(grep -c '"best_known_by":' bench_cut/bench.json) == solved)) || fail "bench.json has other problems than bench.csv"
grep -q '^all, \|^zoo, ' out.txt || fail "bench, interrupted: no table in '$out'"
interrupted 1 bench zoo "${endless[@]}" --deadline 30 --out bench_none
[[ "$err" == *"before the first problem was done; --resume goes on" && "$(ls bench_none)" == rows.jsonl ]] || fail "bench, interrupted at once: '$err'"
cp saved/problems/best_known.json known_before.json
interrupted 1.5 bench saved/problems "${endless[@]}" --deadline 1 --out bench_cut --keep-best --overwrite
(($(grep -c '"step_' saved/problems/best_known.json) == 3)) || fail "an interrupted bench loses best costs: $(<saved/problems/best_known.json)"
cp known_before.json saved/problems/best_known.json
interrupted 2 bench --capture cut_set
[[ "$err" == "prospect: cancelled; the set lacks problems" && "$out" == "$(find cut_set -name '*.h5' | wc -l) problems in cut_set" ]] ||
  fail "bench --capture, interrupted: '$out' '$err'"
[[ -z "$(find cut_set -type f ! -name "*.h5" ! -name .prospect)" ]] || fail "bench --capture, interrupted, left $(ls cut_set)"
if (($(find cut_set -name '*.h5' | wc -l) > 0)); then
  succeeds "what was captured is whole" bench cut_set --solver sampling --max-evaluations 50 --deadline 0 --repeat 1 --out bench_cut --overwrite
fi
interrupted 1 bench missions --solver sampling --out bench_none
[[ "$err" == "prospect: cancelled" && "$(ls bench_none)" == rows.jsonl ]] || fail "bench missions, interrupted: '$err'"
interrupt 2 explore office --quiet --out cut_mission
grep -q '"reason": "cancelled"' cut_mission/summary.json || fail "a mission, interrupted: '$out' '$err'"
printf 'worlds: office\nseeds: 1..2\n' >cut.yaml
interrupted 1 study cut.yaml --quiet --out cut_study
[[ "$err" == "prospect: broken off; the same command goes on" ]] || fail "a study, interrupted: '$err'"

# --- Progress: one line, on a terminal only, and not if told to be quiet.
# on_terminal COMMAND: what it writes where standard error is a terminal, with carriage returns as line ends.
# A set that is captured says so from the start: it need not come to its end.
on_terminal() {
  local limit=""
  [[ $1 != *--capture* ]] || limit="timeout --foreground --signal INT 3"
  script -qec "TERM=xterm NO_COLOR=1 $limit $(printf %q "$prospect") $1" /dev/null </dev/null | tr '\r' '\n' >shown.txt
}
if command -v script >/dev/null; then
  "$write_stereo_recording" stereo 12 || fail "no stereo recording was written"
  "$write_depth_recording" depth || fail "no depth recording was written"
  for call in "solve office@4 --solver sampling|office@4: step [0-9] of 4, " \
    "bench --capture shown_set --quick|driving in office: step [0-9]* of " \
    "bench zoo --solver sampling --deadline 0 --repeat 1 --out bench_cut --overwrite|13 of 13 solves" \
    "odometry stereo|12 of 12 frames  [0-9]* points" "map depth/posed|5 of 5 frames  ground found" \
    "explore hut.stl --time-limit 1 --out told|voxels of hut.stl: 0 of 4 triangles" \
    "explore office --time-limit 1 --out told|making the robot ready in office" \
    "explore office --time-limit 1 --out told|[0-9] features"; do
    on_terminal "${call%%|*}"
    if [[ $call == *hut.stl* ]] && grep -q 'not built in' shown.txt; then continue; fi  # meshes
    grep -q "^${call#*|}\|${call#*|}" shown.txt || fail "${call%%|*}: no progress like '${call#*|}' in '$(<shown.txt)'"
    rm -rf shown_set
    on_terminal "${call%%|*} --quiet"
    ! grep -q "${call#*|}" shown.txt || fail "${call%%|*} --quiet: shows progress"
    rm -rf shown_set
  done
else
  echo "skipped: progress on a terminal: no script(1) here"
fi
run solve office@4 --solver sampling
[[ -z "$err" ]] || fail "solve writes progress to a file: '$err'"
finish
