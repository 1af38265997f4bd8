#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the live view of a mission in real time in a headless browser: what it shows must move as the robot
# does, and its buttons must hold, stop and send the robot.
# usage: live_test.sh PROSPECT [FOLDER]. Exit code 77: no browser or no Node.js, skipped. FOLDER gets screenshots.
set -euo pipefail
tests="$(dirname "$(realpath "${BASH_SOURCE[0]}")")"
prospect="$(realpath "$1")"
screenshots="${2:-}"
[[ -z "$screenshots" ]] || screenshots="$(mkdir -p "$screenshots" && realpath "$screenshots")"
source "$tests/self_testing_page.sh"
command -v node >/dev/null || { echo "skipped: no Node.js here"; exit 77; }
cd "$folder"
timeout 300 node "$tests/drive_live_page.js" "$prospect" "$browser" "$folder" "$screenshots"
