#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A study by an array of Slurm, with a slurmctld and a slurmd of its own on this machine: more parts than cores, a
# worker that is killed, a resubmission; then the same study by GNU parallel: the same table.
#   slurm_test.sh <prospect> <scratch directory>
# Skipped (77) without Slurm, munge and parallel, or without root, whom munge and slurmd need.
set -uo pipefail
for program in slurmctld slurmd munged sbatch parallel; do
  if ! command -v $program >/dev/null || (($(id -u) != 0)); then
    echo "skipped: $program, or root, is not there (apt-get install slurmctld slurmd slurm-client munge parallel)"
    exit 77
  fi
done
tests="$(dirname "$(realpath "$0")")"
root="$(realpath "$tests/../..")"
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(realpath "$(mktemp -d "$2/slurm.XXXXXX")")"
trap 'stop_slurm; rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cluster/one_machine.sh
source "$tests/one_machine.sh"
failures=0
fail() { echo "FAILED: $*" >&2; failures=$((failures + 1)); }
start_slurm "$work/one" || { echo "FAILED: no Slurm" >&2; exit 1; }

cat >study.yaml <<'END'
study: array
worlds: [office, corridor]
seeds: 1..3
starts: drawn
conditions: {with: {}, without: {planner.weights.w_l: 0}}
mission: {time_limit: 8}
END
export PROSPECT="$prospect"
# submit PARTS: submits the array and waits for its end.
submit() {
  job="$(sbatch --parsable --chdir "$work" --output "$work/part_%A_%a.txt" --mem-per-cpu=0 --array="$1" \
    "$root/scripts/slurm/study.sbatch" 4 study.yaml out)" || { fail "sbatch"; return; }
  echo "array $1 is job $job"
}
wait_for_job() {
  for _ in {1..1200}; do
    [[ -n "$(squeue -h -j "$job" 2>/dev/null)" ]] || return
    sleep 0.5
  done
  fail "job $job does not end"
}

# --- Four parts on two cores: two wait. One that runs is killed with all it has started.
submit 1-4
for _ in {1..600}; do
  (($(find out/cells -name '*.json' 2>/dev/null | wc -l) >= 3)) && break
  sleep 0.1
done
waiting="$(squeue -h -t PD -r -j "$job" | wc -l)"
((waiting >= 1)) || fail "the node is not full: $waiting parts wait"
victim="$(squeue -h -t R -r -j "$job" -o %i | head -n 1)"
echo "killed: part $victim; $waiting parts wait"
scancel --full --signal=KILL "$victim"
wait_for_job
cells() { find out/cells -name summary.json | wc -l; }
before="$(cells)"
echo "$before of 12 cells after the kill"
((before < 12)) || fail "nothing was lost by the kill, so nothing is tested"
find out/cells -name summary.json -printf '%p %T@\n' | sort >before.txt

# --- Submitted again: what was lost is run, and nothing twice.
submit 1-4
wait_for_job
(($(cells) == 12)) || fail "$(cells) of 12 cells after the resubmission: $(cat part_*.txt)"
find out/cells -name summary.json -printf '%p %T@\n' | sort >after.txt
kept="$(comm -12 before.txt after.txt | wc -l)"
((kept == before)) || fail "$((before - kept)) cells were run twice"
echo "$kept cells kept, $((12 - kept)) run by the resubmission"

# --- The same study by GNU parallel.
parallel -j 2 "$prospect" study study.yaml --out by_parallel --quiet --shard {}/4 ::: 1 2 3 4 >parallel.txt 2>&1
for folder in out by_parallel; do
  "$prospect" study study.yaml --out $folder --gather --quiet >gather.txt 2>&1 || fail "gathering $folder: $(<gather.txt)"
  sed 's/,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*$//' $folder/results.csv >$folder.csv
done
cmp out.csv by_parallel.csv || fail "Slurm and parallel give different tables"
((failures == 0)) || exit 1
echo "the same table of $(($(wc -l <out.csv) - 1)) rows by Slurm, with a kill and a resubmission, and by GNU parallel"
