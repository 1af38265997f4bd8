#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A recorded mission driven again: the same bits, of a folder and of a log; the first step that differs; other plans
# beside its own.
#   replay_test.sh <prospect> <scratch directory>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$2/replay.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"

timed_out "a mission" explore corridor --time-limit 4 --seed 3 --set planner.weights.w_l=1 --mcap --quiet --out mission
rows=$(($(wc -l <mission/steps.csv) - 1))

# --- Unchanged.
succeeds "a replay" replay mission --quiet
grep -qF "mission: $rows steps, the same bits" out.txt || fail "a replay: '$out'"
succeeds "a replay of a log" replay mission/mission.mcap --quiet
grep -qF "mission/mission.mcap: $rows steps, the same bits" out.txt || fail "a replay of a log: '$out'"
[[ ! -e mission/replay ]] || fail "an unchanged replay has written something"

# --- With an IMU beside the cameras, whose samples the images are held against.
timed_out "a mission with an IMU" explore corridor --sensors camera --time-limit 1 --seed 3 --set planner.weights.w_l=1 \
  --set simulator.imu.rate=50 --mcap --quiet --out imu
run inspect imu/mission.mcap
grep -qE "^topic +/imu, ([5-9][0-9]|[1-9][0-9]{2,}) of sensor_msgs/msg/Imu" out.txt || fail "no IMU in the log: '$out'"
succeeds "a replay with an IMU" replay imu --quiet
grep -qF "imu: $(($(wc -l <imu/steps.csv) - 1)) steps, the same bits" out.txt || fail "a replay with an IMU: '$out'"

# --- A digit of one step, and a seed, that are not those of the mission.
cp -r mission other
sed -i '4s/^\(2,[^,]*,\)[^,]*/\10.125/' other/steps.csv
run replay other --quiet
((code == 1)) && grep -qE "step 2 differs: true_x: 0.125 recorded, [-0-9.e]+ now" out.txt || fail "a changed row: exit $code, '$out'"
cp -r mission seed
sed -i 's/"seed": 3/"seed": 4/' seed/run.json
run replay seed --quiet
((code == 1)) && grep -q "differs" out.txt || fail "another seed: exit $code, '$out'"
# A mission that was killed is compared as far as it went.
cp -r mission killed
rm killed/summary.json
sed -i '5,$d' killed/steps.csv
succeeds "a killed mission" replay killed --quiet
grep -qF "killed: 3 steps, the same bits; the mission was broken off there" out.txt || fail "a killed mission: '$out'"

# --- Planned anew.
succeeds "other plans" replay mission --set planner.N=12 --solver sampling --from 2 --to 5 --quiet --out beside
grep -qF "4 steps planned anew with planner.solver=sampling, planner.N=12: open loop" out.txt || fail "other plans: '$out'"
(($(wc -l <beside/replay.csv) == 5)) || fail "not a row a step: $(<beside/replay.csv)"
head -n 1 beside/replay.csv | grep -q '^step,time,open_loop,recorded_cost,recorded_term_' || fail "columns: $(head -n 1 beside/replay.csv)"
grep -q 'open loop' beside/replay.html || fail "the page does not say that it is open loop"

# Whether each row of a table has the same values on both sides. Commas within quotes are no separators.
same_plans() {
  awk -F, '{ while (match($0, /"[^"]*"/)) {
      text = substr($0, RSTART + 1, RLENGTH - 2); gsub(/,/, ";", text)
      $0 = substr($0, 1, RSTART - 1) text substr($0, RSTART + RLENGTH) } }
    NR == 1 { for (i = 1; i <= NF; ++i) { name[i] = $i; at[$i] = i } next }
    { for (i = 1; i <= NF; ++i) if (name[i] ~ /^recorded_/ && name[i] !~ /_ms$/) {
        other = name[i]; sub(/^recorded_/, "other_", other); ++compared
        if ($i != $(at[other])) { print "step " $1 ": " name[i] ": " $i ", " $(at[other]); bad = 1 } } }
    END { exit bad || compared < 40 }' "$1"
}

# Other plans of the same planner are the plans that drove.
succeeds "the same planner beside" replay mission --to 3 --quiet --out same
same_plans same/replay.csv || fail "the same planner makes other plans from the same beliefs"

# --- In real time: the planner's calls again, with the beliefs that it was given.
timed_out "a drive" drive corridor --time-limit 4 --seed 3 --quiet --out drive
plans=$(($(wc -l <drive/steps.csv) - 1))
succeeds "a replay of a drive" replay drive --quiet
grep -qF "drive: $plans plans from the recorded beliefs, the same bits" out.txt || fail "a replay of a drive: '$out'"
succeeds "other plans along a drive" replay drive/mission.mcap --set planner.N=12 --from 2 --to 5 --quiet --out along
grep -qF "4 steps planned anew with planner.N=12: open loop" out.txt || fail "other plans along a drive: '$out'"
succeeds "the same plans along a drive" replay drive --from 1 --quiet
same_plans drive/replay/replay.csv || fail "the same calls give other plans"
# What is compared is what was planned: with another weight in the record, the first plan differs.
cp -r drive weighed
sed -i 's/w_l: [0-9.]*/w_l: 7/' weighed/config.yaml
run replay weighed --quiet
((code == 1)) && grep -qE "weighed: step 0 differs: cost: [-0-9.e]+ recorded, [-0-9.e]+ now" out.txt ||
  fail "another weight in the record: exit $code, '$out'"
# Of a log that ends early what stands before that; where the drive went on, that is said.
mkdir short
head -c 200000 drive/mission.mcap >short/mission.mcap
succeeds "a drive that was killed" replay short/mission.mcap --quiet
grep -qE "short/mission.mcap: [0-9]+ plans from the recorded beliefs, the same bits" out.txt || fail "a drive that was killed: '$out'"
grep -q "short/mission.mcap: ends early" err.txt || fail "a drive that was killed: '$err'"
cp drive/steps.csv drive/run.json drive/config.yaml short
missing="short: call [0-9]+ of the planner, after step [0-9]+ at [0-9.]+ s, is not in the log: [0-9]+ of $plans plans were made again"
run replay short --quiet
((code == 1)) && grep -qE "$missing" out.txt && grep -q "the same bits" out.txt || fail "a log that lacks calls: exit $code, '$out'"
run replay short --quiet --set planner.N=12
((code == 1)) && grep -qE "$missing" out.txt && [[ -s short/replay/replay.csv ]] || fail "other plans, of a log that lacks calls: exit $code, '$out'"
succeeds "steps before that" replay short --quiet --to 1
refused "steps after that" "short/mission.mcap: call" "expected the calls up to step $((plans - 1))" replay short --from $((plans - 1))
sed 's/deadline: 0\( \|$\)/deadline: 0.02\1/' drive/config.yaml >weighed/config.yaml
refused "a drive with a deadline" "weighed: planned within planner.deadline, 0.02 s" "--set planner.deadline=0" replay weighed
refused "a world for a drive" "--world: a run in real time is not driven again" "expected none" replay drive --world corridor

# --- Refused.
refused "no run" "nothing: no run" "expected the folder of one" replay nothing
refused "a key of the robot" "--set robot.depth.max_range=6" "expected planner.KEY=VALUE" replay mission --set robot.depth.max_range=6
refused "a wrong key" "planner.K" "expected one of" replay mission --set planner.K=6
refused "steps that end before they begin" "--from, --to: 5 comes after 2" "expected the first step" replay mission --from 5 --to 2
refused "another world" "office: holds another world" "expected the same" replay mission --world office
sed -i 's/"real_time": false/"real_time": true/' seed/run.json
refused "no calls in the log" "seed/mission.mcap: no /planner/calls" "expected the log of a drive" replay seed
rm seed/mission.mcap
refused "no log" "seed/mission.mcap: no such file" "expected the log that drive writes" replay seed

finish
