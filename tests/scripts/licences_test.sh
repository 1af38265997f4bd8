#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Licences: what a build links has a row in licences/parts.csv, copyleft is told, and PROSPECT_COPYLEFT=OFF leaves it out.
#   licences_test.sh <source tree> <scratch folder> <cmake> <built file>...
set -uo pipefail
root="$1" work="$2" cmake="$3"
shift 3
rm -rf "$work"
mkdir -p "$work"
source "${BASH_SOURCE[0]%/*}/../checks.sh"

# All of this build's parts are known; their bill is the same each time and names every library.
run "$root/scripts/licences" --sbom "$work/one.json" "$@"
((code == 0)) || fail "a build's parts are not known: $err"
run "$root/scripts/licences" --sbom "$work/two.json" "$@"
cmp -s "$work/one.json" "$work/two.json" || fail "two bills of materials of one build differ"
python3 - "$work/one.json" <<'PYTHON' || fail "the bill of materials is not whole"
import json, sys
bill = json.load(open(sys.argv[1], encoding="utf-8"))
names = [package["name"] for package in bill["packages"]]
assert bill["spdxVersion"] == "SPDX-2.3"
for expected in "prospect", "libyaml-cpp0.7", "libeigen3-dev", "libjs-dygraphs":
    assert expected in names, (expected, names)
known = {package["SPDXID"] for package in bill["packages"]} | {"SPDXRef-DOCUMENT"}
assert len(known) == len(names) + 1, "two packages have one name"
for relation in bill["relationships"]:
    assert {relation["spdxElementId"], relation["relatedSpdxElement"]} <= known, relation
PYTHON

# A library without a row, and a file that is none.
mkdir -p "$work/tree/models"
cp -r "$root/scripts" "$root/licences" "$work/tree/"
cp "$root/models/version.h" "$work/tree/models/"
sed -i '/^yaml-cpp,/d' "$work/tree/licences/parts.csv"
run "$work/tree/scripts/licences" "$1"
((code == 1)) && [[ "$err" == *"libyaml-cpp.so."*"not in licences/parts.csv"* ]] ||
  fail "a library without a row: exit $code, '$err'"
run "$root/scripts/licences" "$root/LICENSE"
((code == 2)) && [[ "$err" == *LICENSE:*"expected a program"* ]] || fail "no program: exit $code, '$err'"

# Sources say their licence in their first lines: what does not is named, and stamped once, scripts after "#!".
clone="$work/clone"
mkdir -p "$clone/scripts"
cp "$root/scripts/licences" "$clone/scripts/"
printf '#!/bin/sh\necho\n' >"$clone/scripts/run"
chmod +x "$clone/scripts/run"
echo 'int a;' >"$clone/a.cc"
echo 'p {}' >"$clone/a.css"
echo 'words' >"$clone/a.md"
export GIT_CEILING_DIRECTORIES="$work" # the build may be within a clone
run "$clone/scripts/licences" --stamped
((code == 2)) && [[ "$err" == *"expected a clone of git"* ]] || fail "no clone: exit $code, '$err'"
git -C "$clone" init --quiet && git -C "$clone" add .
run "$clone/scripts/licences" --stamped
((code == 1)) && [[ "$err" == *"3 source files without a licence, a.cc first"* ]] || fail "sources without a licence: exit $code, '$err'"
run "$clone/scripts/licences" --stamp
[[ "$(sed -n 2p "$clone/scripts/run")" == "# SPDX-License-Identifier: Apache-2.0" && -x "$clone/scripts/run" &&
  "$(<"$clone/a.cc")" == $'// SPDX-License-Identifier: Apache-2.0\nint a;' && "$(<"$clone/a.md")" == words &&
  "$(head -n 1 "$clone/a.css")" == "/* SPDX-License-Identifier: Apache-2.0 */" ]] || fail "stamped: $(head "$clone"/*.* "$clone/scripts/run")"
run "$clone/scripts/licences" --stamp
[[ "$out" == "0 files stamped" ]] || fail "stamped twice: $out"
run "$clone/scripts/licences" --stamped
((code == 0)) || fail "stamped, and not seen: $err"
if git -C "$root" rev-parse HEAD >/dev/null 2>&1; then
  run "$root/scripts/licences" --stamped
  ((code == 0)) || fail "$err"
fi

# Copyleft is told of by name where Debian's back ends are linked.
if "$root/scripts/licences" "$1" 2>/dev/null | grep -q '^CHOLMOD'; then
  run "$root/scripts/licences" --permissive "$1"
  ((code == 1)) && [[ "$err" == *CHOLMOD*Ipopt*NLopt*codecs*"PROSPECT_COPYLEFT=OFF"* ]] ||
    fail "a build with copyleft: exit $code, '$err'"
  run "$root/scripts/licences" --handed-on "$1"
  ((code == 1)) && [[ "$err" == *"CHOLMOD"*"(GPL) and Ipopt 3.11 (CPL)"*"PROSPECT_COPYLEFT=GPL"* ]] ||
    fail "GPL and CPL in one program: exit $code, '$err'"
fi

# What is configured without copyleft compiles and links none of it.
run "$cmake" -S "$root" -B "$work/permissive" -G Ninja -D PROSPECT_COPYLEFT=OFF -D PROSPECT_BUILD_TESTS=OFF
if ((code != 0)); then
  fail "PROSPECT_COPYLEFT=OFF cannot be configured: $err"
elif grep -nE 'PROSPECT_WITH_(NLOPT|IPOPT|CERES)|PROSPECT_IMAGE_CODECS|lib(nlopt|ipopt|ceres|cholmod|spqr|cxsparse|dmumps)[._-]' \
    "$work/permissive/build.ninja" >"$work/found"; then
  fail "PROSPECT_COPYLEFT=OFF: $(head -n 1 "$work/found" | cut -c 1-300)"
fi
grep -q 'libyaml-cpp' "$work/permissive/build.ninja" || fail "the build's link lines are not read"

run "$cmake" -S "$root" -B "$work/permissive" -D PROSPECT_COPYLEFT=GPL
if ((code != 0)) || grep -nE 'PROSPECT_WITH_IPOPT|libipopt' "$work/permissive/build.ninja" ||
    ! grep -q 'PROSPECT_WITH_CERES' "$work/permissive/build.ninja"; then
  fail "PROSPECT_COPYLEFT=GPL: Ipopt is in or Ceres is not: $err"
fi
run "$cmake" -S "$root" -B "$work/permissive" -D PROSPECT_COPYLEFT=some
((code != 0)) && [[ "$err" == *"'some'; expected ON, GPL or OFF"* ]] || fail "a value that is none: exit $code, '$err'"

((failures == 0)) && echo "licences: all checks pass"
exit "$((failures > 0))"
