#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What the program `prospect` promises to who types a command: exit codes, messages, files.
#   cli_test.sh <prospect> <scratch directory> <a plug-in> <a faulty one> <a library that is none>
#     <write_depth_recording> <write_stereo_recording> <a plug-in with a term>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
plugin="$(realpath "$3")"
faulty="$(realpath "$4")"
no_plugin="$(realpath "$5")"
write_depth_recording="$(realpath "$6")"
write_stereo_recording="$(realpath "$7")"
term_plugin="$(realpath "$8")"
mkdir -p "$2"
work="$(mktemp -d "$2/cli.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"
explore=(explore --time-limit 1 --quiet --out run)

# --- A short mission, twice: the same bytes, and the files that every run leaves.
for n in first second; do
  timed_out "$n mission" explore office --time-limit 5 --seed 3 --quiet --out "$n" --json
done
for file in steps.csv trajectory_estimated.tum trajectory_true.tum map.bt config.yaml; do
  [[ -s first/$file ]] || fail "the run has no $file"
  cmp -s "first/$file" "second/$file" || fail "$file differs between two runs with the same seed"
done
for file in summary.json report.html timing.csv; do
  [[ -s first/$file ]] || fail "the run has no $file"
done
(($(wc -l <first/steps.csv) > 5)) || fail "steps.csv has hardly any row"
timed_out "another seed" explore office --time-limit 5 --seed 4 --quiet --out fourth
! cmp -s first/trajectory_true.tum fourth/trajectory_true.tum ||
  fail "another seed gives the same trajectory"
timed_out "explore --json" explore office --time-limit 1 --quiet --out json --json
cp out.txt out.json
for key in world solver seed reason coverage area_m2 collisions losses duration_s wall_s \
  path_length_m time_to_90_s time_to_95_s time_to_99_s localization_rmse_m localization_final_m \
  drift_percent plan_ms p50 p95 p99 max deadline_misses fallbacks; do
  for file in out.json first/summary.json; do
    grep -q "\"$key\": " "$file" || fail "$file has no '$key'"
  done
done
cmp -s out.json json/summary.json || fail "explore --json prints other facts than summary.json"
[[ ! -s err.txt ]] || fail "explore --quiet wrote to standard error: '$(<err.txt)'"
# A map that was built is a world to explore; an earlier run's folder may be used again.
timed_out "a map of an earlier run as the world" explore first/map.bt --time-limit 1 --quiet \
  --out again
timed_out "a run folder used again" explore office --time-limit 1 --quiet --out again
timed_out "a start to the left of the origin" explore office --time-limit 1 --quiet --out again \
  --start 2 1.5 -90

# No name that holds an escape sequence reaches a terminal as it is.
words=$'words\033[2J'
timed_out "a summary in words" explore office --time-limit 1 --quiet --out "$words"
! grep -qiw nan out.txt || fail "the summary in words has a number that is none: '$out'"
! grep -qw nan "$words/summary.json" || fail "summary.json has a number that is none"
grep -qF 'words?[2J/report.html' out.txt || fail "the name of a folder is printed raw: '$out'"
# In real time: the robot may not have moved on a machine that is busy, but everything is written.
timed_out "a mission in real time" drive office --time-limit 1.5 --quiet --out live
grep -q 'capture to command' out.txt || fail "a mission in real time: no latency in '$out'"
[[ -s live/steps.csv && -s live/report.html && -s live/summary.json ]] ||
  fail "a mission in real time: its run folder is not whole"
succeeds "a look at a robot" drive office --check --quiet --out none
grep -q '^localization  *passed  *ok, at' out.txt && grep -q '^slip  *not possible  *no turn: not asked for' out.txt ||
  fail "drive --check: '$out'"
[[ ! -e none ]] || fail "drive --check: it has written a run folder"
# The live view says where it is, and keeps its token out of the run folder. Without its library it says so.
succeeds "list adapters" list adapters
if grep -q '^live .*not built in' out.txt; then
  run explore office --time-limit 1 --live 0 --quiet --out seen
  ((code == 3)) || fail "a live view that is not built in: exit $code, expected 3"
else
  timed_out "a mission that is shown" explore office --time-limit 1 --live 0 --live-token 0123456789abcdef --quiet --out seen
  grep -q '^prospect: live view: http://127.0.0.1:[0-9]*/?token=0123456789abcdef$' err.txt || fail "a mission that is shown: where? '$err'"
  ! grep -rq 0123456789abcdef seen || fail "the token of the live view is in the run folder"
  refused "a host that there is not" --live-host "expected the address" explore office --live 0 --live-host nowhere --out none
  refused "a short token" --live-token "16 to 128" explore office --live 0 --live-token short --out none
fi
refused "a port that there is not" --live "whole number from 0 to 65535" drive office --live 70000 --out none
refused "a host of nothing" --live-host "--live" drive office --live-host 127.0.0.1 --out none
refused "a base that there is not" --base "expected simulator, gazebo, dds or plugin:FILE" drive office --base rover \
  --out none
# Nobody listens at port 1.
refused "a Gazebo that is not there" 127.0.0.1:1 "expected" drive --base gazebo \
  --set gazebo.port=1 --out none
GAZEBO_MASTER_URI=http://127.0.0.1:1/ refused "the Gazebo that the environment names" 127.0.0.1:1 "expected" drive \
  --base gazebo --out none
GAZEBO_MASTER_URI=http://127.0.0.2:2 refused "a port of Gazebo that the configuration names" 127.0.0.2:1 "expected" drive \
  --base gazebo --set gazebo.port=1 --out none
GAZEBO_MASTER_URI=127.0.0.1:1 refused "an address of Gazebo that is none" GAZEBO_MASTER_URI "expected http://ADDRESS:PORT" \
  drive --base gazebo --out none
refused "a stepped simulator" --lockstep "expected it with --base gazebo" drive office --lockstep --out none
refused "a fault in lockstep" --fault "expected it without --lockstep" drive --base gazebo --lockstep \
  --fault depth:off --out none
refused "a measured simulator" --measure "expected it with --base gazebo" drive office --measure \
  --out none
refused "no topics" --ros "expected the file" drive --base dds --out none
refused "topics of a simulator" --ros "expected it with --base dds" drive office --ros topics.yaml --out none
printf 'command: {dead_man: 0.5}\nodometri: /odom\n' >topics.yaml
refused "a topic that there is not" "topics.yaml:2: unknown key 'odometri'" "odometry" drive --base dds --ros topics.yaml \
  --out none
printf 'command: {dead_man: 0.5}\n' >topics.yaml
refused "no topic for the relay" command.relay "expected the topic" relay --ros topics.yaml
# A robot that says nothing: each calibration that is missing is a line, and nothing has been sent.
printf 'domain: 95\nloopback: true\ntimeout: 0.1\ncommand: {dead_man: 0.5}\n' >topics.yaml
run drive --base dds --ros topics.yaml --out none
if ((code != 3)); then  # built in
  ((code == 2)) || fail "a robot that says nothing: exit $code, expected 2; '$err'"
  [[ "$(grep -c 'camera_info: no message within 0.1 s; expected the' err.txt)" == 3 ]] ||
    fail "a robot that says nothing: no line for each calibration in '$err'"
  [[ ! -e none ]] || fail "a robot that says nothing: a run folder"
fi
refused "a fault that nobody knows" --fault "'depth:broken'; expected a verb: off, stuck" drive office \
  --fault depth:broken --out none

# --- Tasks: done or not, and why.
succeeds "enough, and back" explore office --until 12m2 --return --quiet --out task
grep -q 'done: enough was seen. It is back where it began.' out.txt ||
  fail "--until --return does not say that it is done: '$out'"
grep -q ',return,' task/steps.csv || fail "steps.csv does not name the task to return"
succeeds "a place to go to" explore office --go 2.5,5.3,90 --quiet --out task --json
for fact in '"task": "go to"' '"done": true' '"reason": "goal reached"'; do
  grep -qF "$fact" out.txt || fail "--go: no $fact in '$out'"
done
grep -q 'goal: \[2.5, 5.3, 90\]' task/config.yaml || fail "config.yaml does not hold the goal"
succeeds "on from a map" explore office --until 0.12 --map first/map.bt --quiet --out task
grep -q 'map: first/map.bt' task/config.yaml || fail "config.yaml does not name the map"
printf 'zones: {keep_out: [{area: [2, 5, 3, 5, 3, 6, 2, 6]}]}\n' >keep_out.yaml
refused "a goal in a keep-out" "--go 2.5,5.3: task.goal:" "is in zones.keep_out[0]; expected" "${explore[@]}" office \
  --go 2.5,5.3 --config keep_out.yaml
refused "a goal of one number" --go: "2" "${explore[@]}" office --go 2.5
refused "more than all" "--until 1.5: mission.until.coverage:" "'1.5'; expected a number from 0 to 1" "${explore[@]}" office --until 1.5
refused "an area of nothing" "--until 0m2:" "expected more than 0" "${explore[@]}" office --until 0m2
refused "a map that there is not" nothing.bt "no such file; expected" "${explore[@]}" office \
  --map nothing.bt
printf 'perception: {mapping: {resolution: 0.05}}\n' >finer.yaml
refused "a map of another resolution" first/map.bt "resolution is 0.1 m; expected 0.05 m" \
  "${explore[@]}" office --map first/map.bt --config finer.yaml

# --- Worlds that cannot be read.
: >empty.bt
head -c $(($(wc -c <first/map.bt) / 2)) first/map.bt >truncated.bt
# flip FILE OFFSET: first/map.bt with one bit of that byte flipped.
flip() {
  local octal
  octal="$(od -An -to1 -j "$2" -N1 first/map.bt | tr -d ' ')"
  cp first/map.bt "$1"
  # shellcheck disable=SC2059
  printf "\\$(printf %03o $((8#$octal ^ 1)))" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
  ! cmp -s "$1" first/map.bt || fail "$1: no bit was flipped"
}
flip flipped_name.bt 4
flip flipped_data.bt $(($(grep -abo '^data' first/map.bt | head -1 | cut -d: -f1) + 5))
mkdir folder
printf 'P5\n100 100\n255\n%s' "0123456789" >short.pgm
printf 'image: short.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n' >short.yaml
refused "missing world" nothing.bt "no such file; expected" "${explore[@]}" nothing.bt
refused "missing world in a folder" no/where "no such file; expected" "${explore[@]}" no/where
refused "directory as world" folder "is a directory; expected" "${explore[@]}" folder
refused "empty octree" empty.bt "empty file; expected" "${explore[@]}" empty.bt
refused "truncated octree" truncated.bt "expected enough for" "${explore[@]}" truncated.bt
refused "bit flipped in the first line" flipped_name.bt expected "${explore[@]}" flipped_name.bt
refused "bit flipped in the data" flipped_data.bt expected "${explore[@]}" flipped_data.bt
refused "image of wrong size" short.pgm "10 bytes of pixels; expected 10000" \
  "${explore[@]}" short.pgm
refused "ROS map with such an image" short.pgm "expected 10000" "${explore[@]}" short.yaml
refused "misspelt world" offce "did you mean 'office'?" "${explore[@]}" offce
refused "misspelt world" offce "expected one of: office" "${explore[@]}" offce

# --- Configurations.
printf 'planner:\n  weights:\n    w_ee: 1\n' >key.yaml
printf 'planner:\n  weights:\n    w_e: .nan\n' >nan.yaml
printf 'planner:\n  N: 100000\n' >range.yaml
printf '\nplanner:\n  solver: nlop\n' >solver.yaml
printf 'planner: {N: 10, M: 11}\nmission: {time_limits: 3}\n' >two.yaml
refused "unknown key" key.yaml:3: "(did you mean 'w_e'?); expected" \
  "${explore[@]}" office --config key.yaml
refused "NaN weight" nan.yaml:3: "planner.weights.w_e: is '.nan'; expected a number" \
  "${explore[@]}" office --config nan.yaml
refused "value out of range" range.yaml:2: "planner.N: is '100000'; expected a whole number" \
  "${explore[@]}" office --config range.yaml
refused "unknown solver in a file" solver.yaml:3: "unknown solver 'nlop' (did you mean 'nlopt'?)" \
  "${explore[@]}" office --config solver.yaml
printf 'simulator: {mapping: {core: 0.4}}\n' >old.yaml
timed_out "a key by the name that it had" "${explore[@]}" office --config old.yaml
[[ "$err" == "prospect: old.yaml:1: simulator.mapping.core is perception.mapping.core now; it is read as that for one version more" ]] ||
  fail "a key by the name that it had: '$err'"
rm -rf run
refused "a key that nothing reads" "--set perception.odometry.corners.cells=60" "expected simulator.sensors: camera" \
  "${explore[@]}" office --set perception.odometry.corners.cells=60
refused "unknown key on the command line" "--set planner.weights.w_ee=1" "(did you mean 'w_e'?); expected" \
  "${explore[@]}" office --config range.yaml --set planner.N=10 --set planner.weights.w_ee=1
printf 'robot: {model: multirotor}\n' >flies.yaml
refused "a robot that flies" robot.model "'multirotor', which flies; expected a model that drives" \
  "${explore[@]}" office --config flies.yaml
printf 'robot: {depth: {horizontal_fov: 360, vertical_fov: 0, max_range: 12}}\n' >lidar.yaml
timed_out "a mission with a lidar" explore office --time-limit 1 --quiet --out lidar \
  --config lidar.yaml
run "${explore[@]}" office --config lidar.yaml --sensors camera
if ((code != 3)); then  # 3: cameras are not built in
  refused "a lidar as a camera that is rendered" depth.horizontal_fov \
    "is 360; expected 1..170 degrees" "${explore[@]}" office --config lidar.yaml --sensors camera
fi
# A file may hold keys of other commands, a setting may not.
for call in "relay --ros topics.yaml" "export corridor --sdf no.sdf"; do
  # shellcheck disable=SC2086
  refused "$call with a key of missions" "--set planner.N=12: planner.N: nothing reads it here" "; expected" $call --set planner.N=12
done
refused "a sensor of another robot" "--sensors camera: simulator.sensors: nothing reads it here" "--base simulator" \
  drive --base gazebo --sensors camera --out run
refused "missing configuration" no.yaml "no such file; expected" \
  "${explore[@]}" office --config no.yaml
refused "directory as configuration" folder "is a directory; expected" config folder
refused "two problems: the first" two.yaml:1: "expected at most N" config two.yaml
refused "two problems: the second" two.yaml:2: "did you mean 'time_limit'?" config two.yaml

# --- Arguments.
refused "start inside a wall" "start (0, 0)" "expected a place" \
  "${explore[@]}" office --start 0 0 0
refused "start outside the map" "start (1000, 0)" "expected a place" \
  "${explore[@]}" office --start 1000 0 0
refused "start that is no number" "--start 1 nan 0: world.start:" "expected a list of numbers" "${explore[@]}" office --start 1 nan 0
refused "start with two numbers" --start: "3 required" "${explore[@]}" office --start 1 1
refused "unknown solver" "--solver ipop: planner.solver: unknown solver 'ipop'" "did you mean 'ipopt'?" \
  "${explore[@]}" office --solver ipop
refused "negative seed" --seed: "'-1'; expected a whole number" "${explore[@]}" office --seed -1
refused "time limit that is no number" "--time-limit nan: mission.time_limit:" "'nan'; expected a number from 1" \
  explore office --out run --time-limit nan
refused "time limit out of range" "--time-limit 0: mission.time_limit:" "'0'; expected a number from 1" \
  explore office --out run --time-limit 0
for every in 0 -1 2.5 x; do
  refused "--save-problems $every" --save-problems: "'$every'; expected a whole number from 1" \
    "${explore[@]}" office --save-problems "$every"
done
refused "unknown option" --bogus expected "${explore[@]}" office --bogus
refused "unknown command" "'exlore'" "did you mean 'explore'?" exlore office
# Every command names the nearest of its options, in one line, also where the stray value is taken for an argument.
for typo in "explore --sede --seed" "export --sede --seed" "report --figre --figure" "solve --sede --seed" "bench --sede --seed" \
  "odometry --fromm --from" "map --rnge --range" "list --jsn --json" "config --sett --set"; do
  read -r command option nearest <<<"$typo"
  for call in "$command $option 3" "$command $option=3" "$command x $option"; do
    # shellcheck disable=SC2086
    refused "$call" "unknown option $option" "; did you mean $nearest?" $call
    (($(wc -l <err.txt) == 1)) || fail "$call: more than one line: '$err'"
  done
done
refused "unknown option of the program" "unknown option --versoin" "did you mean --version?" --versoin
refused "option without a value" "--seed: no value" "expected UINT" explore office --seed
refused "option without a value before another" "--out: no value before --quiet" "expected DIR" explore office --out --quiet
refused "argument too many" "unexpected argument 'x'" "\`prospect list --help\`" list solvers x
refused "argument too few" "problem is required" "\`prospect solve --help\`" solve
refused "--json alone" "--json requires --version" "\`prospect --help\`" --json
refused "unknown list" "'solver'" "did you mean 'solvers'?); expected" list solver
refused "problem without a step" "'office'" "expected WORLD@STEP" solve office
refused "problem with a bad step" "'office@-3'" "expected WORLD@STEP" solve office@-3
refused "problem in an unknown world" "'offce'" "did you mean 'office'?" solve offce@3
refused "solve with an unknown solver" "unknown solver 'bogus'" "expected one of: " \
  solve office@3 --solver nlopt,bogus
refused "solve without a deadline" --deadline: "'nan'; expected a number" \
  solve office@3 --deadline nan

# --- Folders of others stay as they are.
mkdir foreign
echo precious >foreign/notes.txt
echo precious >file
for target in foreign file file/below; do
  refused "--out $target" "$target" expected explore office --time-limit 1 --quiet --out "$target"
done
[[ "$(ls foreign)" == notes.txt && "$(<foreign/notes.txt)" == precious && "$(<file)" == precious ]] ||
  fail "a folder or file of others was touched"

# --- The other commands.
succeeds "config" config
cp out.txt defaults.yaml
succeeds "config of its own output" config defaults.yaml
cmp -s out.txt defaults.yaml || fail "prospect config does not read back as itself"
printf 'planner: {N: 24, weights: {w_e: 0.75}}\nrobot: {shape: {type: box}}\n' >own.yaml
succeeds "config of a file" config own.yaml
cp out.txt effective.yaml
grep -q 'N: 24 ' effective.yaml || fail "config does not show what the file says"
succeeds "config of its own output" config effective.yaml
cmp -s out.txt effective.yaml || fail "prospect config FILE does not read back as itself"
succeeds "the reference of all keys" config --reference
grep -q '^| `planner.frontiers.failed_observation` |' out.txt || fail "config --reference: no table of keys"
refused "the reference of a file" "'own.yaml'" "expected it alone" config own.yaml --reference
succeeds "options of the back end" config --set planner.solver=hybrid --set planner.options.basins=3
grep -q 'basins: 3 ' out.txt || fail "config does not show the options of the back end"
refused "an unknown option of the back end" "planner.options.basin: hybrid: unknown option 'basin'" \
  "did you mean 'basins'?" config --set planner.solver=hybrid --set planner.options.basin=3
refused "an option of the back end out of range" "planner.options.tolerance" "expected 0 to 1" \
  config --set planner.options.tolerance=2
refused "options that another back end does not take" "--set planner.options.basins=3: planner.options.basins:" "expected one of" \
  "${explore[@]}" office --set planner.options.basins=3 --solver nlopt
timed_out "a run with a configuration" explore office --time-limit 1 --quiet --out with_own \
  --config own.yaml
grep -q 'N: 24 ' with_own/config.yaml || fail "the run's config.yaml is not the one in effect"
timed_out "a run with the default configuration in full" explore office --time-limit 5 --seed 3 \
  --quiet --out full --config defaults.yaml
cmp -s full/steps.csv first/steps.csv || fail "the defaults written out plan differently"


# --- What the command line chooses stands in config.yaml.
run explore office --sensors camera --solver sampling --time-limit 1 --quiet --out cameras --json
if ((code == 3)); then
  grep -q 'not built in' err.txt || fail "cameras that are not built in: no message but '$err'"
else
  ((code == 1)) || fail "a mission with cameras: exit $code, expected 1: its time is up; '$err'"
  for chosen in 'sensors: camera' 'solver: sampling' 'time_limit: 1 '; do
    grep -q "$chosen" cameras/config.yaml || fail "config.yaml does not say '$chosen'"
  done
  grep -q '"jpeg"' cameras/report.html || fail "the report of a mission with cameras has no image"
  timed_out "a run repeated by its config.yaml" explore office --config cameras/config.yaml --quiet \
    --out repeated
  cmp -s cameras/steps.csv repeated/steps.csv || fail "config.yaml does not repeat the run"
fi
refused "sensors that there are not" --sensors "expected one of: model, camera" "${explore[@]}" --sensors eyes

# named WHAT NAME...: each at the start of a line of the output.
named() {
  local name
  for name in "${@:2}"; do grep -q "^$name " out.txt || fail "$1: no '$name' in '$out'"; done
}
succeeds "list solvers" list solvers
named "list solvers" nlopt nlopt:LD_SLSQP ipopt sampling
succeeds "list worlds" list worlds
named "list worlds" office corridor loop
succeeds "list modes" list modes
for row in '| any | exhausted for look_around | done | explored |' '| retreat | 0 | 2 |' \
  '| reduced margin |' '| hold |'; do
  grep -qF "$row" out.txt || fail "list modes: no row '$row'"
done
succeeds "list links" list links
for row in '/cmd_vel' '| emergency stop | none | 1 or more | 1 |'; do
  grep -qF "$row" out.txt || fail "list links: no row '$row'"
done
printf 'emergency_stop: /stop\nemergency_stop_publishers: 2\ncommand: {dead_man: 0.5}\n' >robot.yaml
succeeds "list links of a robot" list links --ros robot.yaml --json
grep -q '"topic": "/stop"' out.txt || fail "list links --ros: no '/stop' in '$out'"
refused "links of a robot, of worlds" "--ros: given with 'worlds'" "expected it with links" \
  list worlds --ros robot.yaml
rm robot.yaml
succeeds "list modes as JSON" list modes --json
grep -q '"cause": "localization lost"' out.txt || fail "list modes --json: no cause"
succeeds "list drive-modes" list drive-modes
grep -qF '| any | an emergency stop is asked for | stopping | emergency stop |' out.txt ||
  fail "list drive-modes: no row of the emergency stop"
succeeds "list drive-modes as JSON" list drive-modes --json
grep -q '"cause": "source stale"' out.txt || fail "list drive-modes --json: no cause"
succeeds "list adapters" list adapters
named "list adapters" gazebo cameras meshes sqlite
# The Python package is no part of the program: it is there where its files are.
mkdir -p alone/python/prospect
cp "$prospect" alone/prospect
python_row() { alone/prospect list adapters | grep '^python '; }
[[ "$(python_row)" == *"[not built in: needs "* ]] || fail "list adapters: python without its files: '$(python_row)'"
if "$prospect" list adapters | grep '^python ' | grep -vq 'not built in'; then
  touch alone/python/prospect/{_core,_program}.cpython-311-x86_64-linux-gnu.so
  [[ "$(python_row)" != *"not built in"* ]] || fail "list adapters: python with its files: '$(python_row)'"
fi
succeeds "list terms" list terms
named "list terms" control_effort obstacles visible_features exploration_gain cost_to_go clearance
# The terms listed are those that problems have: of a base with speed in its inputs, and in its state.
problem_terms() {
  "$prospect" solve office@1 --json --max-evaluations 1 "$@" |
    sed -n '/"terms": {/,/^    }/s/^      "\([a-z_]*\)": {$/\1/p'
}
cat > all_terms.yaml <<'YAML'
planner: {weights: {w_h: 0.1, w_c: 0.1}}
YAML
cat > all_terms_accel.yaml <<'YAML'
robot: {model: unicycle_accel}
planner: {weights: {w_h: 0.1, w_c: 0.1}}
YAML
{ problem_terms --config all_terms.yaml; problem_terms --config all_terms_accel.yaml; } | sort -u > have.txt
"$prospect" list terms | sed 's/ .*//' | sort > listed.txt
diff have.txt listed.txt > out.txt || fail "list terms is not what problems have: $(cat out.txt)"
for what in solvers worlds terms sets; do
  succeeds "list $what --json" list "$what" --json
  [[ "$out" == \[*\"name\":*\] ]] || fail "list $what --json: '$out'"
  ! grep -qiw nan out.txt || fail "list $what --json has a number that is none"
done

# All of it at once: names in short, or one document.
succeeds "list" list
for text in solvers worlds terms sets modes drive-modes adapters "  office office_bare corridor loop" nlopt:LD_SLSQP "look around"; do
  grep -qE "^$text|  ?$text" out.txt || fail "list: no '$text' in '$out'"
done
(($(wc -l <out.txt) < 25)) || fail "list: $(wc -l <out.txt) lines are not short"
{
  echo "{"
  separator=""
  for what in solvers worlds terms sets modes drive-modes links bases adapters; do
    printf '%s  "%s": ' "$separator" "$what"
    "$prospect" list "$what" --json | sed '2,$s/^/  /' | head -c -1
    separator=$',\n'
  done
  printf '\n}\n'
} >listed.json
succeeds "list --json" list --json
cmp -s out.txt listed.json || fail "list --json is not what its parts are: $(diff out.txt listed.json | head)"

# --- The program alone, and its version.
succeeds "no command"
cp out.txt alone.txt
succeeds "--help" --help
cmp -s out.txt alone.txt || fail "the program alone does not print its help"
succeeds "--version" --version
[[ "$(head -1 out.txt)" =~ ^prospect\ [0-9]+\.[0-9]+\.[0-9]+$ ]] || fail "--version: '$out'"
for row in "commit  *\([0-9a-f]\{40\}\|none\)" "compiler  *[A-Z]" "flags  *-[^$]*$" "build type  *" "Eigen  *3\." \
  "OctoMap  *1.*liboctomap.so" "HDF5  *1.*libhdf5" "yaml-cpp  *0"; do
  grep -q "^$row" out.txt || fail "--version: no row '$row' in '$out'"
done
# Loading OpenCV's codecs of images takes longer than many a command: who uses them loads them.
libraries="$(LD_TRACE_LOADED_OBJECTS=1 "$prospect")"
[[ "$libraries" != *imgcodecs* ]] || fail "each start loads the codecs of images"
codecs="$(grep -o 'libopencv_core[^ ]*' <<<"$libraries" | head -1)"
codecs="${codecs/core/imgcodecs}"
# Without them pages have their pictures, and a robot's compressed images are refused before they come.
mkdir damaged
echo "no library" >"damaged/$codecs"
LD_LIBRARY_PATH=damaged timed_out "explore without codecs" explore office --time-limit 1 --quiet --out uncoded
LD_LIBRARY_PATH=damaged succeeds "figures without codecs" report uncoded --figure map --format png --out uncoded/figures
[[ "$(head -c 4 uncoded/figures/map.png | tail -c 3)" == PNG ]] || fail "figures without codecs: no PNG"
printf 'domain: 95\nloopback: true\ntimeout: 0.1\ncommand: {dead_man: 0.5}\nstereo: {compressed: true}\n' >topics.yaml
LD_LIBRARY_PATH=damaged run drive --base dds --ros topics.yaml --out none
((code == 3)) || LD_LIBRARY_PATH=damaged refused "compressed images and no codecs" "$codecs: " "; expected OpenCV's codecs" \
  drive --base dds --ros topics.yaml --out none
succeeds "--version --json" --version --json
for key in version commit commit_changed compiler flags build_type libraries name built_with runs_with; do
  grep -q "\"$key\": " out.txt || fail "--version --json has no '$key'"
done
! grep -qF "$HOME" out.txt || fail "--version --json has a path of this machine"

succeeds "solve" solve office@3 --solver nlopt,ipopt,sampling --json
for key in solver cost violation terms cost_evaluations gradient_evaluations iterations wall_ms \
  stop_reason quality detail; do
  (($(grep -c "^    \"$key\": " out.txt) == 3)) || fail "solve: '$key' not three times"
done
for term in control_effort cost_to_go visible_features clearance; do
  (($(grep -c "^      \"$term\": {" out.txt) == 3)) || fail "solve: term '$term' not three times"
done
[[ "$(grep '^    "solver": ' out.txt | tr -d ' ",' | tr '\n' ' ')" == \
  "solver:nlopt solver:ipopt solver:sampling " ]] || fail "solve: not the solvers that were asked for"
succeeds "solve as a table" solve office@3 --solver sampling
named "solve as a table" sampling control_effort
succeeds "solve with an option" solve office@3 --solver hybrid,patience=2,nlopt
grep -q '^hybrid,patience=2 ' out.txt || fail "solve: no row of a back end with its option"
refused "an option that a back end does not have" "has no option 'patience'" "expected" \
  solve office@3 --solver nlopt,patience=2
cat >expressions.json <<'END'
{"problems": [
 {"name": "free", "n": 1, "x0": [0], "objective": "x1", "inequalities_nonneg": [], "equalities_zero": [], "lower": [null], "upper": [null]},
 {"name": "bowl", "n": 1, "x0": [3], "objective": "(x1-1)^2", "inequalities_nonneg": [], "equalities_zero": [], "lower": [-5], "upper": [5]}]}
END
succeeds "solve expressions" solve expressions.json --solver nlopt --clock cpu --json
[[ "$(grep -E '"(stop_reason|quality)"' out.txt | tr -d ' ",' | tr '\n' ' ')" == \
  "stop_reason:unbounded quality:feasible stop_reason:converged quality:feasibleoptimum " ]] ||
  fail "solve expressions: $(grep -E '"(stop_reason|quality)"' out.txt)"
(($(grep -c '"cpu_ms": ' out.txt) == 2)) || fail "solve --clock cpu: no times of the processor"
# No time is no missing library.
run solve office@3 --solver nlopt,hybrid --deadline 1e-6
((code == 1)) || fail "solve with no time: exit $code"

# --- Problem files: of a mission that goes on as if none was written, and solved as if one was there.
for n in saved saved_again; do
  timed_out "a mission that saves problems" explore office --time-limit 5 --seed 3 --quiet \
    --out "$n" --save-problems 4
  [[ "$(ls "$n/problems" | tr '\n' ' ')" == "step_000000.h5 step_000004.h5 step_000008.h5 " ]] ||
    fail "not the problems of every fourth step: '$(ls "$n/problems")'"
done
cmp -s saved/steps.csv first/steps.csv || fail "saving problems changes the mission"
diff -r saved/problems saved_again/problems || fail "problem files differ between two equal runs"
succeeds "solve a step of a mission" solve office@8 --seed 3 --solver nlopt,ipopt,sampling --json
grep -v '"wall_ms"' out.txt >of_mission.json
succeeds "solve a problem file" solve saved/problems/step_000008.h5 --seed 3 \
  --solver nlopt,ipopt,sampling --json
grep -v '"wall_ms"' out.txt | diff of_mission.json - ||
  fail "a problem file is solved differently from the mission's problem"
refused "solve a problem file with a setting of no effect" "--set" "expected a WORLD@STEP" \
  solve saved/problems/step_000008.h5 --set planner.N=10
succeeds "solve two problem files" solve --solver sampling saved/problems/step_00000{0,4}.h5
named "solve two problem files" saved/problems/step_000000.h5: saved/problems/step_000004.h5:

problem=saved/problems/step_000004.h5
head -c 30000 $problem >truncated.h5
cp $problem flipped.h5
printf '\xff\xff' | dd of=flipped.h5 bs=1 seek=60 conv=notrunc status=none
cp first/map.bt map.h5
for file in truncated.h5 flipped.h5 map.h5 first/map.bt empty.bt nothing.h5 folder first/steps.csv; do
  refused "$file as a problem" "prospect: $file: " "; expected " solve "$file" --solver sampling
  (($(wc -l <err.txt) == 1)) || fail "$file as a problem: more than one line: '$err'"
done
refused "a bad problem after a good one" truncated.h5 "; expected a whole problem file" \
  solve $problem truncated.h5 --solver sampling

# --- Plug-ins: wherever a solver can be named.
succeeds "list solvers of a plug-in" list solvers --plugin "$plugin"
named "list solvers of a plug-in" differential_evolution nlopt sampling
succeeds "list solvers of a plug-in with its options" list solvers --json --plugin "$plugin"
grep -qF '"crossover"' out.txt || fail "list solvers --json --plugin: no option of the plug-in"
succeeds "list solvers of two plug-ins" list solvers --plugin "$plugin" --plugin "$faulty"
named "list solvers of two plug-ins" differential_evolution misfit nlopt
succeeds "list solvers without the plug-in" list solvers
! grep -q differential_evolution out.txt || fail "a plug-in that was not asked for is listed"
succeeds "solve with a plug-in" solve $problem --plugin "$plugin" --json \
  --solver nlopt,differential_evolution
# How good the plug-in's answer is within its iterations depends on the mission's problem.
(($(grep -cE '"solver": "(nlopt|differential_evolution)"' out.txt) == 2 && $(grep -c '"quality": "feasible' out.txt) >= 1)) \
  || fail "solve with a plug-in: '$out'"
for n in once twice; do
  timed_out "explore with a plug-in" explore --plugin "$plugin" office --time-limit 2 --quiet \
    --solver differential_evolution --out "plugin_$n" --json
done
grep -q '"solver": "differential_evolution"' out.txt || fail "explore with a plug-in: '$out'"
cmp -s plugin_once/steps.csv plugin_twice/steps.csv || fail "a plug-in's mission is not repeatable"
printf 'planner:\n  solver: differential_evolution\n' >needs_plugin.yaml
succeeds "a configuration with its solver" config needs_plugin.yaml --plugin "$plugin"
grep -q '^  solver: differential_evolution ' out.txt || fail "config --plugin: '$out'"
refused "that configuration without it" needs_plugin.yaml:2: \
  "unknown solver 'differential_evolution'" config needs_plugin.yaml
refused "its solver without it" "unknown solver 'differential_evolution'" "expected one of" \
  "${explore[@]}" office --solver differential_evolution
refused "a misspelt solver of a plug-in" "did you mean 'differential_evolution'?" "expected one of" \
  "${explore[@]}" office --plugin "$plugin" --solver diferential_evolution
refused "a configuration's misspelt solver" solver.yaml:3: ", differential_evolution" \
  "${explore[@]}" office --plugin "$plugin" --config solver.yaml
head -c 60000 "$plugin" >cut.so
cp first/steps.csv text.so
# refused_plugin FILE EXPECTED: by every command that takes plug-ins, in one line.
refused_plugin() {
  local command
  for command in "list solvers" "solve $problem --solver nlopt" "${explore[*]} office" config; do
    # shellcheck disable=SC2086
    refused "$command --plugin $1" "plug-in '$1': " "$2" $command --plugin "$1"
    (($(wc -l <err.txt) == 1)) || fail "$command --plugin $1: more than one line: '$err'"
  done
}
refused_plugin nothing.so "no such file; expected a shared library (.so)"
refused_plugin folder "is a directory; expected a shared library (.so)"
refused_plugin text.so "; expected a shared library (.so)"
refused_plugin cut.so "the file is cut off; expected a shared library (.so)"
refused_plugin "$no_plugin" "has no entry point; expected a function 'prospect_plugin'"
interface="$(sed -n 's/.*kPluginInterface = \([0-9]*\);.*/\1/p' "$tests/../../solvers/plugin.h")"
PROSPECT_TEST_FAULT=interface refused_plugin "$faulty" "has plug-in interface $((interface + 1)); expected $interface, that of"
PROSPECT_TEST_FAULT=alignment refused_plugin "$faulty" "; expected 16, as this program"
PROSPECT_TEST_FAULT="built in" refused_plugin "$faulty" "named 'nlopt:LD_SLSQP' already; expected"
PROSPECT_TEST_FAULT="no factory" refused_plugin "$faulty" "'misfit' has no factory; expected one"
PROSPECT_TEST_FAULT="factory throws" refused_plugin "$faulty" "the factory of 'misfit' failed: two lines"
refused "the same plug-in twice" "'differential_evolution' already" "expected another name" \
  list solvers --plugin "$plugin" --plugin "$plugin"
# What fails while it solves is told from what was refused: the comparison has failed, not the input.
export PROSPECT_TEST_FAULT="solve throws"
run solve $problem --plugin "$faulty" --solver misfit,nlopt --json
unset PROSPECT_TEST_FAULT
((code == 0)) || fail "a plug-in that throws beside one that solves: exit $code; '$err'"
grep -qx 'prospect: misfit: misfit: the plug-in failed: no solution today' err.txt ||
  fail "a plug-in that throws: '$err'"

# --- Terms from outside.
term=(--plugin "$term_plugin" --set 'planner.terms.keep_distance={weight: 3, x: 2.5, y: 2, radius: 1}')
succeeds "list terms of a plug-in" list terms --plugin "$term_plugin"
named "list terms of a plug-in" cost_to_go keep_distance
grep -qF 'radius=0.5 [m], 0.05 to 10: ' out.txt || fail "list terms --plugin: no option in '$out'"
succeeds "list terms of a plug-in as JSON" list terms --plugin "$term_plugin" --json
grep -qF '"least": 0.05' out.txt || fail "list terms --plugin --json: no range of an option"
timed_out "explore with a term" explore office --time-limit 2 --quiet --save-problems 1 "${term[@]}" \
  --out with_term
timed_out "explore without it" explore office --time-limit 2 --quiet --out without_term
head -1 without_term/steps.csv | tr ',' '\n' >columns_without.txt
head -1 with_term/steps.csv | tr ',' '\n' >columns_with.txt
[[ "$(diff columns_without.txt columns_with.txt | grep '^[<>]')" == "> term_keep_distance
> weight_asked_keep_distance
> weight_keep_distance" ]] ||
  fail "the columns with a term: $(diff columns_without.txt columns_with.txt)"
grep -A1 -x "$(grep -x -B1 term_keep_distance columns_with.txt | head -1)" columns_without.txt |
  grep -qx predicted_features || fail "the term's column does not come after the built-in ones"
grep -q 'keep_distance' with_term/report.html || fail "the report does not know the term"
grep -A5 'keep_distance:' with_term/config.yaml | grep -q 'radius: 1' ||
  fail "config.yaml does not hold the term's options"
timed_out "its own config.yaml" explore office --time-limit 2 --quiet --plugin "$term_plugin" \
  --config with_term/config.yaml --out with_term_again
cmp -s with_term/steps.csv with_term_again/steps.csv || fail "config.yaml gives another mission"
saved_problem="$(ls with_term/problems/*.h5 | head -1)"
succeeds "solve with a term" solve "$saved_problem" --plugin "$term_plugin" --solver sampling --json
grep -q '"keep_distance"' out.txt || fail "solve of a problem file with a term: '$out'"
refused "its problem file without the plug-in" "$saved_problem: " \
  "needs the term 'keep_distance', which is not there; expected the plug-in" \
  solve "$saved_problem" --solver sampling
(($(wc -l <err.txt) == 1)) || fail "a problem file with a missing term: more than one line: '$err'"
succeeds "list sets of a plug-in" list sets --plugin "$term_plugin"
named "list sets of a plug-in" zoo person
succeeds "bench of terms" bench person with_term/problems --plugin "$term_plugin" --solver \
  sampling,nlopt:LD_LBFGS --deadline 0.05 --repeat 1 --out bench_terms
named "bench of terms" sampling nlopt:LD_LBFGS
refused "a term that is not there" "unknown term 'keep_distance'" "expected one of: control_effort" \
  "${explore[@]}" office --set 'planner.terms.keep_distance={weight: 3}'
refused "a misspelt term" "did you mean 'keep_distance'?" "expected one of" \
  "${explore[@]}" office --plugin "$term_plugin" --set 'planner.terms.keep_distnace={weight: 3}'
refused "a misspelt option" "planner.terms.keep_distance.radios" "did you mean 'radius'?" \
  "${explore[@]}" office --plugin "$term_plugin" --set 'planner.terms.keep_distance={radios: 3}'
refused "an option out of range" "planner.terms.keep_distance.radius" "expected" \
  "${explore[@]}" office --plugin "$term_plugin" --set 'planner.terms.keep_distance={radius: 99}'
refused "a weight out of range" "planner.terms.keep_distance.weight" "expected" \
  "${explore[@]}" office --plugin "$term_plugin" --set 'planner.terms.keep_distance={weight: -1}'
refused "a weight in two places" planner.weights.w_T planner.terms.cost_to_go.weight \
  "${explore[@]}" office --set planner.weights.w_T=1 --set 'planner.terms.cost_to_go={weight: 2}'
timed_out "without a built-in term" explore office --time-limit 1 --quiet --out without_gain \
  --set 'planner.terms.exploration_gain={weight: 0}'
! head -1 without_gain/steps.csv | grep -q exploration_gain || fail "weight 0 does not leave a term out"
PROSPECT_TEST_FAULT="term: evaluate throws" timed_out "a term that fails" explore office \
  --time-limit 1 --quiet --plugin "$faulty" --set 'planner.terms.odd_term={weight: 1}' --out odd_term
grep -q "Planned without term 'odd_term': its value is a finite number at no seed" odd_term/steps.csv ||
  fail "a term that fails is not told of: $(tail -1 odd_term/steps.csv)"
PROSPECT_TEST_FAULT="not optimised" run list solvers --plugin "$faulty"
((code == 0)) || fail "a plug-in that is not optimised: exit $code; '$err'"
[[ "$err" == "prospect: plug-in '$faulty': was compiled without optimisation"* ]] ||
  fail "a plug-in that is not optimised is not told of: '$err'"
PROSPECT_TEST_FAULT="problem: throws" refused "a problem that cannot be made" \
  "problem 'one' of set 'odd_set': " "no problem today" bench odd_set --plugin "$faulty" --solver nlopt

# --- Bench: whole sets, a folder of results that appears whole or not at all.
succeeds "list sets" list sets
named "list sets" zoo s30 missions
succeeds "bench" bench zoo saved/problems --solver nlopt:LD_SLSQP,sampling,max_evaluations=200 \
  --deadline 0,0.05 --repeat 1 --out bench
for text in "all, 16 problems, no deadline" "zoo, 13 problems, deadline 50 ms" \
  "problems, 3 problems, no deadline" "bench/bench.html"; do
  grep -qF "$text" out.txt || fail "bench: no '$text' in '$out'"
done
named bench solver nlopt:LD_SLSQP sampling,max_evaluations=200
[[ "$(ls bench | tr '\n' ' ')" == "bench.csv bench.html bench.json curves.csv figures planner_arena rows.jsonl summary.csv " ]] ||
  fail "bench: $(ls bench)"
[[ "$(ls bench/planner_arena | tr '\n' ' ')" == "problems.log problems_50ms.log zoo.log zoo_50ms.log " ]] ||
  fail "bench/planner_arena: $(ls bench/planner_arena)"
for name in all_50ms_targets_over_time zoo_profile_by_evaluations problems_gap_over_time; do
  grep -q '</svg>' "bench/figures/$name.svg" || fail "bench has no figure $name"
done
(($(wc -l <bench/bench.csv) == 1 + 16 * 2 * 2)) || fail "bench.csv has $(wc -l <bench/bench.csv) lines"
# without "ms load" FILE.csv: all but the columns of these names.
without() {
  awk -F, -v names="$1" '
    NR == 1 { n = split(names, given, " "); for (i = 1; i <= n; i++) out[given[i]] = 1
              for (i = 1; i <= NF; i++) { if ($i in out) { drop[i] = 1; delete out[$i] } }
              for (name in out) print "no column", name }
    { line = ""; for (i = 1; i <= NF; i++) if (!(i in drop)) line = line $i ","; print line }' "$2"
}
# What no clock and no load decides repeats exactly: costs, counts, who solves what.
timed="ms_to_target wall_ms cpu_ms overrun_ms load"
counted() { without "$timed" "$1/bench.csv" | grep ',nlopt:LD_SLSQP,,'; }
# The same solvers: what is solved is judged by the best that any of them found.
succeeds "bench again into the same folder" bench zoo saved/problems --solver nlopt:LD_SLSQP,sampling,max_evaluations=200 \
  --deadline 0 --repeat 2 --out bench_again --json
diff <(counted bench) <(counted bench_again) || fail "two benches of one set differ"
cp bench_again/rows.jsonl measured
refused "a bench over one that is whole" "--out bench_again: holds a bench; expected --resume, or another folder" "or --overwrite" \
  bench --quick --solver sampling --deadline 0 zoo --out bench_again
cmp -s measured bench_again/rows.jsonl || fail "a refused bench lost rows"
succeeds "bench over an earlier one" bench --quick --solver sampling --deadline 0 zoo --out bench_again --overwrite
grep -q '"solved": true' bench_again/bench.json || fail "bench.json: nothing solved"
succeeds "bench that keeps the best" bench saved/problems --solver nlopt --deadline 0 --repeat 1 \
  --out bench_kept --keep-best
grep -q '"step_000008": -\?[0-9]' saved/problems/best_known.json || fail "no best costs are kept"
succeeds "bench with best costs known" bench saved/problems --solver nlopt --deadline 0 --repeat 1 \
  --out bench_kept --overwrite
grep -q '"best_known_by": "stored"' bench_kept/bench.json || fail "best_known.json is not read"
# A bench that was broken off: with all its tables, half of its rows and one that is cut off.
succeeds "a whole bench" bench zoo --solver nlopt,sampling --deadline 0 --repeat 1 --seed 1,2 --max-evaluations 300 --out whole
succeeds "half of it" bench zoo --solver nlopt --deadline 0 --repeat 1 --seed 1,2 --max-evaluations 300 --out half
cp -r half broken
head -c -20 half/rows.jsonl >broken/rows.jsonl
sed -i '/^complete$/d' broken/.prospect
refused "a bench over one that was broken off" "--out broken" "expected --resume, or another folder" \
  bench zoo --solver nlopt,sampling --out broken
cmp -s <(head -c -20 half/rows.jsonl) broken/rows.jsonl || fail "a refused bench lost rows"
refused "a bench resumed and written over" --resume "beside --overwrite" \
  bench zoo --solver nlopt,sampling --resume --overwrite --out broken
refused "a bench resumed with other evaluations" "--resume broken: evaluations at most: 300 there" \
  "expected the command that began it" bench zoo --solver nlopt,sampling --deadline 0 --repeat 1 --seed 1,2 --resume --out broken
refused "a bench resumed without its back end" "back end 'nlopt' is there, not asked for" "expected the command" \
  bench zoo --solver sampling --deadline 0 --repeat 1 --seed 1,2 --max-evaluations 300 --resume --out broken
sleep 1 # of two runs in one second, with one load, the environment is the same
succeeds "a bench resumed" bench zoo --solver nlopt,sampling --deadline 0 --repeat 1 --seed 1,2 --max-evaluations 300 \
  --resume --out broken
timeless() { without "$timed" "$1/bench.csv"; }
diff <(timeless whole) <(timeless broken) || fail "a resumed bench is another one"
(($(grep -c '"environment":' broken/rows.jsonl) == 2)) || fail "a resumed bench has not two environments"
succeeds "the other half" bench zoo --solver sampling --deadline 0 --repeat 1 --seed 1,2 --max-evaluations 300 --out other_half
succeeds "bench merge" bench merge half other_half --out merged
diff <(timeless whole) <(timeless merged) || fail "a merged bench is another one"
succeeds "bench compare" bench compare whole merged
[[ "$(grep -c 'the same costs and counts' out.txt)" == 2 ]] || fail "bench compare: '$out'"
refused "bench merge of a bench with itself" "is in another bench, too" "expected each row once" \
  bench merge half half --out run
refused "bench merge into one of them" "--out is 'half'" "expected a folder of its own" bench merge half other_half --out half
refused "bench compare of one" "1 folders" "expected two" bench compare half
refused "bench compare with an option of a measurement" "bench compare: an option of a measurement" "expected --tolerance" \
  bench compare half merged --solver nlopt
refused "bench with a seed twice" "--seed: the same twice" "expected each once" bench zoo --seed 1,1
cp -r saved/problems some_damaged
cp truncated.h5 some_damaged/step_000009.h5
cp -r saved/problems bad_best
echo '{"costs": {"step_000000": "low"}}' >bad_best/best_known.json
mkdir no_problems
bench=(bench --repeat 1 --out run)
refused "bench of an unknown set" "'zo'" "did you mean 'zoo'?" "${bench[@]}" zo
refused "bench of a missing folder" nowhere/at/all "no such file or folder" "${bench[@]}" nowhere/at/all
refused "bench of a folder without problems" no_problems "expected a folder of problem files" \
  "${bench[@]}" no_problems
refused "bench of a damaged problem" truncated.h5 "expected a whole problem file" \
  "${bench[@]}" zoo truncated.h5
refused "bench of a folder with a damaged one" some_damaged/step_000009.h5 \
  "expected a whole problem file" "${bench[@]}" some_damaged
refused "bench with bad best costs" bad_best/best_known.json "'step_000000' is no number; expected" \
  "${bench[@]}" bad_best
refused "bench of a set twice" "'zoo'" "expected sets of different names" "${bench[@]}" zoo zoo
refused "bench with a configuration of no effect" "--set" "expected the set 'missions'" \
  "${bench[@]}" zoo --set planner.N=10
refused "bench with an unknown key" "--set planner.NN=10: unknown key" "did you mean 'N'?" \
  "${bench[@]}" missions --set planner.NN=10
refused "bench with an unknown solver" "did you mean 'hybrid'?" "expected one of" \
  "${bench[@]}" zoo --solver hybird
refused "bench with an unknown option" "did you mean 'basins'?" "expected one of" \
  "${bench[@]}" zoo --solver hybrid,basin=3
refused "bench with a bad deadline" --deadline: "'soon'; expected a number" \
  "${bench[@]}" zoo --deadline 0.1,soon
refused "bench with one deadline twice" --deadline "expected each once" \
  "${bench[@]}" zoo --deadline 0.1,0.1
refused "bench that keeps the best of no folder" "'zoo'" "expected folders" "${bench[@]}" zoo --keep-best
cat >hs35.json <<'JSON'
{"problems": [{"name": "HS35", "n": 3, "x0": [0.5, 0.5, 0.5], "f_opt": 0.1111111111111111,
  "objective": "9-8*x1-6*x2-4*x3+2*x1^2+2*x2^2+x3^2+2*x1*x2+2*x1*x3", "equalities_zero": [],
  "inequalities_nonneg": ["3-x1-x2-2*x3"], "lower": [0, 0, 0], "upper": [null, null, null]}]}
JSON
succeeds "bench of expressions" bench hs35.json --solver nlopt --deadline 0 --out bench_hs35
grep -q '^nlopt  *1/1 ' out.txt || fail "bench of expressions: not solved: '$out'"
sed 's/"f_opt": 0.1111111111111111,//' hs35.json >unknown.json
succeeds "bench of an unknown optimum" bench unknown.json --solver nlopt --deadline 0 --repeat 1 --out bench_unknown
grep -q '"best_known_by": "nlopt"' bench_unknown/bench.json || fail "bench does not say who found the best known cost"
grep -q ',feasible optimum,' bench_unknown/bench.csv || fail "bench: a true optimum is not called one"
sed 's/x1-x2-2/x1-x2 2/' hs35.json >misspelt.json
refused "bench of a misspelt expression" "misspelt.json: problem 1 'HS35'" \
  "expected an operator" "${bench[@]}" misspelt.json
succeeds "bench that captures missions" bench --capture captured --quick
[[ "$(ls captured | wc -l)" == 9 && -s captured/plan-1_000022.h5 ]] || fail "captured: $(ls captured)"
# What measured stands in the results, and nothing of this machine's names.
for key in build processor cores system kernel load commit commit_changed compiler flags build_type libraries runs_with \
  cancelled optimality x trace; do
  grep -q "\"$key\": " bench_again/bench.json || fail "bench.json has no '$key'"
done
! grep -qF -e "$work" -e "$HOME/" bench_again/bench.json || fail "bench.json has a path of this machine"
refused "bench with a value out of range" "sampling: option 'max_evaluations' is 0" "expected 1 or more" \
  "${bench[@]}" zoo --solver nlopt,sampling,max_evaluations=0
refused "bench with a value that a library does not take" "ipopt: Ipopt does not take 'sometimes' for option" mu_strategy \
  "${bench[@]}" zoo --solver ipopt,mu_strategy=sometimes,sampling
refused "bench with threads out of range" "'threads' is 0" "expected 1 to 256" "${bench[@]}" zoo --solver hybrid,threads=0

refused "bench that captures into a folder of others" foreign "expected a new or empty folder" \
  bench --capture foreign
refused "bench that captures a set" "'zoo'" "expected no set" bench zoo --capture run
refused "bench into a folder of others" foreign "holds other files; expected" bench zoo --out foreign
refused "bench into a file" file "expected a new or empty folder" bench zoo --out file
[[ "$(ls foreign)" == notes.txt && "$(<file)" == precious ]] || fail "bench touched a file of others"

# --- Figures of a run.
succeeds "a world for Gazebo" export corridor --sdf exported/corridor.sdf
for file in corridor.sdf corridor.obj corridor.mtl corridor_0.png; do
  [[ -s exported/$file ]] || fail "export wrote no $file"
done
refused "no name of a file" "--sdf: 'exported'" "expected a file .sdf" export corridor --sdf exported
refused "pixels that are not square" "robot.stereo.fx is 450" "pixels of Gazebo are square" \
  export corridor --sdf exported/no.sdf --set robot.stereo.fy=400
[[ ! -e exported/no.sdf && ! -e exported/no.obj ]] || fail "a refused export wrote something"

cat >field.world <<'SDF'
<sdf version="1.6"><world name="field"><model name="m"><link name="l"><visual name="v"><geometry><plane><size>8 6</size></plane></geometry></visual>
</link></model></world></sdf>
SDF
succeeds "a Gazebo world with the robot" export field.world --sdf exported/field.sdf --start 1 2 90
[[ "$(<exported/field.sdf)" == *"<size>8 6</size>"*"<model name=\"robot\">"*"<pose>1 2 0 0 0 1.5707"* ]] || fail "no robot in field.sdf"
refused "a robot that is there" "field.sdf:" "expected a world without the robot" export exported/field.sdf --sdf exported/no.sdf

# A drawn plan: how it is read, before a robot drives in it.
printf 'P2 60 40 255\n' >drawn.pgm
for ((j = 0; j < 40; ++j)); do
  for ((i = 0; i < 60; ++i)); do
    if ((j == 0 || j == 39 || i == 0 || i == 59)); then printf '0 '; elif ((i > 40 && j > 25)); then printf '205 '; else printf '254 '; fi
  done
done >>drawn.pgm
succeeds "how a plan is read" inspect drawn.pgm --picture read.svg
for said in "3 x 2 m, cells of 0.1 m" "scale: assumed, 0.05 m a pixel" "start: (" "m2 can be seen" read.svg; do
  [[ "$out" == *"$said"* ]] || fail "inspect --picture does not say '$said': '$out'"
done
for word in start free occupied "unknown, taken for solid" "rim: solid beyond" "can be seen"; do
  grep -q ">$word</text>" read.svg || fail "the picture of a plan does not show '$word'"
done
succeeds "a plan with its scale" inspect drawn.pgm --resolution 0.1 --start 1 1 90 --picture read.png
[[ "$out" == *"6 x 4 m"*"as stated"*"start: (1.00, 1.00) m, 90 degrees"* ]] || fail "a plan with its scale: '$out'"
cmp -s <(head -c 8 read.png) <(printf '\x89PNG\r\n\x1a\n') || fail "read.png is no PNG"
refused "a picture of unknown form" "--picture: 'read.gif'" "expected a file that ends in .png" inspect drawn.pgm --picture read.gif
refused "a picture of no world" "nowhere.pgm" "expected" inspect nowhere.pgm --picture nothing.png
[[ ! -e nothing.png ]] || fail "a picture of no world was written"
timed_out "a plan without a scale" explore drawn.pgm --time-limit 1 --quiet --out drawn --unknown free
[[ "$(<err.txt)" == *"drawn: taken for 0.05 m a pixel (--resolution says otherwise), so 3 x 2 m"* ]] || fail "an assumed scale is not told: '$(<err.txt)'"

succeeds "report of a run" report first --figure path,map --out figures
for file in path.png path.svg map.png map.svg; do
  [[ -s figures/$file ]] || fail "report wrote no $file"
done
[[ "$out" == figures/path.svg$'\n'figures/path.png$'\n'figures/map.svg$'\n'figures/map.png ]] || fail "report says '$out'"
cmp -s <(head -c 8 figures/path.png) <(printf '\x89PNG\r\n\x1a\n') || fail "path.png is no PNG"
[[ "$(tail -n 1 figures/path.svg)" == "</svg>" ]] || fail "path.svg is cut"
grep -q '>start</text>' figures/path.svg || fail "the path's start is not marked"
grep -q '>occupied</text>' figures/map.svg || fail "the map has no key"
succeeds "report into the run's folder" report second --figure map --format svg
[[ -s second/map.svg && ! -e second/map.png && ! -e second/path.svg ]] || fail "report wrote other files than asked for: $(ls second)"
cmp -s second/map.svg figures/map.svg || fail "the map of an equal run differs"
for by in plain features error speed; do
  succeeds "a path by $by" report first --figure path --colour $by --format svg --out figures_$by
done
grep -q '>features in view</text>' figures_features/path.svg || fail "the colours of the path are not explained"
! cmp -s figures_features/path.svg figures_plain/path.svg || fail "--colour changes nothing"
# A run that was killed has rows only.
mkdir killed
cp first/steps.csv first/trajectory_estimated.tum killed
succeeds "the path of a killed run" report killed --figure path
[[ -s killed/path.png && "$out" == *"without the map"* ]] || fail "the path of a killed run: '$out'"
refused "the map of a killed run" killed/map.bt "expected the map of a run that came to its end" report killed --figure path,map --out run
cp first/map.bt killed
refused "a map without its configuration" killed/config.yaml "expected" report killed --figure map --out run
head -c $(($(wc -c <first/map.bt) / 2)) first/map.bt >killed/map.bt
cp first/config.yaml killed
refused "a truncated map" killed/map.bt "expected" report killed --figure path,map --out run
rm killed/map.bt
head -c $(($(wc -c <first/steps.csv) - 5)) first/steps.csv >killed/steps.csv
refused "rows that are cut" killed/steps.csv: "expected the end of a line" report killed --figure path --out run
sed '3s/^[^,]*,//' first/steps.csv >killed/steps.csv
refused "a row too short" killed/steps.csv:3: "fields; expected" report killed --figure path --out run
sed '1s/estimated_x/estimate_x/' first/steps.csv >killed/steps.csv
refused "a column that is absent" "no column 'estimated_x'" "expected" report killed --figure path --out run
sed '1s/,mode,/,node,/' first/steps.csv >killed/steps.csv
refused "modes that were not recorded" "no column 'mode'" "expected" report killed --figure path --colour mode --out run
: >killed/steps.csv
refused "steps that are empty" killed/steps.csv "empty file; expected" report killed --figure path --out run
refused "report of nothing" nowhere "expected that of a run" report nowhere --figure path --out run
refused "report of a file" file "is no folder; expected" report file --figure path --out run
refused "report of a folder of others" foreign/steps.csv "no such file; expected" report foreign --figure map --out run
succeeds "two missions under one slider" report first second --out compared
[[ "$out" == compared/compared_with_second.html$'\n'"first, second: the same as long as both last" ]] || fail "a comparison says '$out'"
grep -q '"names":\["first","second"\]' compared/compared_with_second.html || fail "the comparison does not name the runs"
succeeds "a mission and another" report first fourth
[[ -s first/compared_with_fourth.html && "$out" == *"first, fourth: part at "*" s (step "*", "*": "* ]] || fail "they do not part: '$out'"
mkdir cut_page
head -c 2000 first/report.html >cut_page/report.html
cp first/steps.csv cut_page
refused "a page that is cut" cut_page/report.html: "expected the report.html of a mission" report first cut_page --out run
refused "a run that was killed" killed/report.html: "expected a mission that came to its end" report first killed --out run
refused "figures of two runs" "--figure" "expected two runs alone" report first second --figure map --out run
refused "three runs" "run:" "At Most 2 required" report first second first
refused "report without a figure" first/report.html "expected --figure path, map" report first
refused "report of an unknown figure" "'pth' (did you mean 'path'?)" "expected one of: path, map" report first --figure map,pth --out run
refused "report in an unknown format" "'gif'" "expected one of: svg, png, pdf, pgf" report first --figure map --format gif --out run
refused "report by an unknown colour" "'sped' (did you mean 'speed'?)" "expected one of: plain" report first --figure path --colour sped --out run
refused "report with a colour of no path" --colour "expected --figure path" report first --figure map --colour speed --out run
refused "report into a file" file/below "expected a writable place" report first --figure map --out file/below
[[ "$(ls foreign)" == notes.txt && "$(<file)" == precious ]] || fail "report touched a file of others"

# --- Odometry: what is no recording is refused (recordings themselves: adapters_stereo_dataset_test).
refused "odometry of nothing" nowhere "expected a recording of a stereo pair" \
  odometry nowhere --out run
mkdir -p half/image_0 half/image_1
echo "P0: 300 0 200 0 0 300 150 0 0 0 1 0" >half/calib.txt
refused "odometry with half a calibration" half/calib.txt "expected P0 and P1" odometry half --out run
echo "P1: 300 0 200 36 0 300 150 0 0 0 1 0" >>half/calib.txt
refused "odometry with exchanged cameras" half/calib.txt "expected it on the right" \
  odometry half --out run
refused "odometry from before the first frame" -1 "expected a whole number" odometry half --from -1
"$write_stereo_recording" stereo 12 || fail "no stereo recording was written"
for n in odometry1 odometry2; do
  succeeds "$n" odometry stereo --calibrate --loops --out "$n" --quiet
done
grep -qE "^  learned +5 " out.txt || fail "odometry --calibrate: no prediction five frames ahead: '$out'"
for file in odometry.html frames.csv trajectory.tum trajectory.kitti trajectory_with_loops.tum; do
  [[ -s odometry1/$file ]] || fail "odometry wrote no $file"
  cmp -s "odometry1/$file" "odometry2/$file" || fail "odometry: $file differs between two runs"
done
grep -qE "^loops +0 of 0 used, among [1-9]" out.txt || fail "odometry --loops: '$out'"
succeeds "odometry without loops" odometry stereo --out without --quiet
cmp -s odometry1/trajectory.tum without/trajectory.tum || fail "odometry --loops: the odometry's own trajectory is another"
[[ -e without/trajectory_with_loops.tum ]] && fail "odometry: loops without being asked"
succeeds "odometry of fewer corners" odometry stereo --set perception.odometry.corners.cells=60 --out fewer --quiet
cmp -s odometry1/frames.csv fewer/frames.csv && fail "odometry: perception.odometry is not read"
refused "a setting that a recording does not read" "--set perception.mapping.core=0.4" "expected it with prospect map" \
  odometry stereo --set perception.mapping.core=0.4
(($(wc -l <odometry1/frames.csv) == 13)) || fail "frames.csv has not one row a frame"
succeeds "odometry --json" odometry stereo --json --calibrate
grep -q '"calibration_error":' out.txt || fail "odometry --json --calibrate: '$out'"
succeeds "odometry --json without predictions" odometry stereo --json
! grep -q '"calibration":' out.txt || fail "odometry --json: calibrated without being asked"
succeeds "odometry of three frames" odometry stereo --calibrate --frames 3
grep -q "too few frames" out.txt || fail "odometry of three frames: '$out'"
refused "odometry from behind the last frame" "--from is 12" "expected less than the 12 frames" \
  odometry stereo --from 12 --out run
refused "odometry into a file" file "expected a new or empty folder" odometry stereo --out file
refused "odometry with a topic of no use" "--topics" "expected USE=TOPIC, with USE of: left, right" \
  odometry stereo --topics middle=/a
: >film.mp4
refused "odometry of what is no video" film.mp4 "ffmpeg" odometry film.mp4 --calibration stereo/calib.txt
mkfifo fifo.mp4
refused "odometry of a pipe" fifo.mp4 "no regular file; expected a video" odometry fifo.mp4 --calibration stereo/calib.txt
: >old.bag
refused "odometry of a bag of ROS 1" old.bag "expected one of ROS 2" odometry old.bag
echo "no bag" >no.mcap
refused "odometry of what is no bag" no.mcap "no MCAP file; expected one" odometry no.mcap
# From the second frame on the right images are the left ones.
cp -r stereo lost
for k in 01 02 03 04 05 06 07 08 09 10 11; do cp "lost/image_0/0000$k.png" lost/image_1; done
run odometry lost --json
((code == 1)) || fail "odometry of a lost recording: exit $code, expected 1; '$out'"
grep -qE "^prospect: lost: 11 of 12 frames lost, most often as .*right image" err.txt ||
  fail "odometry of a lost recording: '$err'"
for none in end_error_m end_error_percent rpe_1m_percent ate_first_pose_rmse_m estimated_length_m; do
  grep -qF "\"$none\": null" out.txt || fail "odometry of a lost recording: $none is not null"
done
# What inspect says: usable, incomplete, nothing known, no such thing.
succeeds "inspect" inspect stereo
grep -qE "^pairs +12, 0 images alone" out.txt || fail "inspect: '$out'"
succeeds "inspect --json" inspect stereo --json
grep -qF '"found": "usable"' out.txt || fail "inspect --json: '$out'"
run inspect half
((code == 1)) || fail "inspect of half a recording: exit $code, expected 1"
grep -qE "^missing +half/image_0: holds no image" out.txt || fail "inspect of half: '$out'"
mkdir -p nothing_known
run inspect nothing_known
((code == 2)) || fail "inspect of nothing known: exit $code, expected 2"
grep -qF "looked for" out.txt || fail "inspect of nothing known: '$out'"
refused "inspect of nothing" nowhere "nothing is there" inspect nowhere
succeeds "inspect of a map" inspect first/map.bt
grep -qF "OctoMap" out.txt || fail "inspect of a map: '$out'"
# A baseline half as long again: all is measured and shown, and the calibration is refused.
"$write_stereo_recording" long 24 -1 0.18 || fail "no stereo recording was written"
run odometry long --out long_out
((code == 2)) || fail "odometry with a baseline that is too long: exit $code, expected 2; '$out'"
grep -qE "^prospect: long: the path is estimated 1\.[45][0-9]* times as long .*baseline" err.txt ||
  fail "odometry with a baseline that is too long: '$err'"
[[ $(wc -l <err.txt) == 1 ]] || fail "odometry with a baseline that is too long: '$err'"
grep -q '"calibration_refused": true' long_out/summary.json || fail "summary.json: no refusal"
# So it is at the start of a mission, where the depth camera contradicts.
printf 'simulator:\n  sensors: camera\n  camera: {baseline_error: 0.5}\n' >wrong_baseline.yaml
run explore office --config wrong_baseline.yaml --quiet --time-limit 1 --out run
if ((code == 3)); then
  grep -q 'not built in' err.txt || fail "cameras that are not built in: no message but '$err'"
else
  ((code == 2)) || fail "a mission with a wrong baseline: exit $code, expected 2"
  grep -qE " 1\.(5|49)" err.txt && grep -qF "those of the depth camera" err.txt ||
    fail "a mission with a wrong baseline: '$err'"
  [[ ! -e run ]] || fail "a mission with a wrong baseline left a run folder"
fi

# --- Maps from depth images.
"$write_depth_recording" depth || fail "no depth recording was written"
for n in map1 map2; do
  succeeds "$n" map depth/posed --out "$n" --quiet
done
grep -qF "ground       found in 5 of 5" out.txt || fail "map: no ground: '$out'"
for file in map.bt map.html ground.csv exploration.png exploration.yaml obstacles.png obstacles.yaml; do
  [[ -s map1/$file ]] || fail "map wrote no $file"
  cmp -s "map1/$file" "map2/$file" || fail "map: $file differs between two runs"
done
(($(wc -l <map1/ground.csv) == 6)) || fail "ground.csv has not one row a frame"
succeeds "map --json" map depth/posed --json --frames 2 --from 1
grep -q '"frames": 2,' out.txt || fail "map --json: '$out'"
[[ ! -s err.txt ]] || fail "map --json wrote to standard error"
timed_out "a map read back" explore map1/map.bt --time-limit 1 --quiet --out run
rm -rf run
refused "map of nothing" nowhere "expected a recording of depth images" map nowhere --out run
succeeds "map of a stereo pair" map stereo --resolution 0.1 --range 3 --frames 4 --out pair --quiet
grep -qF "KITTI, 12 stereo pairs of 400 x 300 px" out.txt || fail "map of a pair: '$out'"
grep -qE "^note  *depth by stereo, f 275 px, baseline 0.12 m" out.txt || fail "map of a pair: '$out'"
grep -qE "^note  *poses by the recording, of 12 of 12 frames" out.txt || fail "map of a pair: '$out'"
grep -qF '"depth_noise_per_m": 0.0121' pair/summary.json || fail "map of a pair: $(cat pair/summary.json)"
grep -qF "depth by stereo" pair/map.html || fail "map of a pair: the page does not say what depth it is"
[[ -s pair/map.bt && -s pair/obstacles.png ]] || fail "map of a pair: $(ls pair)"
refused "map of a pair with intrinsics" "--camera: stereo" "expected --calibration" \
  map stereo --camera 275 275 200 150 --out run
refused "map of a pair with a depth scale" "--depth-scale: stereo" "expected it with depth images only" \
  map stereo --depth-scale 1000 --out run
refused "map of exchanged cameras" half/calib.txt "expected it on the right" map half --out run
refused "map of depth images with --rate" "--rate: depth/posed" "expected it with a stereo pair only" \
  map depth/posed --rate 10 --out run
refused "map without intrinsics" depth/robot ", or --camera FX FY CX CY" \
  map depth/robot --out run
succeeds "map without poses" map depth/robot --camera 262.5 262.5 159.5 119.5 --out robot
grep -qF "no poses, so the ground is measured only" out.txt || fail "map without poses: '$out'"
[[ -s robot/ground.csv && ! -e robot/map.bt ]] || fail "map without poses: $(ls robot)"
refused "map of a part that is not there" "--from is 9" "expected less than the 5 frames" \
  map depth/posed --from 9 --out run
run map depth/posed --camera-height 3 --camera-height-sigma 0.1 --out high --quiet
((code == 1)) || fail "map at no height: exit $code, expected 1"
grep -qF "no ground in any of 5 frames" err.txt && grep -qF "expected a floor" err.txt ||
  fail "map at no height: '$err'"
grep -qF "said to be 3.00 +- 0.10 m high" err.txt || fail "map at no height: '$err'"
grep -qF '"height_median_m": null' high/summary.json && grep -qF '"taken": null' high/summary.json &&
  grep -qF '"free_cells": null' high/summary.json || fail "map at no height claims: $(cat high/summary.json)"
[[ ! -e high/map.bt ]] || fail "map at no height wrote a map"
# Poses of one frame in five.
mkdir partly
cp -r depth/robot/depth partly
for file in partly/depth/*.png; do
  name=${file##*/}
  echo "$((10#${name%.png})).5 depth/$name"
done >partly/depth.txt
echo "$(head -1 partly/depth.txt | cut -d' ' -f1) 0 0 0.62 0 0 0 1" >partly/groundtruth.txt
run map partly --camera 262.5 262.5 159.5 119.5 --depth-scale 1000 --quiet
((code == 1)) || fail "map of few poses: exit $code, expected 1; '$err'"
grep -qF "4 of 5 frames have no pose" err.txt || fail "map of few poses: '$err'"
rm -rf partly
refused "map with a wild resolution" resolution "expected a number from 0.01" \
  map depth/posed --resolution nan --out run
refused "map of a range of many voxels" "--range is 4 m" "expected at most 2 m" \
  map depth/posed --resolution 0.01 --out run
refused "a map into the folder of a run" lidar: "of another kind: run; expected" map depth/lidar.log --out lidar
succeeds "map of a lidar's log" map depth/lidar.log --out lidar_map
grep -qF "CARMEN log, 20 scans of one plane, the first of 180 points" out.txt || fail "map of a log: '$out'"
grep -qF "frames       20: 20 ok, 0 degraded, 0 rejected" out.txt || fail "map of a log: '$out'"
grep -q '"ground_found": null' lidar_map/summary.json || fail "map of a log: a ground that was not looked for"
[[ -s lidar_map/map.bt && -s lidar_map/map.html ]] || fail "map of a log: $(ls lidar_map)"
succeeds "inspect of a lidar's log" inspect depth/lidar.log
grep -qF "CARMEN log, scans of one plane, for \`prospect map\`" out.txt || fail "inspect of a log: '$out'"
refused "map of a log with a camera" "--camera-height: depth/lidar.log" "expected it with a camera only" \
  map depth/lidar.log --camera-height 1 --out run
refused "map of images with a lidar" "--lidar-height: depth/posed" "expected --camera-height" \
  map depth/posed --lidar-height 1 --out run
refused "map into a file" file "expected a new or empty folder" map depth/posed --out file

# --- Whatever the command: files of others are not touched, nor what a link leads to.
mkdir theirs
printf 'conditions: {one: {}}\nworlds: [office]\nseeds: 1\n' >one.yaml
for name in steps.csv summary.json config.yaml map.png path.png map.bt rows.jsonl bench.json replay.csv results.csv first.html exported.sdf; do
  echo "my own" >theirs/$name
done
cp -r theirs theirs_before
mkdir nothing
ln -s nothing linked
for target in theirs linked linked/; do
  for command in "explore office --time-limit 1 --quiet" "drive office --time-limit 1 --quiet" "bench zoo --quick" "bench --capture $target --quick" \
    "study one.yaml" "study one.yaml --gather" "replay first --to 1 --set planner.N=12" "report first --figure path,map" \
    "map depth/posed" "odometry stereo --frames 2"; do
    out=(--out "$target")
    [[ $command != *--capture* ]] || out=()
    # shellcheck disable=SC2086
    run $command "${out[@]}"
    ((code == 2)) || fail "$command to $target: exit $code, expected 2; '$err'"
  done
done
refused "export over a file of others" "theirs/exported.sdf: is there" expected export corridor --sdf theirs/exported.sdf
diff -r theirs theirs_before || fail "a folder of others was touched"
[[ -z "$(ls -A nothing)" ]] || fail "a symbolic link was followed: $(ls -A nothing)"
echo "1 0 0" >depth/posed/frame-000003.pose.txt
refused "map with half a pose" frame-000003.pose.txt:1 "expected a pose" map depth/posed --out run

for arguments in --help "explore --help" "report --help" "solve --help" "bench --help" "inspect --help" "odometry --help" "map --help" "list --help" "config --help" --version; do
  # shellcheck disable=SC2086
  succeeds "$arguments" $arguments
  [[ -s out.txt && ! -s err.txt ]] || fail "$arguments: expected text on standard output alone"
done
succeeds "--help" --help
for command in explore report solve bench inspect odometry map list config; do
  grep -q "^  $command " out.txt || fail "--help does not name '$command'"
done

# --- A machine in a folder may have no /proc.
without_proc() { unshare --user --map-root-user --mount bash -c 'mount -t tmpfs none /proc && exec "$@"' bash "$@"; }
if without_proc true 2>err.txt; then
  code=0
  without_proc "$prospect" list worlds >out.txt 2>err.txt || code=$?
  ((code == 0)) && grep -q office out.txt || fail "without /proc: exit $code: $(<err.txt)"
else
  echo "cli: skipped: no machine without /proc can be made here: $(<err.txt)"
fi

finish
