#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What is installed beside the program for whoever types a command: completions and manual pages.
#   command_line_files_test.sh <prospect> <scratch directory>
set -uo pipefail
prospect="$(realpath "$1")"
mkdir -p "$2"
work="$(mktemp -d "$2/files.XXXXXX")"
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fail() { echo "FAILED: $*" >&2; failures=$((failures + 1)); }

"$prospect" command-line-files share || fail "command-line-files: exit $?"
bash_file=share/bash-completion/completions/prospect
zsh_file=share/zsh/site-functions/_prospect
fish_file=share/fish/vendor_completions.d/prospect.fish

# --- Every command, and every option of each of them, stands in each.
mapfile -t commands < <("$prospect" --help | sed '1,/^Subcommands:/d' | awk '/^  [a-z]/ {print $1}')
((${#commands[@]} >= 8)) || fail "--help names ${#commands[@]} commands: ${commands[*]}"
options=0
for command in "" "${commands[@]}"; do
  page=share/man/man1/prospect${command:+-$command}.1
  [[ -s $page ]] || fail "no manual page $page"
  # shellcheck disable=SC2086
  help="$("$prospect" $command --help)"
  for option in $(grep -oE '^ +(-[a-z],)?--[a-z-]+' <<<"$help" | grep -oE -- '--[a-z-]+'); do
    options=$((options + 1))
    # The man page escapes dashes.
    grep -qF "\\fB${option//-/\\-}\\fR" "$page" || fail "$page lacks $option"
    of_bash="$(sed -n "/^    '$command') words=/p" $bash_file)"
    grep -qE -- "[ ']${option}[ ']" <<<"$of_bash" || fail "bash lacks $command $option"
    of_fish="$(sed -n "/^complete .*'__prospect_runs ${command:-none}'/p" $fish_file)"
    grep -qE -- " -l ${option#--}( |\$)" <<<"$of_fish" || fail "fish lacks $command $option"
    if [[ -n $command ]]; then
      of_zsh="$(sed -n "/^ *$command)\$/,/;;/p" $zsh_file)"
    else
      of_zsh="$(sed -n '/_arguments -C/,/case/p' $zsh_file)"
    fi
    grep -qE -- "'[^']*${option}=?\[" <<<"$of_zsh" || fail "zsh lacks $command $option"
  done
done
((options > 60)) || fail "only $options options were found in the help"
! grep -rq command-line-files share || fail "the command of the build is shown to users"
[[ $("$prospect" --help) != *command-line-files* ]] || fail "--help shows the command of the build"

# --- Bash: what a shell does when Tab is pressed at the end of a line.
# shellcheck source=/dev/null
source $bash_file
complete -p prospect | grep -q -- '-F _prospect' || fail "bash: prospect is not completed"
mkdir folder
touch folder.yaml world.bt "with space.bt"
# tab WORD...: as bash splits the line, the last one unfinished.
tab() {
  COMP_WORDS=(prospect "$@")
  COMP_CWORD=$#
  COMP_LINE="${COMP_WORDS[*]}"
  COMP_POINT=${#COMP_LINE}
  COMPREPLY=()
  _prospect prospect "${*: -1}" ""
}
# offers WHAT EXPECTED: the words offered for the last `tab`, sorted.
offers() {
  local got
  got="$(printf '%s\n' "${COMPREPLY[@]}" | sort | tr '\n' ' ')"
  [[ "${got% }" == "$2" ]] || fail "bash: $1: '${got% }', expected '$2'"
}
tab ""
offers "commands" "$(printf '%s\n' "${commands[@]}" | sort | tr '\n' ' ' | sed 's/ $//')"
tab so
offers "a command" solve
tab explore --sens
offers "an option" --sensors
tab --ver
offers "an option of the program" --version
tab explore --sensors ""
offers "choices" "camera model"
tab explore --sensors "=" "c"
offers "choices after =" camera
tab explore --solver nlopt : LD_S
offers "a solver with a colon" LD_SLSQP
tab explore --solver samp
offers "solvers" "sampling sampling:cem sampling:mppi sampling:search"
tab solve office@3 --solver ipopt,hyb
offers "a list of solvers" ipopt,hybrid
tab bench zoo s3
offers "sets" s30
tab report run --figure ""
offers "figures" "map path"
tab report run --figure path,m
offers "a second figure" path,map
tab report run --colour sp
offers "colours" speed
tab list ""
offers "list kinds" "adapters bases drive-modes links modes sets solvers terms worlds"
tab explore off
offers "worlds" "office office_bare"
tab explore w
offers "worlds in files" "with space.bt world.bt"
tab explore --config fol
offers "files" "folder folder.yaml"
tab report fol
offers "folders and logs" "folder folder.yaml"
tab solve corr
offers "a world at a step" corridor@
tab explore --set planner.weights.w_d
offers "keys of the configuration" planner.weights.w_du=
tab explore --start 1 2 3 off
offers "an argument after an option of three values" "office office_bare"
tab explore --quiet off
offers "an argument after a switch" "office office_bare"
tab explore --seed ""
offers "a number" ""
tab explore office off
offers "an argument too many" ""
tab explore --seed 3 --solver=nlopt : LD_SL
offers "a solver with a colon after =" LD_SLSQP
# Every solver, world and set that there is.
tab explore --solver ""
((${#COMPREPLY[@]} == $("$prospect" list solvers | wc -l))) || fail "bash: ${#COMPREPLY[@]} solvers"
for world in $("$prospect" list worlds | awk '{print $1}'); do
  tab explore "$world"
  [[ " ${COMPREPLY[*]} " == *" $world "* ]] || fail "bash: the world $world is not offered"
done

# --- The other shells and roff, where they are.
# checked WHAT PROGRAM ARGUMENT...: says nothing and exits with 0.
checked() {
  local what="$1"
  shift
  if ! command -v "$1" >/dev/null; then
    echo "skipped: $what: no $1 here"
    return
  fi
  "$@" >check.txt 2>&1 || fail "$what: exit $?: $(<check.txt)"
  [[ ! -s check.txt ]] || fail "$what: $(<check.txt)"
}
checked "syntax of the completion for zsh" zsh -n $zsh_file
checked "syntax of the completion for fish" fish -n $fish_file
for page in share/man/man1/*.1; do
  checked "$page" groff -ww -man -Tutf8 -z "$page"
done
if command -v man >/dev/null; then
  shown="$(MANWIDTH=100 man -l share/man/man1/prospect-explore.1 2>&1)"
  [[ $shown == *"--set KEY=VALUE"* ]] || fail "man does not show an option"
fi

if command -v fish >/dev/null; then
  offered="$(fish --no-config -c "source $fish_file; complete -C 'prospect report run --figure path,m'" | cut -f1)"
  [[ $offered == path,map ]] || fail "fish offers '$offered'"
fi

# --- A folder that cannot be written to.
touch occupied
"$prospect" command-line-files occupied 2>err.txt
(($? == 2)) && grep -q 'expected a folder to write to' err.txt && (($(wc -l <err.txt) == 1)) ||
  fail "a file in the place of the folder: $(<err.txt)"

((failures == 0)) || { echo "$failures failed" >&2; exit 1; }
echo "all as promised"
