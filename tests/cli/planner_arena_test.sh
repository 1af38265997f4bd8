#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The logs of a bench for Planner Arena are read by OMPL's own reader, and its database has the numbers of bench.csv.
#   planner_arena_test.sh <prospect> <scratch directory>
# Skips with exit code 77 where the reader is absent.
set -euo pipefail
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$(realpath "$2")/arena.XXXXXX")"
trap 'rm -rf "$work"' EXIT
command -v ompl_benchmark_statistics >/dev/null || { echo "skipped: no ompl_benchmark_statistics here: ompl-demos brings it"; exit 77; }
cd "$work"
"$prospect" bench zoo --quick --solver nlopt,ceres,sampling --deadline 0,0.05 --max-evaluations 300 --seed 1,2 --quiet \
  --out bench >/dev/null
ompl_benchmark_statistics bench/planner_arena/*.log -d bench.db >/dev/null
/usr/bin/python3 - <<'END'
import csv
import sqlite3

told = {}
with open("bench/bench.csv", newline="") as file:
    for row in csv.DictReader(file):
        deadline = float(row["deadline_s"] or 0.0)
        experiment = row["set"] + (f"_{1e3 * deadline:g}ms" if deadline else "")
        told.setdefault((experiment, row["solver"]), []).append(row)
read = {}
columns = ["solved", "cost", "gap", "optimality", "evaluations", "evaluations_to_target", "gradients"]
for experiment, solver, *values in sqlite3.connect("bench.db").execute(
    f"SELECT e.name, p.name, {', '.join('r.' + c for c in columns)} FROM runs r "
    "JOIN experiments e ON r.experimentid = e.id JOIN plannerConfigs p ON r.plannerid = p.id ORDER BY r.id"
):
    read.setdefault((experiment, solver), []).append(values)
assert read.keys() == told.keys(), (sorted(read), sorted(told))
names = {"evaluations": "cost_evaluations", "gradients": "gradient_evaluations"}
for key, runs in read.items():
    assert len(runs) == len(told[key]) == 26, (key, len(runs), len(told[key]))  # 13 problems, two seeds
    for run, row in zip(runs, told[key]):
        for column, value in zip(columns, run):
            text = row[names.get(column, column)]
            number = None if text == "" else float(text)
            assert value == number or abs(value - number) <= 1e-9 * abs(number), (key, column, value, text)
END
