#!/usr/bin/env bash
# Packages of a release. What is refused is always tried. With PROSPECT_RELEASE=FOLDER, as root, the whole way too: made
# twice with the same bytes, looked at by lintian, installed, upgraded and removed on a bare Debian that stays in
# FOLDER/machine. It takes half an hour, and PROSPECT_RELEASE_BUILD names a build to be packed instead of a new one.
#   release_test.sh <source tree> <scratch folder>
set -uo pipefail
root="$1" work="$2"
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"
# refused CODE EXPECTED COMMAND...: that exit code, and one line that holds EXPECTED.
refused() {
  local code=0 expected="$2" with="$1"
  shift 2
  "$@" >"$work/out" 2>"$work/err" </dev/null || code=$?
  ((code == with)) && [[ "$(<"$work/err")" == *"$expected"* ]] || fail "$*: exit $code, expected $with and '$expected': $(<"$work/err")"
}

if ! git -C "$root" rev-parse HEAD >/dev/null 2>&1; then
  echo "release: skipped: $root is no clone of git"
  exit 77
fi
tree="$work/tree"
git clone --quiet --no-hardlinks "$root" "$tree" || fail "no clone"
release="$tree/scripts/release"
for tool in dpkg-deb dpkg-shlibdeps apt-ftparchive patchelf strip sphinx-build doxygen; do
  command -v "$tool" >/dev/null || { echo "release: only arguments are tried: no $tool (scripts/setup --release)"; tools=no; }
done
refused 2 "no folder; expected scripts/release --out DIR" "$release"
refused 2 "'--ot'; expected scripts/release --out DIR" "$release" --ot "$work/x"
refused 2 "--version: 'new'; expected numbers" "$release" --out "$work/x" --version new
mkdir "$work/full" && touch "$work/full/file"
refused 2 "full: holds something" "$release" --out "$work/full"
if [[ -z "${tools:-}" ]]; then
  mkdir "$work/build"
  printf 'PROSPECT_COPYLEFT:STRING=ON\nCMAKE_BUILD_TYPE:STRING=Release\n' >"$work/build/CMakeCache.txt"
  refused 2 "has PROSPECT_COPYLEFT=ON; expected GPL|OFF" "$release" --out "$work/x" --build "$work/build"
fi
touch "$tree/left"
refused 1 "the tree is not clean" "$release" --out "$work/y"
[[ ! -e "$work/y" ]] || fail "what is refused leaves a folder"
refused 2 "expected scripts/try_release RELEASE MACHINE" "$root/scripts/try_release"
refused 2 "no apt/Packages" "$root/scripts/try_release" "$work/full" "$work/machine"

if [[ -z "${PROSPECT_RELEASE:-}" ]]; then
  echo "release: no package is made: PROSPECT_RELEASE=FOLDER is not set"
else
  mkdir -p "$PROSPECT_RELEASE"
  here="$(realpath "$PROSPECT_RELEASE")"
  with=()
  [[ -z "${PROSPECT_RELEASE_BUILD:-}" ]] || with=(--build "$PROSPECT_RELEASE_BUILD")
  rm -rf "$here"/{one,two,older}
  export DEBFULLNAME="The Prospect contributors" DEBEMAIL="prospect@lists.debian.org"
  for name in one two; do
    "$root/scripts/release" --out "$here/$name" "${with[@]}" >"$work/out" || fail "no packages"
  done
  "$root/scripts/release" --out "$here/older" "${with[@]}" --version 0.0.1 >"$work/out" || fail "no packages of another version"
  diff "$here/one/SHA256SUMS" "$here/two/SHA256SUMS" || fail "two releases of one commit differ"
  (cd "$here/one" && sha256sum --quiet -c SHA256SUMS) || fail "SHA256SUMS are not those of the files"
  lintian --fail-on error "$here"/one/*.deb || fail "lintian finds errors"
  "$root/scripts/try_release" "$here/one" "$here/machine" "$here/older" || fail "the packages do not work"
fi

((failures == 0)) && echo "release: all checks pass"
exit "$((failures > 0))"
