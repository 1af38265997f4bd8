#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
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
refused 2 "expected scripts/image RELEASE MACHINE FILE.tar" "$root/scripts/image" "$work/full"
refused 2 "no apt/Packages" "$root/scripts/image" "$work/full" "$work/machine" "$work/image.tar"

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
  # A release is signed by who makes it: here by a key of this test.
  export GNUPGHOME="$work/keys"
  mkdir -m 700 "$GNUPGHOME"
  gpg --batch --quiet --passphrase '' --quick-generate-key "Prospect <release@test>" ed25519 sign never 2>"$work/err" || fail "no key: $(<"$work/err")"
  "$root/scripts/release" --out "$here/older" "${with[@]}" --version 0.0.1 --key "release@test" >"$work/out" || fail "no packages of another version"
  gpg --batch --quiet --verify "$here/older/apt/InRelease" 2>"$work/err" || fail "the repository is not signed: $(<"$work/err")"
  diff "$here/one/SHA256SUMS" "$here/two/SHA256SUMS" || fail "two releases of one commit differ"
  (cd "$here/one" && sha256sum --quiet -c SHA256SUMS) || fail "SHA256SUMS are not those of the files"
  lintian --fail-on error "$here"/one/*.deb || fail "lintian finds errors"
  "$root/scripts/try_release" "$here/one" "$here/machine" "$here/older" || fail "the packages do not work"
  # The image: the same bytes each time; what another program makes of it, without a daemon, drives a mission.
  for name in image again; do
    "$root/scripts/image" "$here/one" "$here/machine" "$here/$name.tar" || fail "no image"
  done
  cmp "$here/image.tar" "$here/again.tar" || fail "two images of one release differ"
  rm -rf "$here/again.tar" "$work/oci" "$work/bundle"
  if ! command -v umoci >/dev/null; then
    echo "release: the image is not unpacked: no umoci"
  else
    mkdir "$work/oci"
    tar -xf "$here/image.tar" -C "$work/oci"
    version="$(sed -n 's/^Version: //p' "$here/one/apt/Packages" | head -n 1)"
    umoci unpack --image "$work/oci:$version" "$work/bundle" >"$work/out" 2>&1 || fail "umoci: $(<"$work/out")"
    mkdir -p "$work/bundle/rootfs/dev"
    mknod -m 666 "$work/bundle/rootfs/dev/null" c 1 3
    chroot --userspec=65534:65534 "$work/bundle/rootfs" env -C /work HOME=/work prospect explore office --seed 1 --time-limit 5 --quiet >"$work/out" 2>&1 ||
      (($? == 1)) || fail "the image drives no mission: $(<"$work/out")"
    [[ -s "$work/bundle/rootfs/work/runs/office_nlopt_1/report.html" ]] || fail "a mission of the image leaves no report: $(<"$work/out")"
    grep -q '"prospect"' "$work/bundle/config.json" || fail "the image has another entry"
    rm -rf "$work/bundle" "$work/oci"
  fi
fi

((failures == 0)) && echo "release: all checks pass"
exit "$((failures > 0))"
