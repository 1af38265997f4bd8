#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A mission's log opens with the public reader, @mcap/core: by its index and from end to end with every checksum
# checked, and each message is decoded by the definition that stands in the file.
#   public_reader_test.sh <prospect> <scratch directory>
# Skips with exit code 77 where there is no Node.js, or npm cannot install the reader.
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
scratch="$(realpath "$2")"
skip() { echo "skipped: $*"; exit 77; }
command -v node >/dev/null && command -v npm >/dev/null || skip "no Node.js with npm here"
modules="$scratch/node_modules"
if [[ ! -d $modules/@mcap/core || ! -d $modules/@foxglove/rosmsg2-serialization ]]; then
  timeout 120 npm install --prefix "$scratch" --no-audit --no-fund --silent @mcap/core@2.2.2 @mcap/support@1.1.0 \
    @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 >/dev/null 2>&1 || skip "npm cannot install @mcap/core"
fi
work="$(mktemp -d "$scratch/log.XXXXXX")"
trap 'rm -rf "$work"' EXIT
code=0
"$prospect" explore office --time-limit 3 --mcap --quiet --out "$work/run" >"$work/out.txt" 2>&1 || code=$?
((code == 1)) || { echo "FAILED: explore --mcap: exit $code: $(<"$work/out.txt")" >&2; exit 1; }
NODE_PATH="$modules" node "$tests/read_log.js" "$work/run/mission.mcap" "$(tail -n 1 "$work/run/steps.csv")"
