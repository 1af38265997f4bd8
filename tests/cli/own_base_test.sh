#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A robot of one's own by plug-in, over TCP: list, settings, checks, guard, live page, log, report, replay, faults.
#   own_base_test.sh <prospect> <scratch directory> <plug-in of the robot> <its firmware> <a plug-in without a robot>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
plugin="$(realpath "$3")"
firmware="$(realpath "$4")"
other="$(realpath "$5")"
mkdir -p "$2"
work="$(mktemp -d "$2/own_base.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"
base="plugin:$plugin"

# --- What it is, what it can be told, and what is refused before anything moves.
code=0 out="$("$prospect" list bases --plugin "$plugin" 2>err.txt)" || code=$?
[[ $code == 0 && "$out" == *"tcp "*"a base over TCP"*"    base.port=4321: of its firmware on this machine"* ]] ||
  fail "list bases: $code '$out' $(<err.txt)"
# refused EXPECTED ARGUMENT...
refused() {
  local expected="$1" code=0 out err
  shift
  out="$("$prospect" drive "$@" --out refused 2>err.txt </dev/null)" || code=$?
  err="$(grep -v '^prospect: built from files that differ' err.txt)"
  [[ $code == 2 && -z "$out" && "$err" == *"$expected"* && $(wc -l <<<"$err") == 1 && ! -e refused ]] ||
    fail "drive $*: exit $code, '$out', $err"
}
refused "port 1: nobody answers; expected the base's firmware there" --base "$base" --set base.port=1
refused "unknown key 'base.prot' (did you mean 'port'?)" --base "$base" --set base.prot=1
refused "base.port" --base "$base" --set base.port=high
refused "base.port: nothing reads it here" --base simulator --set base.port=1
refused "given beside a plug-in" --base "$base" --base dds
refused "no such file" --base plugin:nowhere.so
refused "has no robot; expected one for --base" --base "plugin:$other"
refused "is no base; expected simulator, gazebo, dds or plugin:FILE" --base tcp

# --- Drives, all at a time. start NAME FIRMWARE ARGUMENT...
start() {
  local name="$1" fault="$2" port
  shift 2
  : >"$name.way"
  "$firmware" "$fault" >"$name.way" &
  firmwares[$name]=$!
  for _ in {1..500}; do
    read -r port <"$name.way" && break
    sleep 0.01
  done
  "$prospect" drive --base "$base" --set "base.port=$port" --out "$name" --quiet --json "$@" \
    >"$name.json" 2>"$name.err" </dev/null &
  pids[$name]=$!
}
declare -A pids firmwares
start well well --go 1.2,1 --live 0
for fault in backwards silent garbage gone; do
  start $fault $fault --go 6,1 --time-limit 15
done
start fault well --fault base:mirrored --time-limit 15

for _ in {1..2000}; do
  url="$(sed -n 's/.*live view: //p' well.err)"
  [[ -z "$url" ]] || break
  sleep 0.01
done
[[ "$url" =~ ^http://([0-9.]+):([0-9]+)(.*)$ ]] || fail "no live view: '$url' $(<well.err)"
exec 3<>"/dev/tcp/${BASH_REMATCH[1]}/${BASH_REMATCH[2]}"
printf 'GET / HTTP/1.1\r\nHost: %s:%s\r\nConnection: close\r\n\r\n' "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&3
page="$(timeout 10 cat <&3)"
[[ "$page" == *"<html"* ]] || fail "the live page: '${page:0:200}'"
exec 3>&-

code=0
wait "${pids[well]}" || code=$?
[[ $code == 0 ]] || fail "well: exit $code: $(<well.json) $(<well.err)"
grep -q '"goal reached"' well.json || fail "well: $(<well.json)"
grep -A3 '^base:' well/config.yaml | grep -q 'port: ' || fail "config.yaml does not say how the base was reached"
"$prospect" report well/mission.mcap --out page >out.txt 2>&1 || fail "report: $(<out.txt)"
[[ -s well/report.html && -n "$(ls page/*.html)" ]] || fail "no report: $(ls well page)"
"$prospect" replay well --out again >out.txt 2>&1 || fail "replay: $(<out.txt)"
grep -q 'the same bits' out.txt || fail "replay: $(<out.txt)"

# --- What goes wrong on the way stops it, says so in a line, and leads nowhere.
# stopped NAME LINE METRES
stopped() {
  local code=0 port way since
  wait "${pids[$1]}" || code=$?
  wait "${firmwares[$1]}"
  { read -r port && read -r way since; } <"$1.way"
  [[ $code == 1 ]] || fail "$1: exit $code ($port, $way): $(<"$1.err")"
  grep -q "$2" "$1.err" || fail "$1: says $(<"$1.err")"
  awk "BEGIN { exit !($since <= $3) }" || fail "$1: drove $since m after its fault, expected at most $3"
}
stopped backwards "does not follow" 0.8
stopped silent "base silent" 0.8
stopped garbage "drive mode" 0.8
stopped gone "base fault.*the link to the firmware is gone" 0.3
code=0
wait "${pids[fault]}" || code=$?
[[ $code == 1 ]] && grep -q 'before the first motion: following: yaw' fault.json || fail "--fault: $code $(<fault.json)"
finish
