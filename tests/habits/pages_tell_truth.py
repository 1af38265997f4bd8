#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What pages at the top of the project name is there: files, links, targets, tests, presets.

  pages_tell_truth.py ROOT BUILD PAGE...      BUILD: a build tree, whose CTest and Ninja are asked
"""
import json
import os
import re
import subprocess
import sys


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False)


def wrong_in(root, build, page):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" not in target and not os.path.exists(os.path.join(root, target.partition("#")[0])):
            yield f"link to {target}: no such file"
    code = re.findall(r"```sh\n(.*?)```", text, re.S)
    spans = re.findall(r"`([^`\n]+)`", re.sub(r"```.*?```", "", text, flags=re.S))
    for span in spans:
        if "/" in span and " " not in span and not re.search(r"[A-Z]{3,}|^https?:|^build/|^/", span):
            if not os.path.exists(os.path.join(root, span)):
                yield f"`{span}`: no such file"
    commands = [re.sub(r"\s+#.*", "", line) for block in code for line in block.splitlines()]
    commands += [span for span in spans if " " in span]
    for command in commands:
        for part in re.split(r"&&|;|>", command):
            words = part.split()
            if not words:
                continue
            if words[0] == "ctest":
                asked = words[words.index("-R") :] if "-R" in words else words[words.index("-L") :]
                shown = output("ctest", "--test-dir", build, "-N", asked[0], asked[1]).stdout
                if not re.search(r"Total Tests: [1-9]", shown):
                    yield f"{part.strip()}: no such test"
            elif words[:2] == ["cmake", "--build"]:
                target = words[words.index("--target") + 1]
                if output("ninja", "-C", build, "-t", "query", target).returncode != 0:
                    yield f"{part.strip()}: no such target"
            elif words[:2] == ["cmake", "--preset"]:
                with open(os.path.join(root, "CMakePresets.json"), encoding="utf-8") as file:
                    presets = [preset["name"] for preset in json.load(file)["configurePresets"]]
                if words[2] not in presets:
                    yield f"{part.strip()}: no such preset"
            elif words[0].startswith("scripts/") and not os.access(os.path.join(root, words[0]), os.X_OK):
                yield f"{words[0]}: no such script"


def main():
    root, build, *pages = sys.argv[1:]
    bad = 0
    for page in pages:
        for problem in wrong_in(root, build, page):
            print(f"{os.path.basename(page)}: {problem}", file=sys.stderr)
            bad += 1
    sys.exit(bad > 0)


main()
