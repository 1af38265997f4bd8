#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A study by the program itself: what is refused, and that kills and resuming give the table of an unbroken run.
#   study_test.sh <prospect> <scratch directory>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$2/study.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

cat >study.yaml <<'END'
study: little
worlds: [office, corridor]
seeds: 1..2
starts: drawn
conditions: {with: {}, without: {planner.weights.w_l: 0}}
mission: {time_limit: 2}
END

# --- What is wrong is said where it stands, before anything is run.
sed 's/w_l/w_m/' study.yaml >typo.yaml
refused "a key that is none" "typo.yaml:5: unknown key 'planner.weights.w_m'" "expected one of" study typo.yaml
sed 's/worlds/wrlds/' study.yaml >typo.yaml
refused "a key of no study" "typo.yaml:2: unknown key 'wrlds' (did you mean 'worlds'?)" "expected" study typo.yaml
refused "no study" "none.yaml: no such file" "expected a YAML file" study none.yaml
refused "no shard" "--shard: '3/2'" "expected I/N" study study.yaml --shard 3/2
[[ ! -e runs ]] || fail "a refusal has made a folder"

succeeds "a dry run" study study.yaml --dry-run --jobs 2
grep -qF "8 cells: 0 done, 0 failed, 8 to run; expected time unknown with 2 jobs" out.txt || fail "a dry run: '$out'"
[[ ! -e runs ]] || fail "a dry run has made a folder"

# --- Unbroken, and once more.
succeeds "a study" study study.yaml --jobs 2 --quiet --out whole
grep -qF "8 cells: 0 there before, 8 run, 0 failed" out.txt || fail "a study: '$out'"
succeeds "a study that is there" study study.yaml --jobs 2 --quiet --out whole
grep -qF "8 cells: 8 there before, 0 run, 0 failed" out.txt || fail "a study that is there: '$out'"

# --- Killed three times, the third time by a signal that it may answer, then by two shards at once.
for wait in 1 2 1; do
  "$prospect" study study.yaml --jobs 2 --quiet --out broken >broken.txt 2>&1 &
  process=$!
  sleep "$wait"
  ((wait == 2)) && kill -INT $process 2>/dev/null || kill -KILL $process 2>/dev/null
  wait $process 2>/dev/null
done
"$prospect" study study.yaml --quiet --out broken --shard 1/2 >shard1.txt 2>&1 &
"$prospect" study study.yaml --quiet --out broken --shard 2/2 >shard2.txt 2>&1 &
wait
succeeds "a study that was killed" study study.yaml --jobs 2 --quiet --out broken
grep -qF "8 cells: 8 there before, 0 run, 0 failed" out.txt || fail "shards: '$(cat shard1.txt shard2.txt)' '$out'"

# --- The same tables, but for what is of the machine.
for folder in whole broken; do
  succeeds "gathering" study study.yaml --gather --steps --out $folder
  sed 's/,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*$//' $folder/results.csv >$folder.csv
  for file in study.html steps.h5 figures/ratios.svg figures/boxes.png figures/error_path.svg; do
    [[ -s $folder/$file ]] || fail "gathering: no $file"
  done
done
cmp whole.csv broken.csv || fail "the table of a broken study is another one"
(($(wc -l <whole.csv) == 9)) || fail "not a row a run: $(<whole.csv)"
for cell in whole/cells/*/; do
  cmp "$cell/steps.csv" "broken/cells/$(basename "$cell")/steps.csv" || fail "$cell differs"
done
for figure in whole/figures/*; do
  cmp -s "$figure" "broken/figures/$(basename "$figure")" || [[ $figure == *ratios* || $figure == *boxes* ]] ||
    fail "$figure differs"
done

# --- A study grows: only what is new is run.
sed -i 's/1..2/1..3/' study.yaml
succeeds "a study that has grown" study study.yaml --jobs 2 --quiet --out whole
grep -qF "12 cells: 8 there before, 4 run, 0 failed" out.txt || fail "a study that has grown: '$out'"

# --- Cells of another version are taken when that is asked for: here those of two other names.
for cell in $(ls whole/cells | grep -v '\.' | sed 2q); do
  mv "whole/cells/$cell" "whole/cells/${cell:1}0"
  sed 's/"version": "/&older-/' "whole/cells/$cell.json" >"whole/cells/${cell:1}0.json"
  rm "whole/cells/$cell.json"
done
"$prospect" study study.yaml --gather --out whole >out.txt 2>&1 && fail "gathering with two cells missing: exit 0"
grep -qF "10 runs, 0 failed, 2 missing" out.txt || fail "two cells of another version: '$(<out.txt)'"
succeeds "gathering any version" study study.yaml --gather --any-version --out whole
grep -qF "12 runs, 0 failed, 0 missing, 2 by other versions" out.txt || fail "gathering any version: '$out'"
(($(grep -c ',older-' whole/results.csv) == 2)) || fail "rows of another version: $(<whole/results.csv)"

# --- Problems instead of worlds: a cell is a bench, with a test of its own for being whole.
cat >solvers.yaml <<'END'
problems: zoo
conditions: {slsqp: {solver: "nlopt:LD_SLSQP"}, search: {solver: "sampling:search"}}
bench: {max_evaluations: 200}
END
sed 's/^bench/worlds: office\nbench/' solvers.yaml >both.yaml
refused "worlds and problems" "both.yaml:1: problems: stands beside 'worlds'" "expected one of them" study both.yaml
refused "steps of problems" "solvers.yaml: solves problems" "expected no --steps" study solvers.yaml --gather --steps --out whole
succeeds "a study of problems" study solvers.yaml --jobs 2 --quiet
grep -qF "2 cells: 0 there before, 2 run, 0 failed" out.txt || fail "a study of problems: '$out'"
succeeds "gathering solves" study solvers.yaml --gather
grep -qF "26 solves, 0 failed, 0 missing" out.txt || fail "gathering solves: '$out'"
[[ -s runs/solvers/study.html && -s runs/solvers/figures/boxes.svg ]] || fail "a study of problems has no page"
sed 's/,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*$//' runs/solvers/results.csv >solves.csv
cell=$(ls -d runs/solvers/cells/*/ | sed 1q)
rm "$cell/bench.json"
sed -i 5,\$d "$cell/rows.jsonl"
succeeds "a bench that was broken off" study solvers.yaml --quiet
grep -qF "2 cells: 1 there before, 1 run, 0 failed" out.txt || fail "a bench that was broken off: '$out'"
succeeds "gathering solves again" study solvers.yaml --gather
sed 's/,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*$//' runs/solvers/results.csv | cmp - solves.csv ||
  fail "the table of a broken bench is another one"

# --- A grid: its numbers against its key, in every form that figures have; names whole, tables folded.
cat >grid.yaml <<'END'
problems: zoo
grid: {max_evaluations: [20, 200, 2000]}
bench: {solver: "nlopt:LD_SLSQP"}
END
rm -rf runs
refused "a form of no figure" "--format" "expected one of" study grid.yaml --gather --format eps
refused "forms without figures" "--format" "--gather" study grid.yaml --format pdf
succeeds "a grid" study grid.yaml --quiet
succeeds "figures of a grid" study grid.yaml --gather --format svg,pdf,pgf
for form in svg pdf pgf; do
  grep -aqE 'max\\?_evaluations' runs/grid/figures/against_max_evaluations.$form || fail "the figure of a grid as $form does not name its key"
done
[[ "$(head -c 5 runs/grid/figures/boxes.pdf)" == "%PDF-" && ! -e runs/grid/figures/boxes.png ]] || fail "forms that were asked for: $(ls runs/grid/figures)"
page=$(<runs/grid/study.html)
[[ "$page" == *"figures/against_max_evaluations"*"<h2>Setups"*"<details><summary>All "* && "$page" == *'fill="var(--surface)"'* ]] || fail "the page of a grid"

# --- A key by the name that it had before is read, and said.
sed 's/planner.weights.w_l: 0/planner.recovery.time: 5/' study.yaml >renamed.yaml
succeeds "an old name" study renamed.yaml --dry-run
told="renamed.yaml:5: planner.recovery.time is planner.recovery.retreat_time now; it is read as that for one version more"
(($(grep -cF "prospect: $told" err.txt) == 1)) || fail "an old name: '$(<err.txt)'"

finish
