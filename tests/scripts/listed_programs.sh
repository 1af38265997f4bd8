#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Folders of links to the programs of a machine that has nothing but what is listed, for tests of pages and scripts:
#   listed_programs.sh <source tree> <folder>
# <folder>/base has what Debian's base system brings, <folder>/packages what scripts/packages brings besides. Taken
# from what dpkg has installed here, so that a machine with more installed shows what the lists lack. CMake looks into
# the system's folders, too: <folder>/toolchain.cmake keeps it from that.
# Where there is no dpkg, or a listed package is absent, it says so and leaves no folder.
set -euo pipefail
root="$1"
rm -rf "$2"
skip() { echo "all programs of this machine are seen: $1"; exit 0; }
for tool in dpkg-query update-alternatives; do
  command -v "$tool" >/dev/null || skip "there is no $tool"
done
mkdir -p "$2"
folder="$(realpath "$2")"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

dpkg-query -W -f '${db:Status-Abbrev}\t${Package}\t${Essential}\t${Priority}\t${Provides}\t${Pre-Depends}, ${Depends}\t${Architecture}\n' |
  awk -F '\t' -v native="$(dpkg --print-architecture)" '$1 ~ /^.i/ && ($7 == native || $7 == "all")' >"$work/installed"
# What debootstrap calls minimal, and what is listed.
awk -F '\t' '$3 == "yes" || $4 == "required" || $2 == "apt" { print $2 }' "$work/installed" | sort -u >"$work/base"
sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$root/scripts/packages" >"$work/listed"

# closed PACKAGES: these and all that they depend on. Of alternatives the first that is there already, else the first
# that is installed, as apt does it.
closed() {
  awk -F '\t' '
    function plain(text) { gsub(/\([^)]*\)|:any|[[:space:]]/, "", text); return text }
    function add(name) { if (!(name in seen)) { seen[name] = 1; queue[++last] = name } }
    function there(name,   k, n, names) {
      if (name in seen) return 1
      n = split(providers[name], names, " ")
      for (k = 1; k <= n; ++k) if (names[k] in seen) return 1
      return 0
    }
    FNR == NR {
      depends[$2] = $6
      full[$2] = $2 ":" $7
      n = split($5, provided, ",")
      for (k = 1; k <= n; ++k) providers[plain(provided[k])] = providers[plain(provided[k])] " " $2
      next
    }
    { if ($1 in depends) add($1); else { print $1 >"/dev/stderr"; absent = 1 } }
    END {
      for (at = 1; at <= last; ++at) {
        groups = split(depends[queue[at]], group, ",")
        for (g = 1; g <= groups; ++g) {
          choices = split(group[g], choice, "|")
          chosen = ""
          for (c = 1; c <= choices; ++c) {
            name = plain(choice[c])
            if (there(name)) { chosen = ""; break }
            if (chosen == "" && name in depends) chosen = name
            else if (chosen == "" && name in providers) { split(providers[name], names, " "); chosen = names[1] }
          }
          if (chosen != "") add(chosen)
        }
      }
      for (name in seen) print full[name]
      exit absent
    }' "$work/installed" "$1"
}
# linked PACKAGES FOLDER: links to the programs of these packages, and of the names that several packages can have
# (awk, c++) to the one that is best of theirs.
linked() {
  mkdir -p "$2"
  xargs dpkg-query -L <"$1" | grep -E '^(/usr)?/s?bin/[^/]+$' | sort -u >"$work/programs"
  awk -v programs="$work/programs" '
    BEGIN { while ((getline line <programs) > 0) there[line] = 1 }
    /^Name: / { split("", link); master = ""; target = ""; slaves = 0 }
    /^Link: / { master = $2 }
    /^Alternative: / { target = $2; slaves = 0 }
    /^Priority: / { priority = $2; offer(master, target) }
    /^Slaves:/ { slaves = 1; next }
    slaves && /^ / { if (target == "") link[$1] = $2; else offer(link[$1], $2); next }
    { if (!/^ /) slaves = 0 }
    function offer(name, program) {
      if (!(target in there) || name !~ /^(\/usr)?\/s?bin\//) return
      if (!(name in best) || priority > rank[name]) { best[name] = program; rank[name] = priority }
    }
    END { for (name in best) print name, best[name] }' "$work/selections" >"$work/alternatives"
  xargs ln -sf -t "$2" <"$work/programs"
  while read -r name program; do ln -sf "$program" "$2/${name##*/}"; done <"$work/alternatives"
}

update-alternatives --get-selections | awk '{ print $1 }' | xargs -n 1 update-alternatives --query >"$work/selections"
closed "$work/base" >"$work/base_closed" || true
cat "$work/base" "$work/listed" >"$work/all"
if ! closed "$work/all" >"$work/all_closed" 2>"$work/absent"; then
  rm -rf "$folder"
  skip "not installed: $(tr '\n' ' ' <"$work/absent")"
fi
linked "$work/base_closed" "$folder/base"
linked "$work/all_closed" "$folder/packages"
echo 'list(APPEND CMAKE_IGNORE_PATH /usr/local/bin /usr/local/sbin /usr/bin /usr/sbin /bin /sbin)' >"$folder/toolchain.cmake"
echo "$(wc -l <"$work/all_closed") packages, $(ls "$folder/packages" | wc -l) programs"
