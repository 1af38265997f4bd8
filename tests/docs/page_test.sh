#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a page of the docs as it is written, in an empty folder.
#   page_test.sh <page.md> <build tree> <scratch directory> <folder of scripts/listed_programs.sh>
# What a page's code blocks mean, by what stands behind the three backticks:
#   sh             commands; each must end with 0
#   console        "$ COMMAND", then lines of its output, which must come in that order; "..." stands for
#                  anything. A command that ends "# exit code N" must end with N, else with 0
#   LANGUAGE FILE  yaml, json: written to FILE; cpp, cmake: these lines must stand in FILE, one after another
#   python FILE    written to FILE; in docs/: these lines must stand in FILE, one after another
#   python         run if python3 has h5py and numpy, else skipped and said to be
#   text           not run: what needs root, a network or another machine
# Blocks after a line "<!-- needs ../shared -->" or "<!-- needs python3-scipy -->" are skipped, and said to
# be, where that is absent.
# A page that begins with how many minutes it takes ("Ten minutes", "in 15 minutes") is read at 200 words a minute, and
# its commands run, in no more.
# All commands of a page run in one shell, in a folder that has docs/, adapters/ (whose code a page shows),
# build/ as scripts/explore leaves it, and nothing else. They find the programs that the listed packages bring.
set -uo pipefail
page="$(realpath "$1")"
build="$(realpath "$2")"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
mkdir -p "$3"
work="$(mktemp -d "$(realpath "$3")/page.XXXXXX")"
trap 'rm -rf "$work"' EXIT
mkdir "$work/prospect"
ln -s "$root/docs" "$work/prospect/docs"
ln -s "$root/adapters" "$work/prospect/adapters"
[[ ! -d "$root/../shared" ]] || ln -s "$(realpath "$root/../shared")" "$work/shared"
name="${page#"$root/"}"

# product_tree FROM TO: of a build tree what configuring writes and what the target `product` names, as hard links,
# since what is installed is copied from there.
product_tree() {
  local from="$1" to="$2" file text
  mkdir "$to"
  cd "$from" || return
  cp -rl --parents share layout CMakeFiles/Export *.cmake "$to"
  [[ ! -d python ]] || cp -rl python "$to"
  rm -f "$to"/python/prospect/*.so
  ninja -t query product | awk '/^  outputs:/ { exit } /^    / { print $1 }' | xargs cp -l --parents -t "$to"
  while read -r file; do
    text="$(<"$file")"
    mkdir -p "$to/${file%/*}"
    rm -f "$to/$file"
    printf '%s\n' "${text//"$from"/"$to"}" >"$to/$file"
  done < <(find . -maxdepth 4 -name cmake_install.cmake)
}
if [[ -f "$build/build.ninja" ]]; then
  product_tree "$build" "$work/prospect/build" || exit 1
else
  echo "$name: skipped: whether it needs more than the target product makes, as this is no tree of Ninja"
  ln -s "$build" "$work/prospect/build"
fi
cd "$work/prospect" || exit 1
if [[ -d "${4:-}/packages" ]]; then
  export PATH="$4/packages" CMAKE_TOOLCHAIN_FILE="$4/toolchain.cmake"
else
  echo "$name: all programs of this machine are seen"
  # Debian's interpreter, whatever else is in PATH: the package is made for it.
  mkdir "$work/bin"
  [[ ! -x /usr/bin/python3 ]] || ln -s /usr/bin/python3 "$work/bin/python3"
  export PATH="$work/bin:$PATH"
fi
export PATH="$work/prospect/build:$PATH" PYTHONDONTWRITEBYTECODE=1
unset CMAKE_GENERATOR PYTHONPATH
export CMAKE_BUILD_PARALLEL_LEVEL="${CMAKE_BUILD_PARALLEL_LEVEL:-2}"

failures=0
ran=0
fail() { echo "FAILED: $name:$*" >&2; failures=$((failures + 1)); }

# Spaces made one; a text of the page as a pattern, with "..." for anything.
squeezed() { sed -E 's/[[:space:]]+/ /g; s/^ //; s/ $//' <<<"$1"; }

# run LINE COMMAND EXPECTED_LINE...
run() {
  local line="$1" command="$2" expected_code=0 code=0
  shift 2
  [[ ! "$command" =~ \#\ exit\ code\ ([0-9]+)$ ]] || expected_code="${BASH_REMATCH[1]}"
  echo "$name:$line: $command"
  eval "$command" >"$work/output" 2>&1 </dev/null || code=$?
  ran=$((ran + 1))
  if ((code != expected_code)); then
    fail "$line: exit code $code, expected $expected_code: $command"
    tail -n 40 "$work/output" >&2
    return
  fi
  (($# > 0)) || return 0
  local -a lines=()
  mapfile -t lines < <(sed -E 's/[[:space:]]+/ /g; s/^ //; s/ $//' "$work/output")
  local at=0 expected literal pattern found
  for expected in "$@"; do
    expected="$(squeezed "$expected")"
    [[ -n "$expected" && "$expected" != "..." ]] || continue
    literal="$(sed -E 's/[^[:alnum:] .]/\\&/g' <<<"$expected")"
    pattern="${literal//.../*}"
    found=0
    while ((at < ${#lines[@]})); do
      at=$((at + 1))
      # shellcheck disable=SC2053
      if [[ "${lines[at - 1]}" == $pattern ]]; then
        found=1
        break
      fi
    done
    if ((!found)); then
      fail "$line: no line '$expected' in the output of: $command"
      cat "$work/output" >&2
      return
    fi
  done
}

number=0
kind=""   # of the block that is open
file=""   # that it names
begin=0   # its first line
body=()
skipped=0 # whether blocks are, until the next heading

# The block's lines must stand in the file that it names.
check_code() {
  if [[ -z "$file" ]]; then
    fail "$begin: code without the file that holds it"
  elif [[ ! -f "$file" ]]; then
    fail "$begin: no file $file"
  else
    local page_code file_code
    page_code="$(printf '%s\n' "${body[@]}" | tr -s '[:space:]' ' ')"
    file_code="$(tr -s '[:space:]' ' ' <"$file")"
    ran=$((ran + 1))
    [[ "$file_code" == *"${page_code% }"* ]] || fail "$begin: $file does not hold this code"
  fi
}

close_block() {
  local command="" index line
  local -a expected=()
  case "$kind" in
    sh)
      for index in "${!body[@]}"; do
        line="${body[index]}"
        if [[ "$line" == *\\ ]]; then
          command+="${line%\\}"
          continue
        fi
        command+="$line"
        [[ -z "${command// /}" || "$command" == \#* ]] || run $((begin + index)) "$command"
        command=""
      done
      ;;
    console)
      local at=0
      for index in "${!body[@]}" end; do
        if [[ "$index" == end || "${body[index]}" == '$ '* ]]; then
          [[ -z "$command" ]] || run "$at" "$command" "${expected[@]}"
          [[ "$index" != end ]] || break
          command="${body[index]#'$ '}"
          at=$((begin + index))
          expected=()
        else
          expected+=("${body[index]}")
        fi
      done
      ;;
    yaml | json)
      [[ -z "$file" ]] || printf '%s\n' "${body[@]}" >"$file"
      ;;
    cpp | cmake) check_code ;;
    python)
      if [[ "$file" == docs/* ]]; then
        check_code
      elif [[ -n "$file" ]]; then
        printf '%s\n' "${body[@]}" >"$file"
      elif python3 -c "import h5py, numpy" 2>/dev/null; then
        printf '%s\n' "${body[@]}" >"$work/block.py"
        run "$begin" "python3 '$work/block.py'"
      else
        echo "$name:$begin: skipped: python3 with h5py and numpy is not there"
      fi
      ;;
    text) ;;
    *) fail "$begin: a block of kind '$kind'; expected sh, console, yaml, json, cpp, cmake, python or text" ;;
  esac
}

while IFS= read -r line || [[ -n "$line" ]]; do
  number=$((number + 1))
  if [[ -z "$kind" ]]; then
    if [[ "$line" == '```'* ]]; then
      read -r kind file <<<"${line#'```'}"
      kind="${kind:-none}"
      begin=$((number + 1))
      body=()
    elif [[ "$line" == '<!-- needs ../shared -->' && ! -d "$work/shared" ]]; then
      echo "$name:$number: skipped to the next heading: there is no ../shared"
      skipped=1
    elif [[ "$line" == '<!-- needs python3-scipy -->' ]] && ! python3 -c "import scipy" 2>/dev/null; then
      echo "$name:$number: skipped to the next heading: there is no python3-scipy"
      skipped=1
    elif [[ "$line" == '#'* ]]; then
      skipped=0
    fi
  elif [[ "$line" == '```' ]]; then
    ((skipped)) || close_block
    kind=""
  else
    body+=("$line")
  fi
done <"$page"
[[ -z "$kind" ]] || fail "$begin: a block that does not end"
((ran > 0)) || fail "1: nothing to run"
declare -A spelled=([Five]=5 [Ten]=10 [Fifteen]=15 [Twenty]=20)
if [[ "$(head -n 5 "$page")" =~ ([0-9]+|Five|Ten|Fifteen|Twenty)\ minutes ]]; then
  promised="${spelled[${BASH_REMATCH[1]}]:-${BASH_REMATCH[1]}}"
  reading=$(($(wc -w <"$page") * 60 / 200))
  echo "$name: $reading s of reading, $SECONDS s of running; $promised minutes are promised"
  ((reading + SECONDS <= promised * 60)) || fail "1: takes longer than it says"
fi
((failures == 0))
