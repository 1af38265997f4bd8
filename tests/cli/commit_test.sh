#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The file that tells the program its commit: right, and written only when it changes.
#   commit_test.sh <cmake> <source tree> <scratch directory>
set -uo pipefail
cmake="$1"
script="$(realpath "$2")/cmake/Commit.cmake"
mkdir -p "$3"
work="$(mktemp -d "$3/commit.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fail() { echo "FAILED: $*" >&2; failures=$((failures + 1)); }
# written TREE: runs the script for it.
written() { "$cmake" -D SOURCE="$PWD/$1" -D OUTPUT="$PWD/commit.cc" -P "$script" || fail "the script fails for $1"; }
# says WHAT COMMIT CHANGED
says() {
  grep -qF "commit() { return \"$2\"; }" commit.cc || fail "$1: no commit '$2' in $(<commit.cc)"
  grep -qF "commit_changed() { return $3; }" commit.cc || fail "$1: not '$3' in $(<commit.cc)"
}

mkdir tarball
written tarball
says "a tree without git" "" false
if ! command -v git >/dev/null; then
  echo "skipped: no git here"
  exit 0
fi
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
git=(git -C tree -c user.name=nobody -c user.email=nobody@localhost)
git init -q tree
echo one >tree/file
"${git[@]}" add file
"${git[@]}" commit -qm one
first="$("${git[@]}" rev-parse HEAD)"
written tree
says "a commit" "$first" false
touch -d "2001-01-01" commit.cc
written tree
[[ "$(stat -c %y commit.cc)" == 2001-* ]] || fail "the file is written again though nothing changed"
echo new >tree/unknown_to_git
written tree
says "a file that git does not know" "$first" false
echo two >tree/file
written tree
says "a changed file" "$first" true
"${git[@]}" commit -qam two
written tree
says "another commit" "$("${git[@]}" rev-parse HEAD)" false
mkdir tree/below
written tree/below
says "a tree that lies in the repository of another" "" false

((failures == 0)) || { echo "$failures failed" >&2; exit 1; }
echo "all as promised"
