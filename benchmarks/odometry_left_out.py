#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""odometry_left_out.py PROGRAM CLIP... [--set KEY=A,B,...]...: settings of the odometry's covariance,
chosen on all clips but one and judged on that one, every way round.

PROGRAM is odometry_table, each CLIP what it reads, or "rendered" for its rendered sequences with
the calibration that made them. Each --set names a key of perception.odometry and the values to try;
all combinations are run. The one chosen has the smallest mean of |ln NEES| over the clips that are
looked at, of the pose and of the motions over 5, 10 and 20 frames. All numbers are printed. What is
given has to have an exact truth.
"""
import argparse
import itertools
import math
import subprocess

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("program")
parser.add_argument("clips", nargs="+")
parser.add_argument("--set", action="append", default=[], metavar="KEY=A,B,...")
arguments = parser.parse_args()


def numbers(clip, settings):
    """NEES of the pose and of motions over 5, 10 and 20 frames; the end error in percent."""
    rendered = clip == "rendered"
    command = [arguments.program] + ([] if rendered else [clip])
    command += ["--sequences", "12" if rendered else "0"]
    for setting in settings:
        command += ["--set", setting]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    wanted = "rendered, calibration said to be exact" if rendered else ""
    row = next(line for line in lines[2:] if line.startswith("| " + wanted))
    cells = [cell.strip() for cell in row.split("|")[2:]]
    share = cells[0].split(",")[1].strip().rstrip("% ")
    nees = [float(cell) if cell != "-" else math.nan for cell in cells[1:5]]
    return nees, share


def distance(nees):
    known = [abs(math.log(n)) for n in nees if n > 0.0]
    return sum(known) / len(known)


keys = [setting.split("=", 1) for setting in arguments.set]
combinations = [
    tuple(f"{key}={value}" for (key, _), value in zip(keys, values))
    for values in itertools.product(*(choices.split(",") for _, choices in keys))
]
results = {}
print("| settings | clip | NEES: pose, 5, 10, 20 frames | end error % | mean of abs(ln NEES) |")
print("|---|---|---|---|---|")
for settings in combinations:
    for clip in arguments.clips:
        nees, share = numbers(clip, settings)
        results[settings, clip] = nees
        print(f"| {' '.join(settings)} | {clip} | {', '.join(f'{n:.2f}' for n in nees)} | {share} "
              f"| {distance(nees):.3f} |", flush=True)
print("\n| left out | chosen on the others | NEES there: pose, 5, 10, 20 frames |\n|---|---|---|")
for left_out in arguments.clips:
    others = [clip for clip in arguments.clips if clip != left_out]
    chosen = min(combinations,
                 key=lambda s: sum(distance(results[s, clip]) for clip in others))
    print(f"| {left_out} | {' '.join(chosen)} "
          f"| {', '.join(f'{n:.2f}' for n in results[chosen, left_out])} |")
