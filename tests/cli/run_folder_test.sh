#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What becomes of a run folder and a mission's log when something is in the way: another run, a signal, a kill, a
# full disk, an output that takes nothing.
#   run_folder_test.sh <prospect> <scratch directory>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$2/run_folder.XXXXXX")"
full="$work/full"
trap 'umount "$full" 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

# begun FOLDER: waits until a run has rows, 30 s at most.
begun() {
  for _ in {1..300}; do
    [[ -s $1/trajectory_true.tum ]] && return
    sleep 0.1
  done
  fail "$1: no row after 30 s"
}
# ended WHAT: waits for the process $process to end; leaves its code in $code.
ended() {
  for _ in {1..200}; do
    kill -0 $process 2>/dev/null || break
    sleep 0.1
  done
  if kill -KILL $process 2>/dev/null; then fail "$1: still runs after 20 s"; fi
  code=0
  wait $process || code=$?
}

# --- What it was started with is there at once; nobody else writes to the folder; a hang-up ends it whole.
"$prospect" drive office --time-limit 60 --seed 7 --quiet --out 'live run' >live.txt 2>live_err.txt &
process=$!
begun 'live run'
[[ ! -e 'live run/summary.json' ]] || fail "a summary of a run that goes on"
for fact in '"seed": 7' '"world": "office"' '"real_time": true' '"version": "' '"started": "20' \
  "drive office --time-limit 60 --seed 7 --quiet --out 'live run'\""; do
  grep -qF -- "$fact" 'live run/run.json' || fail "run.json of a run that goes on: no $fact"
done
grep -q 'time_limit: 60 ' 'live run/config.yaml' || fail "config.yaml of a run that goes on"
refused "a folder in use" "live run: another run writes to it" "expected a folder of its own" \
  explore office --time-limit 1 --quiet --out 'live run'
grep -q '"seed": 7' 'live run/run.json' || fail "the run that was there first lost its run.json"
kill -HUP $process
ended "a hang-up"
((code == 4)) || fail "a hang-up: exit $code, expected 4; '$(<live_err.txt)'"
grep -q '"reason": "cancelled"' 'live run/summary.json' || fail "a hang-up: $(<live.txt)"
for file in steps.csv report.html map.bt mission.mcap; do
  [[ -s live\ run/$file ]] || fail "a hang-up: no $file"
done
succeeds "the page of a log" report 'live run/mission.mcap' --out page
[[ -s page/mission.html && "$out" == page/mission.html ]] || fail "the page of a whole log: '$out'"
succeeds "inspect of a log" inspect 'live run/mission.mcap'
grep -qF "log of a mission" out.txt || fail "inspect of a log: '$out'"

# --- Who told it to ignore hang-ups means it; a kill leaves a log that is read as far as it goes.
(trap '' HUP; exec "$prospect" explore office --time-limit 3000 --mcap --quiet --out killed >killed.txt 2>&1) &
process=$!
begun killed
kill -HUP $process
for _ in {1..300}; do
  (($(wc -c <killed/mission.mcap) > 70000)) && break
  sleep 0.1
done
kill -KILL $process 2>/dev/null || fail "a hang-up that is ignored ended the run: '$(<killed.txt)'"
wait $process 2>/dev/null
[[ ! -e killed/summary.json && -s killed/run.json ]] || fail "a killed run: $(ls killed)"
succeeds "the page of a killed run's log" report killed/mission.mcap
[[ -s killed/mission.html ]] || fail "the page of a killed run's log: '$out'"
grep -q 'ends early' out.txt && grep -q 'no summary; made of the [0-9]* steps' out.txt ||
  fail "the page of a killed run's log says nothing of it: '$out'"

# --- A full disk: of a file system that small, or else by a limit on a file's size.
mkdir "$full"
if mount -t tmpfs -o size=600k tmpfs "$full" 2>/dev/null; then
  run explore office --time-limit 20 --mcap --quiet --out full/run
  reason='No space left on device'
else
  code=0
  (ulimit -f 100; exec "$prospect" explore office --time-limit 20 --mcap --quiet \
    --out full/run) >out.txt 2>err.txt || code=$?
  reason='File too large'
fi
((code == 1)) || fail "a full disk: exit $code, expected 1; '$(<err.txt)'"
grep -qF "writing failed ($reason)" err.txt || fail "a full disk: '$(<err.txt)'"
! grep -qv '^prospect: full/run/' err.txt || fail "a full disk: '$(<err.txt)'"
(($(wc -l <err.txt) <= 3)) || fail "a full disk: more than a line a file: '$(<err.txt)'"
[[ $(tail -c 1 full/run/steps.csv | od -An -tx1) == ' 0a' ]] || fail "a full disk: half a row in steps.csv"
[[ ! -e full/run/report.html || $(tail -c 8 full/run/report.html) == *'</html>'* ]] || fail "a full disk: half a report"
! ls full/run/*.part >/dev/null 2>&1 || fail "a full disk: $(ls full/run)"

# The limit is a line of its own, not the death of the program.
code=0
(ulimit -f 20; exec "$prospect" explore office --time-limit 1 --quiet --out limited) >out.txt 2>err.txt || code=$?
((code == 2)) && [[ "$(<err.txt)" == "prospect: limited/config.yaml: cannot be written (File too large); expected a writable folder" ]] ||
  fail "a limit of files: exit $code, '$(<err.txt)'"
[[ ! -e limited ]] || fail "a limit of files: left $(ls limited)"

# --- An output that takes nothing.
code=0
"$prospect" config >/dev/full 2>err.txt || code=$?
((code == 1)) || fail "config to a full output: exit $code, expected 1"
[[ "$(<err.txt)" == "prospect: standard output: cannot be written"*"; expected room for it" && $(wc -l <err.txt) == 1 ]] ||
  fail "config to a full output: '$(<err.txt)'"
code=0
"$prospect" explore office --time-limit 1 --quiet --out closed >&- 2>err.txt || code=$?
((code == 1)) && [[ -s closed/summary.json && $(head -c 5 closed/steps.csv) == step, ]] ||
  fail "explore without standard output: exit $code, $(ls closed)"
! grep -q 'planning' closed/trajectory_true.tum closed/timing.csv || fail "what is printed stands in a file"

finish
