#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The live view speaks to the public client of Foxglove's protocol, @foxglove/ws-protocol: topics decode by the
# definitions that were advertised, and the commands reach the robot.
#   foxglove_client_test.sh <prospect> <scratch directory>
# Skips with exit code 77 where there is no Node.js, or npm cannot install the client.
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
scratch="$(realpath "$2")"
skip() { echo "skipped: $*"; exit 77; }
command -v node >/dev/null && command -v npm >/dev/null || skip "no Node.js with npm here"
modules="$scratch/node_modules"
if [[ ! -d $modules/@foxglove/ws-protocol || ! -d $modules/ws || ! -d $modules/@foxglove/rosmsg2-serialization ]]; then
  timeout 120 npm install --prefix "$scratch" --no-audit --no-fund --silent @foxglove/ws-protocol@0.8.0 ws@8.23.0 \
    @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 >/dev/null 2>&1 || skip "npm cannot install @foxglove/ws-protocol"
fi
work="$(mktemp -d "$scratch/live.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work"
NODE_PATH="$modules" timeout 200 node "$tests/foxglove_client.js" "$prospect" "$work"
