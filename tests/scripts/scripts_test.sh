#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What the scripts promise, as far as it can be seen without root and without the network.
#   scripts_test.sh <source tree> <folder of listed_programs.sh>
set -uo pipefail
root="$1"
machine="$PATH" base="$PATH"  # programs of this machine; of one on which nothing is set up yet
if [[ -d "${2:-}/packages" ]]; then
  base="$2/base" PATH="$2/packages"
else
  echo "all programs of this machine are seen"
fi
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
source "${BASH_SOURCE[0]%/*}/../checks.sh"
lines() { [[ -z "$1" ]] && echo 0 || wc -l <<<"$1"; }

for script in "$root"/scripts/{setup,build,explore,test,gazebo,bare_machine} "$root/.ci/run"; do
  [[ -x "$script" ]] || fail "$script is not executable"
  run bash -n "$script"
  ((code == 0)) || fail "$script does not parse: $err"
done

# A checkout may live anywhere: the copies run from a path with spaces.
here="$work/a robot's workshop"
mkdir -p "$here"
cp -r "$root/scripts" "$here/scripts"

run "$here/scripts/setup" --help
((code == 0)) && [[ "$out" == usage:* ]] || fail "setup --help: exit $code, '$out' '$err'"
run "$here/scripts/setup" --brwoser
((code == 2)) || fail "unknown argument: exit $code, expected 2"
[[ -z "$out" ]] && (("$(lines "$err")" == 1)) && [[ "$err" == *"--brwoser"*"--tests"* ]] ||
  fail "unknown argument: expected one line that names it and what was expected, got '$out' '$err'"

# Stand-ins for the package tools show what setup asks for. dpkg-query says "installed" to all but
# the packages named in $absent; apt-get and sudo write down what they were told.
tools="$work/tools"
mkdir -p "$tools"
cat >"$tools/dpkg-query" <<'TOOL'
#!/usr/bin/env bash
for last in "$@"; do :; done
echo "$last" >>"$ASKED"
[[ " $ABSENT " == *" $last "* ]] || printf 'install ok installed'
TOOL
cat >"$tools/apt-get" <<'TOOL'
#!/usr/bin/env bash
echo "apt-get $*" >>"$TOLD"
if [[ " $* " == *" install "* && -n "$REFUSE" ]]; then
  echo "Reading package lists..."
  echo "E: $REFUSE" >&2
  exit 100
fi
TOOL
printf '#!/usr/bin/env bash\necho sudo >>"$TOLD"\nexec "$@"\n' >"$tools/sudo"
chmod +x "$tools"/*
setup() {
  : >"$work/asked" && : >"$work/told"
  run env PATH="$tools:$base" ASKED="$work/asked" TOLD="$work/told" ABSENT="$absent" REFUSE="$refuse" \
    "$here/scripts/setup" "$@"
}

absent="" refuse=""
setup
((code == 0)) && [[ -z "$out$err" && ! -s "$work/told" ]] || fail "nothing missing: exit $code, '$out' '$err'"
# The list is parsed: every package once, no comments, no empty names.
expected="$(grep -v '^#' "$root/scripts/packages" | sed 's/ *#.*//' | grep -v '^ *$')"
[[ "$(<"$work/asked")" == "$expected" ]] || fail "packages asked for: $(tr '\n' ' ' <"$work/asked")"
grep -qx libeigen3-dev "$work/asked" || fail "libeigen3-dev was not asked for"
grep -q chromium "$work/asked" && fail "the browser was asked for without --tests"
setup --tests
grep -qx chromium "$work/asked" || fail "--tests did not ask for the browser"
# Whatever scripts/gazebo looks for at its beginning.
setup --gazebo
while IFS=: read -r _ package; do
  grep -qx "$package" "$work/asked" || [[ "$package" =~ ^(dpkg|apt)$ ]] || fail "--gazebo did not ask for $package"
done < <(grep -m1 'for tool in' "$root/scripts/debian_folder" | grep -oE '[a-z-]+:[a-z-]+')

absent="libfcl-dev liboctomap-dev"
setup
((code == 0)) || fail "two packages missing: exit $code: $err"
grep -q "install.* liboctomap-dev libfcl-dev$" "$work/told" || fail "installed: $(<"$work/told")"
(("$(grep -c 'install' "$work/told")" == 1)) || fail "more than one installation: $(<"$work/told")"
if ((EUID != 0)); then
  grep -qx sudo "$work/told" || fail "not root, but sudo was not used"
fi

refuse="Unable to locate package libfcl-dev"
setup
((code != 0)) || fail "a package that cannot be had: exit 0"
[[ "$(tail -n 1 <<<"$err")" == *"Unable to locate package libfcl-dev"* ]] && (("$(lines "$err")" <= 2)) ||
  fail "a package that cannot be had: expected one clear line, got '$err'"

# For real, where nothing is missing: not a word.
complete=1
for package in $expected; do
  [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" == "install ok installed" ]] || complete=0
done
if ((complete)); then
  run env PATH="$base" "$here/scripts/setup"
  ((code == 0)) && [[ -z "$out$err" ]] || fail "setup on this machine: exit $code, '$out' '$err'"
else
  echo "skipped on this machine: setup with nothing missing (something is)"
fi

# Gazebo's folder: what is asked of debootstrap and apt-get, and every reason not to begin, one line each.
# `world` is a server that runs for as long as the test lets it; flock and realpath are the machine's own.
gazebo_tools="$work/gazebo tools"
gazebo_dir="$work/gazebo folder"
mkdir -p "$gazebo_tools"
cat >"$gazebo_tools/apt-get" <<'TOOL'
#!/usr/bin/env bash
[[ "$1" == indextargets ]] || exit 1
[[ -z "$MIRROR" ]] || printf '%s\n' "http://security.test/ bookworm-security main" "$MIRROR bookworm contrib" "$MIRROR bookworm main"
TOOL
cat >"$gazebo_tools/debootstrap" <<'TOOL'
#!/usr/bin/env bash
echo "debootstrap $1 $2 $4" >>"$TOLD"
[[ -z "$REFUSE" ]] || { echo "E: $REFUSE"; exit 1; }
mkdir -p "$3/var/lib/dpkg" "$3/srv"
TOOL
cat >"$gazebo_tools/dpkg-query" <<'TOOL'
#!/usr/bin/env bash
[[ -n "$HERE" ]] && printf 'install ok installed\ninstall ok installed\n'
TOOL
printf '#!/usr/bin/env bash\necho unshare >>"$TOLD"\n' >"$gazebo_tools/unshare"
printf '#!/usr/bin/env bash\necho Avail\necho "$FREE"\n' >"$gazebo_tools/df"
printf '#!/usr/bin/env bash\nexec "$@"\n' >"$gazebo_tools/sudo"
chmod +x "$gazebo_tools"/*
# The copy of setup stands for all scripts above; this one is as it is in the tree.
gazebo() {
  : >"$work/told"
  run env PATH="$gazebo_tools:$PATH" TOLD="$work/told" MIRROR="${mirror-http://mirror.test/debian/}" REFUSE="${refuse:-}" \
    HERE="${present:-}" FREE="${free:-5000}" GAZEBO_MASTER_URI="${address-}" "$here/scripts/gazebo" "$@"
}
one_line() { ((code == $1)) && [[ -z "$out" ]] && (("$(lines "$err")" == 1)) && [[ "$err" == *"$2"* ]] || fail "gazebo: $3: exit $code, '$out' '$err'"; }
refuse=""
gazebo
one_line 2 "expected scripts/gazebo install" "no command"
gazebo fly
one_line 2 "'fly'" "an unknown command"
mirror="" gazebo install "$gazebo_dir"
one_line 1 "no Debian mirror" "no mirror"
free=100 gazebo install "$gazebo_dir"
one_line 1 "100 MB are free" "no space"
refuse="Couldn't download packages" gazebo install "$gazebo_dir"
((code == 1)) && [[ "$(tail -n 1 <<<"$err")" == *"Couldn't download packages" && ! -e "$gazebo_dir" ]] ||
  fail "gazebo: debootstrap that fails: exit $code, '$err'"
gazebo install "$gazebo_dir"
((code == 0)) && [[ -d "$gazebo_dir/var/lib/dpkg" && ! -e "$gazebo_dir.part" ]] || fail "gazebo install: exit $code, '$err'"
[[ "$(<"$work/told")" == $'debootstrap --variant=minbase bullseye http://mirror.test/debian/\nunshare' ]] ||
  fail "gazebo install did: $(<"$work/told")"
gazebo install "$gazebo_dir"
one_line 1 "holds something else" "a folder that is not Gazebo's"
present=yes gazebo install "$gazebo_dir"
((code == 0)) && [[ -z "$out$err" && ! -s "$work/told" ]] || fail "gazebo install, cached: exit $code, '$out' '$err'"
world="$work/a world.sdf"
gazebo start "$world" "$gazebo_dir"
one_line 2 "a world.sdf" "a world that is not there"
gazebo start --paused "$world" "$gazebo_dir"
one_line 2 "a world.sdf" "a world that is not there, paused"
echo '<sdf/>' >"$world"
gazebo start "$world" "$gazebo_dir"
one_line 1 "no Gazebo in" "start before install"
present=yes address=elsewhere gazebo start "$world" "$gazebo_dir"
one_line 2 "'elsewhere'" "an address that is none"
gazebo stop "$gazebo_dir"
one_line 1 "nothing to stop" "stop of nothing"
mkdir -p "$gazebo_dir/run" "$gazebo_dir/var/log"
present=yes address=http://127.0.0.1:9 gazebo start "$world" "$gazebo_dir"
one_line 1 "the server ended" "a server that ends"
# Who holds the lock runs. Without a process of its own, or `sleep` would outlive it and the test would wait for it.
flock --no-fork "$gazebo_dir/run/prospect-gazebo.lock" sleep 60 &
holder=$!
for ((i = 0; i < 50; ++i)); do flock -n "$gazebo_dir/run/prospect-gazebo.lock" true || break; sleep 0.02; done
present=yes gazebo start "$world" "$gazebo_dir"
one_line 1 "scripts/gazebo stop before" "a second one"
kill "$holder" && wait "$holder" 2>/dev/null

# A bare machine: the same reasons not to begin, and what is run there in which order; made once, cloned anew.
printf '#!/usr/bin/env bash\necho "${!#}" >>"$TOLD"\n' >"$gazebo_tools/unshare"
printf '#!/usr/bin/env bash\nmkdir -p "${!#}/scripts"\n' >"$gazebo_tools/git"
chmod +x "$gazebo_tools/git"
bare() {
  : >"$work/told"
  run env PATH="$gazebo_tools:$PATH" TOLD="$work/told" MIRROR=http://mirror.test/debian/ REFUSE="${refuse:-}" FREE="${free:-9000}" \
    "$here/scripts/bare_machine" "$@"
}
bare
one_line 2 "expected scripts/bare_machine DIR" "no folder"
free=100 bare "$work/machine"
one_line 1 "100 MB are free" "no space for a machine"
bare "$gazebo_dir"
one_line 1 "holds something else" "a folder that is no bare machine"
bare "$work/machine" -R problem
((code == 0)) && [[ "$(<"$work/told")" == $'debootstrap --variant=minbase bookworm http://mirror.test/debian/\nscripts/explore\ndocs\nproblem' ]] ||
  fail "bare_machine did: $(<"$work/told") $err"
touch "$work/machine/srv/prospect/old"
bare "$work/machine" --user
((code == 0)) && [[ "$(tail -n 3 "$work/told")" == $'scripts/explore\ndocs\nscripts/test' && ! -e "$work/machine/srv/prospect/old" ]] ||
  fail "bare_machine, again: $(<"$work/told") $err"

# explore and test are set up, build, run, in this order, with their arguments, wherever they stand. They
# configure alike: with other flags the second would build anew what the first has built.
mkdir -p "$here/build"
printf '#!/usr/bin/env bash\necho setup >>"$TOLD"\n' >"$here/scripts/setup"
printf '#!/usr/bin/env bash\necho "build $*" >>"$TOLD"\n' >"$here/scripts/build"
printf '#!/usr/bin/env bash\necho "prospect $*" >>"$TOLD"\n' >"$here/build/prospect"
printf '#!/usr/bin/env bash\necho "ctest $*" >>"$TOLD"\n' >"$tools/ctest"
chmod +x "$here/build/prospect" "$tools/ctest"
: >"$work/told"
run env TOLD="$work/told" "$here/scripts/explore" corridor --seed 3
[[ "$(<"$work/told")" == $'setup\nbuild --target product '"$here/build"$'\nprospect explore corridor --seed 3' ]] ||
  fail "explore did: $(<"$work/told") $err"
: >"$work/told"
run env PATH="$tools:$PATH" TOLD="$work/told" "$here/scripts/test" -R problem
[[ "$(head -n 2 "$work/told")" == $'setup\nbuild '"$here/build" && "$(tail -n 1 "$work/told")" == "ctest --test-dir $here/build "*" -R problem" ]] ||
  fail "test did: $(<"$work/told") $err"

# What no listed package brings is not seen: a list without a package lacks its programs, and no others.
if [[ "$PATH" != "$machine" ]]; then
  mkdir -p "$work/listed/scripts"
  sed '/^make\>/d' "$root/scripts/packages" >"$work/listed/scripts/packages"
  PATH="$machine" run "$root/tests/scripts/listed_programs.sh" "$work/listed" "$work/programs"
  run diff <(ls "$work/programs/packages") <(ls "$2/packages")
  [[ "$(grep '^[<>]' <<<"$out" | sort)" == $'> gmake\n> make\n> make-first-existing-target' ]] ||
    fail "programs without make's package: '$out' '$err'"
fi

# A tree that cannot be configured says why on standard error, and fails.
cp "$root/scripts/build" "$here/scripts/build"
run "$here/scripts/build" "$here/nowhere"
((code != 0)) && [[ "$err" == *CMakeLists.txt* ]] || fail "build without a CMakeLists.txt: exit $code, '$err'"

((failures == 0)) && echo "all passed"
exit $((failures > 0))
