#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The interface since the last release: models/version.h has risen as far as what changed asks for, CHANGELOG.md
# has an entry of this version, and the comparison sees what it is for.
#   interface_test.sh <source tree> <scratch folder>
set -uo pipefail
root="$1" work="$2"
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"

run "$root/scripts/interface" compare
((code == 0)) || fail "the version is too low for what has changed: $err"
echo "$out"
version="$(sed -n 's/.*kVersion\[\] = "\(.*\)";/\1/p' "$root/models/version.h")"
top="$(grep -m1 '^## ' "$root/CHANGELOG.md")"
[[ "$top" == "## $version"* ]] || fail "CHANGELOG.md begins with '$top'; expected ## $version"
for release in "$root"/releases/*/; do
  grep -q "^## $(basename "$release")" "$root/CHANGELOG.md" || fail "CHANGELOG.md: no entry for $(basename "$release")"
done
grep -q "<version>$version</version>" "$root/share/ros2/prospect_robot/package.xml" ||
  fail "share/ros2/prospect_robot/package.xml has another version; expected $version"
grep -q "^version: $version$" "$root/CITATION.cff" || fail "CITATION.cff has another version; expected $version"
# Examples ask for this version, which an older one does not satisfy.
other="$(grep -rn 'find_package(prospect [0-9]' "$root"/docs --include=CMakeLists.txt --include='*.md' | grep -v "prospect ${version%.*} ")"
[[ -z "$other" ]] || fail "another version is asked for: $other"

# A project of a header, a key, a column, a topic and an exit code, released as 0.3.1.
tree="$work/tree"
mkdir -p "$tree"/{scripts,models,engine,docs/reference,releases/0.3.1,adapters/formats/problem_file,adapters/program/robot}
cp "$root/scripts/interface" "$tree/scripts/"
echo 'constexpr char kVersion[] = "0.3.1";' >"$tree/models/version.h"
touch "$tree/adapters/formats/problem_file/problem_file.h" "$tree/adapters/program/robot/run_robot.h"
cat >"$tree/engine/robot.h" <<'CODE'
#pragma once
namespace prospect {
/// A robot; { is no body here.
class Robot {
 public:
  explicit Robot(double mass = 2.0) : mass_(mass) {}
  void drive(double v, double omega = 0.0);
  double mass() const { return mass_; }
  enum class Mode { kStand, kDrive };
  int wheels = 2;

 private:
  void secret();
  double mass_;
};
namespace internal {
void hidden();
}
inline int count() { return 1; }
}  // namespace prospect
CODE
cat >"$tree/docs/reference/configuration.md" <<'PAGE'
| key | unit | range | default | what |
|---|---|---|---|---|
| `robot.mass` | kg | 0 to 9 | `2` | its mass |
PAGE
printf '| column | unit | what |\n|---|---|---|\n| `step time` | s | when |\n' >"$tree/docs/reference/report.md"
printf '| topic | type | frame |\n|---|---|---|\n| `/map` | `nav_msgs/OccupancyGrid` | map |\n' >"$tree/docs/reference/log.md"
printf '| key | default | type |\n|---|---|---|\n| `scan` | `none` | `LaserScan` |\n' >"$tree/docs/reference/dds.md"
printf '| `prospect drive` | drives |\n**Exit codes**: 0 done; 2 bad input, one line, with more.\n' >"$tree/README.md"
interface="$tree/scripts/interface"
file="$tree/releases/0.3.1/interface.txt"
run "$interface" write "$file"
((code == 0)) || fail "an interface cannot be written: $err"
for line in "prospect::Robot: explicit Robot(double mass = 2.0)" "prospect::Robot: double mass() const" \
    "prospect::Robot: void drive(double v, double omega = 0.0)" "prospect::Robot: int wheels = 2" "prospect: int count()" \
    "prospect::Robot: enum class Mode { kStand, kDrive }" "key robot.mass [kg] 0 to 9 = \`2\`" "column step [s]" \
    "log topic /map: nav_msgs/OccupancyGrid" "ROS topic scan = none: \`LaserScan\`" "call drive" "exit code 0 done"; do
  grep -qxF "$line" "$file" || fail "the interface lacks '$line'"
done
! grep -qE 'secret|mass_|hidden|no body' "$file" || fail "the interface has what is nobody else's: $(grep -E 'secret|mass_|hidden' "$file")"

# changed EXPECTED_CODE EXPECTED_TEXT SED_EXPRESSION FILE: one change to it, and what the comparison makes of it.
changed() {
  cp "$tree/$4" "$work/kept"
  sed -i "$3" "$tree/$4"
  cmp -s "$work/kept" "$tree/$4" && fail "'$3' changes nothing"
  run "$interface" compare
  ((code == $1)) && [[ "$out$err" == *"$2"* ]] || fail "'$3': exit $code, expected $1 and '$2' in '$out' '$err'"
  cp "$work/kept" "$tree/$4"
}
changed 0 "0 gone or changed, 0 new or changed" 's/A robot;/The robot;/' engine/robot.h
changed 0 "0 gone or changed, 0 new or changed" 's/return 1/return 2/' engine/robot.h
changed 0 "0 gone or changed, 0 new or changed" 's/void secret/int secret/' engine/robot.h
changed 1 "- prospect::Robot: void drive(" 's/void drive/bool drive/' engine/robot.h
changed 1 "expected at least 0.4.0" 's/int wheels = 2/int wheels = 3/' engine/robot.h
changed 1 "expected at least 0.4.0" '/kStand/s/, kDrive//' engine/robot.h
changed 1 "expected at least 0.3.2" 's/int wheels/int arms = 0;\n  int wheels/' engine/robot.h
changed 1 "+ prospect::Robot: int arms = 0" 's/int wheels/int arms = 0;\n  int wheels/' engine/robot.h
changed 1 "expected at least 0.4.0" 's/`2`/`3`/' docs/reference/configuration.md
changed 1 "- column time [s]" 's/step time/step/' docs/reference/report.md
changed 1 "expected at least 0.4.0" 's/OccupancyGrid/Path/' docs/reference/log.md
changed 1 "expected at least 0.4.0" 's/none/\/scan/' docs/reference/dds.md
changed 1 "- exit code 2 bad input, one line" 's/2 bad input/3 bad input/' README.md
sed -i 's/0\.3\.1/0.4.0/' "$tree/models/version.h"
changed 0 "at least 0.4.0; this is 0.4.0" 's/void drive/bool drive/' engine/robot.h
# From 1.0 on the first number tells.
mv "$tree/releases/0.3.1" "$tree/releases/1.2.0"
sed -i 's/0\.4\.0/1.9.0/' "$tree/models/version.h"
changed 1 "expected at least 2.0.0" 's/void drive/bool drive/' engine/robot.h
run "$interface" compare "$work/none.txt"
((code == 2)) && [[ "$err" == *"none.txt: no such file"* ]] || fail "a file that is not there: exit $code, '$err'"

((failures == 0)) && echo "interface: all checks pass"
exit "$((failures > 0))"
