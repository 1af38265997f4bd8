#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A signal ends every command within a second, whatever it does: exit code 4, and what is whole.
#   signals_test.sh <prospect> <scratch directory> <a faulty plug-in> <write_depth_recording> <write_stereo_recording>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
faulty="$(realpath "$3")"
write_depth_recording="$(realpath "$4")"
write_stereo_recording="$(realpath "$5")"
mkdir -p "$2"
work="$(mktemp -d "$2/signals.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

# start ARGUMENT...: in the background; $process.
start() {
  "$prospect" "$@" >out.txt 2>err.txt </dev/null &
  process=$!
}
# computed: hundredths of a second of the processor that $process has had; fails if it has ended.
computed() {
  local stat
  read -r stat 2>/dev/null <"/proc/$process/stat" || return 1
  read -ra stat <<<"${stat##*) }"
  [[ ${stat[0]} != Z ]] && echo $((stat[11] + stat[12]))
}
# stop SIGNAL WHAT: ends $process by a signal; leaves $code, $out, $err. On a busy machine a second is one of the
# processor, and there are 20 of the wall's.
stop() {
  local before now
  before=$(computed)
  kill -"$1" $process
  for _ in {1..1000}; do
    now=$(computed) || break
    ((now - before <= 100)) || break
    sleep 0.02
  done
  if now=$(computed); then
    kill -KILL $process
    fail "$2: still runs after SIG$1 and $((now - before)) hundredths of a second"
  fi
  code=0
  wait $process || code=$?
  out="$(<out.txt)"
  err="$(grep -v '^prospect: built from files that differ' err.txt)"
  ((code == 4)) || fail "$2, SIG$1: exit $code, expected 4; '$err'"
}
# until_caught: waits until $process is the program and has its handlers (SIGTERM is bit 14).
until_caught() {
  local caught
  for _ in {1..2000}; do
    # Before that it is the shell, which has handlers of its own.
    if [[ /proc/$process/exe -ef $prospect ]]; then
      caught="$(sed -n 's/^SigCgt:\s*//p' /proc/$process/status 2>/dev/null)"
      [[ -n $caught ]] && ((0x$caught >> 14 & 1)) && return
    fi
    sleep 0.01
  done
}
# until_there FILE: waits until $process has made it.
until_there() {
  for _ in {1..2000}; do
    [[ -e $1 ]] && return
    sleep 0.01
  done
  fail "$1 is not there"
}

# --- Whatever a command begins with, a signal ends it at once. A plug-in that does not come back holds each there.
"$write_stereo_recording" stereo 200 || fail "no stereo recording was written"
"$write_depth_recording" depth || fail "no depth recording was written"
timed_out "a run" explore office --time-limit 8 --quiet --out run
cp -r run recorded
rm -rf run
: >robot.yaml
printf 'worlds: office\nseeds: 1..2\n' >study.yaml
calls=("explore office --out new" "drive office --out new" "relay --ros robot.yaml" "report recorded --figure path --out new"
  "export office --sdf new/office.sdf" "solve office@4" "bench zoo --out new" "replay recorded --out new"
  "study study.yaml --out new" "reproduce --check" "inspect stereo" "odometry stereo --out new" "map depth/posed --out new" "list" "config")
signals=(INT TERM HUP)
for ((k = 0; k < ${#calls[@]}; ++k)); do
  # shellcheck disable=SC2086
  PROSPECT_TEST_FAULT="entry takes long" start ${calls[k]} --plugin "$faulty"
  until_caught
  stop "${signals[k % 3]}" "${calls[k]}"
  [[ "$err" == "prospect: cancelled" && -z "$out" && ! -e new ]] || fail "${calls[k]}: '$out' '$err' $(ls new 2>/dev/null)"
done
# These are all that there are.
"$prospect" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p' | sort >commands.txt
printf '%s\n' "${calls[@]%% *}" | sort | diff - commands.txt >&2 || fail "commands without a row here"

# --- Worlds that take long to read, of all kinds.
{
  printf 'v %s\n' "0 0 0" "0 0 60" "60 0 60" "60 0 0" "0 40 60" "60 40 0"
  echo "f 1 2 3 4"
  for ((i = 0; i < 2000; ++i)); do echo "f 1 5 6"; done
} >large.obj
{
  printf 'P5\n6000 6000\n255\n'
  head -c 36000000 /dev/zero | tr '\0' '\376'
} >large.pgm
for world in large.obj large.pgm plan:1:40x40; do
  start explore $world --out new
  until_caught
  sleep 0.1
  stop TERM "explore $world"
  [[ "$err" == "prospect: cancelled" && ! -e new ]] || fail "explore $world: '$err' $(ls new 2>/dev/null)"
done

# --- A bag that is decompressed leaves nothing behind.
if command -v zstd >/dev/null; then
  mkdir temporary
  head -c 200000000 /dev/zero | zstd -q >zeros.mcap.zstd
  TMPDIR="$work/temporary" start inspect zeros.mcap.zstd
  for _ in {1..2000}; do
    [[ -z $(ls temporary) ]] || break
    sleep 0.01
  done
  stop INT "a bag that is decompressed"
  [[ -z $(ls temporary) ]] || fail "a bag that is decompressed: left $(ls temporary)"
fi

# --- What has begun to write ends with what is whole.
for call in "odometry stereo" "map stereo" "explore office" "drive office" "replay recorded --set planner.N=14"; do
  rm -rf new
  # shellcheck disable=SC2086
  start $call --out new --quiet
  until_there new/.prospect
  [[ $call == replay* ]] || sleep 0.3
  stop INT "$call"
  [[ $call == replay* || -s new/summary.json ]] || fail "$call: left $(ls new)"
  [[ $call != map* && $call != odometry* ]] || [[ "$err" =~ ^"prospect: cancelled after "[0-9]+" of 200 frames"$ ]] || fail "$call: '$err'"
  [[ $call != map* && $call != odometry* ]] || grep -q '"cancelled after [0-9]* of 200 frames"' new/summary.json ||
    fail "$call: its summary does not say that it was cancelled"
done
finish
