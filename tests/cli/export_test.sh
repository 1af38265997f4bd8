#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Problems for other people's solvers, and theirs: `prospect export --to`, and .nl in `bench` and `solve`.
#   export_test.sh <prospect> <scratch directory> <tests/adapters/call_external.c>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
call_external="$(realpath "$3")"
mkdir -p "$2"
work="$(mktemp -d "$2/export.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

# --- A problem of a mission in C: compiled as the program says, and called.
timed_out "a mission with problems" explore office --time-limit 1 --quiet --save-problems 1 --out saved
problem=saved/problems/step_000000.h5
succeeds "a mission's problem in C" export $problem --to c --out "for others"
[[ "$out" == "for others/step_000000.h5
for others/step_000000.c
cc "* ]] || fail "export --to c says '$out'"
cmp -s $problem "for others/step_000000.h5" || fail "the problem beside its C is another"
eval "$(tail -1 out.txt)" || fail "the line that export prints does not compile"
cc -std=c99 -D_DEFAULT_SOURCE "$call_external" -o call -ldl || fail "call_external.c does not compile"
read -r n m _ < <(./call "for others/step_000000.so" step_000000 <<<0)
succeeds "the same problem" solve $problem --solver sampling --max-evaluations 20 --quiet
[[ "$out" == *": $n variables, $m constraints"* ]] || fail "C has $n variables, $m rows; '$out'"
./call "for others/step_000000.so" step_000000_stages <<<0 >/dev/null || fail "no functions by stages"
succeeds "into the problem's own folder" export $problem --to c --out saved/problems
for to in nl casadi; do
  refused "a mission as $to" $problem "its maps and landmarks are no formulas, which --to $to needs; expected --to c" \
    export $problem --to $to --out none
done

# --- Problems as expressions: there and back.
succeeds "the zoo as .nl" export zoo --to nl --out nl
(($(find nl -name '*.nl' | wc -l) == 13)) || fail "the zoo has other files: $(ls nl)"
succeeds "bench of a folder of .nl" bench nl --solver nlopt:LD_SLSQP --deadline 0 --repeat 1 --quiet --out bench_nl
succeeds "bench of the zoo" bench zoo --solver nlopt:LD_SLSQP --deadline 0 --repeat 1 --quiet --out bench_zoo
for optimum in "HS76,4,3,.*,-4.6818" "HS43,4,3,.*,-44[,.]"; do
  grep -q "^nl,$optimum" bench_nl/bench.csv || fail "no '$optimum' in $(<bench_nl/bench.csv)"
done
succeeds "bench of a file .nl" bench nl/HS35.nl --solver nlopt:LD_SLSQP --deadline 0 --repeat 1 --quiet --out bench_one
succeeds "solve of a file .nl" solve nl/HS76.nl --solver nlopt:LD_SLSQP
[[ "$out" == *-4.68182*"feasible optimum"* ]] || fail "solve of HS76.nl: '$out'"
cat >own.json <<'JSON'
{"problems": [{"name": "HS 28/a", "n": 3, "x0": [-4, 1, 1], "objective": "(x1+x2)^2+(x2+x3)^2", "inequalities_nonneg": [],
  "equalities_zero": ["x1+2*x2+3*x3-1"], "lower": [null, null, null], "upper": [null, 5, null], "f_opt": 0}]}
JSON
succeeds "a problem of one's own as .nl" export own.json --to nl
[[ "$(<HS_28_a.nl)" == "g3 1 1 0	# HS 28_a of own.json, written by prospect "*"
r
4 0
b
3
1 5
3
"* ]] || fail "HS_28_a.nl: '$(<HS_28_a.nl)'"
succeeds "the same for CasADi" export own.json --to casadi
[[ "$(<HS_28_a.py)" == *"
lbx = [-inf, -inf, -inf]
ubx = [inf, 5, inf]
lbg = [0]
ubg = [0]
x0 = [-4, 1, 1]
"* ]] || fail "HS_28_a.py: '$(<HS_28_a.py)'"
succeeds "the same in C" export own.json --to c
eval "$(tail -1 out.txt)" || fail "the line for expressions does not compile"
[[ "$(./call ./HS_28_a.so HS_28_a <<<$'1\n1 1 1' | sed -n 8,11p)" == "0
8 
5 
4 8 4 "* ]] || fail "HS_28_a.so tells $(./call ./HS_28_a.so HS_28_a <<<$'1\n1 1 1')"

# --- What cannot be.
refused "nothing to export to" "export: to what?" "expected --sdf FILE of a world, or --to" export office
refused "both" "--to: beside --sdf" expected export zoo --to c --sdf a.sdf
refused "an unknown format" "--to" "c,nl,casadi" export zoo --to mps
refused "options of a world" "--to: beside options of a world" expected export zoo --to nl --set robot.depth.max_range=4
refused "a seed" "--to: beside options of a world" expected export zoo --to nl --seed 2
refused "a folder of a world" "--out: beside --sdf" expected export office --sdf a.sdf --out b
refused "missions" "missions: is driven" "expected a folder" export missions --to c
refused "no set" "no.h5: no such file" "expected" export no.h5 --to c
sed 's/^o5$/o13/' nl/Rosenbrock.nl >floor.nl
line="$(grep -n '^o13$' floor.nl | head -1 | cut -d: -f1)"
for call in "solve floor.nl" "bench floor.nl --out none"; do
  # shellcheck disable=SC2086
  refused "$call: floor" "floor.nl:$line: operation o13 (floor)" "expected smooth functions" $call
done
refused "no such .nl" "no.nl: no such file" "expected a file .nl" solve no.nl
echo precious >nl_theirs && mkdir theirs && mv nl_theirs theirs/HS12.nl
refused "over a file of others" "theirs/HS12.nl: is there" expected export zoo --to nl --out theirs
[[ "$(ls theirs)" == HS12.nl && ! -e none ]] || fail "a refused export wrote something"
finish
