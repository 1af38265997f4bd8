#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Rows of the results: each table leads to a commit that is there; a row is found, its command filled in, and what a
# program says now is judged to the digits of the page.
#   reproduce_test.sh <source tree> <scratch folder> <prospect>
set -uo pipefail
root="$1" work="$2" prospect="$3"
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"
if git -C "$root" rev-parse HEAD >/dev/null 2>&1; then
  run "$root/scripts/reproduce" --check
  ((code == 0)) || fail "rows of the results without a commit: $out"
fi

# A project of one page, and a program that says what a file tells it to.
tree="$work/tree" shelf=docs/results
mkdir -p "$tree"/{scripts,docs/results,build,data}
cp "$root/scripts/reproduce" "$tree/scripts/"
touch "$tree/data/hall.bt"
git -C "$tree" init --quiet
git -C "$tree" -c user.name=a -c user.email=a@b commit --quiet --allow-empty -m "Hall and office measured"
commit="$(git -C "$tree" rev-parse --short=8 HEAD)"
cat >"$tree/$shelf/page.md" <<PAGE
# Results
Of commit \`$commit\`.

## Some [missions](a.md): all
    prospect explore WORLD --seed 1 --solver SOLVER    # whole

| world | back end | coverage % | end | t90 | contacts | RMS error m |
|---|---|---|---|---|---|---|
| office | nlopt | **98.0** | explored, 40 s | 12 | 0 | 0.05 |
| hall.bt | ipopt | 91.5 → 98.0 | explored, 40 s | - | 0 | 0.05 |

## A bench
    prospect bench zoo

| set | solved | gap (worst) | ms |
|---|---|---|---|
| zoo | 11 → **12** | 0.50 (−3) | 40 |
| other | 3 | 0.1 (2) | 1 |

## Clips
    D=data
    build/clips \$D/hall@12
    build/clips CLIPS

| clip | error |
|---|---|
| hall | 0.2 |

## More
    build/clips CLIPS

| clip | error |
|---|---|
| hall | 0.2 |
PAGE
cat >"$tree/build/prospect" <<'PROGRAM'
#!/usr/bin/env bash
[[ "$1" != --version ]] || { echo "prospect 9.9"; exit; }
echo "$*" >>"${0%/*}/called"
[[ "$1" != bench ]] || printf '%s\n' "solved of:" "| set | solved | gap (worst) | ms | J |" "|---|---|---|---|---|" "| \`zoo\` | 12 of 13 | 0.504 (-3.1) | 77 | 3 |" ""
[[ "${*: -2:1}" == --out ]] && mkdir -p "${*: -1}" && cp "${0%/*}/summary.json" "${*: -1}/"
exit 0
PROGRAM
printf '#!/bin/sh\necho "3 clips, 2 of them long"\necho clip,error,end\necho data/hall,0.26,7\n' >"$tree/build/clips"
chmod +x "$tree/build/prospect" "$tree/build/clips"
summary() {
  echo "{\"coverage\": $1, \"reason\": \"$2\", \"duration_s\": 39.6, \"time_to_90_s\": $3, \"time_to_95_s\": null, \"collisions\": 0,
    \"losses\": 2, \"localization_rmse_m\": 0.0549, \"localization_final_m\": 0.1}" >"$tree/build/summary.json"
}
reproduce="$tree/scripts/reproduce"
section="$shelf/page.md#some-missions-all"
# said CODE EXPECTED ARGUMENT...
said() {
  local expected_code="$1" expected="$2"
  shift 2
  run "$reproduce" "$@"
  ((code == expected_code)) && [[ "$out$err" == *"$expected"* ]] || fail "$*: exit $code, expected $expected_code and '$expected': '$out' '$err'"
}
summary 0.98049 explored 11.6
said 0 "verdict: the same, 5 numbers" "$section/office/nlopt"
[[ "$out" == *"commit: $commit, "*": Hall and office measured"*"command: prospect explore office --seed 1 --solver nlopt"*"program: prospect 9.9"* ]] ||
  fail "what is told of a row: $out"
grep -qE '^explore office --seed 1 --solver nlopt --quiet --out /' "$tree/build/called" || fail "what is called: $(<"$tree/build/called")"
said 1 "verdict: differs: t90: none, now 11.6; 4 alike" "$section/hall.bt" --data "$tree/data"
[[ "$out" == *"prospect explore $tree/data/hall.bt --seed 1 --solver ipopt"* ]] || fail "a world's file: $out"
summary 0.9806 explored null
said 1 "differs: coverage %: 98.0, now 98.06; t90: 12, now none" "$section/office"
summary 0.98 "time limit" 12
said 1 "differs: end: explored, now time limit" "$section/office"
summary 0.98 explored 12
said 0 "command: prospect explore office --seed 1 --solver nlopt" "$section/office" --show
said 3 "row: $section/hall.bt/ipopt" "$section"
# By the table that a command prints: in columns of the same names, without times.
said 0 "verdict: the same, 3 numbers" "$shelf/page.md#a-bench/zoo"
said 3 "verdict: not judged; the page says other | 3 | 0.1 (2) | 1; the command says nothing of that name" "$shelf/page.md#a-bench/other"
said 1 "verdict: differs: error: 0.2, now 0.26" "$shelf/page.md#clips/hall"
[[ "$out" == *"command: build/clips data/hall@12"* ]] || fail "what a page calls \$D: $out"
said 3 "verdict: not judged; the page says clip: hall, error: 0.2" "$shelf/page.md#more/hall"
said 2 "no such row; expected one of office, hall.bt" "$section/yard"
said 2 "no such section; expected one of some-missions-all, a-bench" "$shelf/page.md#other"
said 0 "verdict: the same" "page#some-missions-all/office"
said 2 "no such page" "$shelf/none.md#other"
said 2 "no such program" "$section/office" --build "$work"

# The same as a command of the program, from any folder; what it has started ends with it.
called() {
  local expected_code="$1" expected="$2"
  shift 2
  run env -C / "$prospect" reproduce "$@"
  ((code == expected_code)) && [[ "$out$err" == *"$expected"* ]] || fail "reproduce $*: exit $code, expected $expected_code and '$expected': '$out' '$err'"
}
called 0 "verdict: the same" "$tree/$section/office" --build "$tree/build"
called 0 "row: $tree/$section/office" "$tree/$section" --show
called 2 "no such section" "$tree/$shelf/page.md#other"
called 2 "no scripts/reproduce above it" none.md#other
called 2 "expected a row"
called 2 "expected a row" "$section/office" --check
cp "$tree/build/prospect" "$tree/build/quick"
printf '#!/usr/bin/env bash\n[[ "$1" != --version ]] || exit 0\necho $$ >"${0%%/*}/pid"\nexec sleep 100\n' >"$tree/build/prospect"
"$prospect" reproduce "$tree/$section/office" --build "$tree/build" >"$work/out" 2>"$work/err" &
for _ in {1..500}; do
  [[ -s "$tree/build/pid" ]] && break
  sleep 0.02
done
kill -TERM $!
code=0
wait $! || code=$?
((code == 4)) || fail "reproduce, SIGTERM: exit $code, expected 4: $(<"$work/err")"
mission="$(<"$tree/build/pid")"
for _ in {1..100}; do
  [[ -e "/proc/$mission/exe" ]] || break
  sleep 0.02
done
[[ ! -e "/proc/$mission/exe" ]] || fail "a mission goes on that was started for a row"
mv "$tree/build/quick" "$tree/build/prospect"
said 0 "" --check
# A table without a commit, and a commit that is none.
sed -i "s/\`$commit\`/today/" "$tree/$shelf/page.md"
said 1 "$shelf/page.md#a-bench: a table without a commit" --check
sed -i "s/^Of commit today/Of commit \`0123abc\`/" "$tree/$shelf/page.md"
said 1 "no commit 0123abc" --check

((failures == 0)) && echo "reproduce: all checks pass"
exit "$((failures > 0))"
