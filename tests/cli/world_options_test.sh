#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The options that say how a world is read.
#   world_options_test.sh <prospect> <scratch directory>
set -uo pipefail
tests="$(dirname "$(realpath "$0")")"
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$2/world.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
# shellcheck source=tests/cli/checks.sh
source "$tests/checks.sh"
explore=(explore --time-limit 1 --quiet --out run)

timed_out "a map to read" explore office --time-limit 5 --seed 3 --quiet --out first
printf "P5\n40 40\n255\n%1600s" "" >floor.pgm

# The options have their effect, stand in config.yaml, and are repeated by it.
# facet X Y Z X Y Z X Y Z; box X0 Y0 Z0 X1 Y1 Z1: of an STL, whose top faces up.
facet() { printf 'facet normal 0 0 0\nouter loop\nvertex %s %s %s\nvertex %s %s %s\nvertex %s %s %s\nendloop\nendfacet\n' "$@"; }
quad() {
  facet "$1" "$2" "$3" "$4" "$5" "$6" "$7" "$8" "$9"
  facet "$1" "$2" "$3" "$7" "$8" "$9" "${10}" "${11}" "${12}"
}
box() {
  local a=$1 b=$2 c=$3 d=$4 e=$5 f=$6
  quad "$a" "$b" "$f" "$d" "$b" "$f" "$d" "$e" "$f" "$a" "$e" "$f"
  quad "$a" "$b" "$c" "$a" "$e" "$c" "$d" "$e" "$c" "$d" "$b" "$c"
  quad "$a" "$b" "$c" "$d" "$b" "$c" "$d" "$b" "$f" "$a" "$b" "$f"
  quad "$d" "$b" "$c" "$d" "$e" "$c" "$d" "$e" "$f" "$d" "$b" "$f"
  quad "$d" "$e" "$c" "$a" "$e" "$c" "$a" "$e" "$f" "$d" "$e" "$f"
  quad "$a" "$e" "$c" "$a" "$b" "$c" "$a" "$b" "$f" "$a" "$e" "$f"
}
{
  echo solid two_storeys
  for z in 0 3; do
    box 0 0 "$z" 4 3 "$z"
    box 0 0 $z 4 0.2 $((z + 2))
    box 0 2.8 $z 4 3 $((z + 2))
    box 0 0 $z 0.2 3 $((z + 2))
    box 3.8 0 $z 4 3 $((z + 2))
  done
  box 2.6 0 3 2.8 1.6 5
  echo endsolid two_storeys
} >two_storeys.stl
{
  echo solid hut
  box -20 -20 -0.2 20 20 0
  box 0 0 0 4 0.2 2
  box 0 0 0 0.2 4 2
  echo endsolid hut
} >hut.stl
# read_as WHAT ENTRY WORLD OPTION...: with the option another mission than without; the entry in config.yaml; the
# same mission by that file alone.
read_as() {
  local what="$1" entry="$2"
  shift 2
  rm -rf told repeated
  if [[ ! -e $1.steps.csv ]]; then
    rm -rf plain
    run explore "$1" --time-limit 1 --quiet --out plain
    if ((code == 3)); then
      grep -q 'not built in' err.txt || fail "$what: exit 3, but '$err'"
      return
    fi
    cp plain/steps.csv "$1.steps.csv"
  fi
  timed_out "$what" explore "$@" --time-limit 1 --quiet --out told
  ! cmp -s "$1.steps.csv" told/steps.csv || fail "$what: changes nothing"
  grep -qF "  $entry " told/config.yaml || fail "$what: no '$entry' in $(grep -A6 '^world:' told/config.yaml)"
  timed_out "$what, repeated" explore "$1" --config told/config.yaml --quiet --out repeated
  cmp -s told/steps.csv repeated/steps.csv || fail "$what: config.yaml does not repeat the run"
  diff told/config.yaml repeated/config.yaml || fail "$what: config.yaml differs when it is repeated"
}
read_as "--start" "start: [2, 1.5, -90]" office --start 2 1.5 -90
read_as "--resolution of a map" "resolution: 0.2" first/map.bt --resolution 0.2
read_as "--unknown of a map" "unknown: free" first/map.bt --unknown free
read_as "--resolution of a mesh" "resolution: 0.1" two_storeys.stl --resolution 0.1
read_as "--floor of a mesh" 'floor: "3"' two_storeys.stl --floor 3
read_as "--ground of a mesh" "ground: 1.5" hut.stl --ground 1.5
printf 'world: {floor: 3}\n' >upstairs.yaml
run explore two_storeys.stl --config upstairs.yaml --floor 0 --time-limit 1 --quiet --out told
if ((code != 3)); then
  grep -q '  floor: "0" ' told/config.yaml || fail "--floor does not stand above the file"
  refused "a storey that there is not" two_storeys.stl "expected" "${explore[@]}" two_storeys.stl --floor 8
  refused "solve in a storey that there is not" two_storeys.stl "expected" \
    solve two_storeys.stl@1 --set world.floor=8
fi
refused "--floor of a built-in world" office "expected no --floor or world.floor" "${explore[@]}" office --floor 1
refused "--resolution of a built-in world" office "expected no --resolution" "${explore[@]}" office --resolution 0.2
refused "--unknown of a built-in world" office "expected no --unknown" "${explore[@]}" office --unknown free
refused "--ground of a map" first/map.bt "expected no --ground" "${explore[@]}" first/map.bt --ground 1
refused "--floor of an image" floor.pgm "expected no --floor" "${explore[@]}" floor.pgm --floor 1
refused "--resolution finer than a map" first/map.bt "expected a resolution of at least that" \
  "${explore[@]}" first/map.bt --resolution 0.02
refused "--unknown of another kind" --unknown "expected one of: solid, free" "${explore[@]}" office --unknown blocked
refused "--floor that is no number" --floor "'low'; expected lowest or a number" "${explore[@]}" office --floor low

finish
