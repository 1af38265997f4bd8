#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Furnished floors as ROS maps: furnished_plans.py DIR writes furnished_1 to furnished_6, .pgm and .yaml.

A corridor with rooms on both sides. Door frames stand out, desks and chairs stand on thin legs, shelves and screens
stand at any angle, pillars stand in the corridor: what a fast robot meets late. The seeds are fixed, the bytes too.
"""
import math
import pathlib
import random
import sys

FREE, WALL = 254, 0
# Seed, side of a pixel, width and height of the floor, thickness of a leg [m].
FLOORS = [(11, 0.05, 28, 16, 0.05), (12, 0.05, 40, 14, 0.05), (13, 0.05, 24, 20, 0.1),
          (14, 0.1, 30, 18, 0.1), (15, 0.1, 44, 15, 0.1), (16, 0.05, 34, 24, 0.05)]


class Plan:
    """Pixels, filled by shapes in metres; the origin is at the first row."""

    def __init__(self, resolution, width, height):
        self.resolution = resolution
        self.columns, self.rows = round(width / resolution), round(height / resolution)
        self.pixels = [bytearray([FREE]) * self.columns for _ in range(self.rows)]

    def box(self, x0, y0, x1, y1, value=WALL):
        r = self.resolution
        for y in range(max(0, round(y0 / r)), min(self.rows, round(y1 / r))):
            for x in range(max(0, round(x0 / r)), min(self.columns, round(x1 / r))):
                self.pixels[y][x] = value

    def where(self, cx, cy, reach, border, inside):
        """Fills the pixels whose middles, seen from (cx, cy), are inside(dx, dy)."""
        r = self.resolution
        for y in range(max(0, int((cy - reach) / r) - border), min(self.rows, int((cy + reach) / r) + 2)):
            for x in range(max(0, int((cx - reach) / r) - border), min(self.columns, int((cx + reach) / r) + 2)):
                if inside((x + 0.5) * r - cx, (y + 0.5) * r - cy):
                    self.pixels[y][x] = WALL

    def disc(self, cx, cy, radius):
        least = max(radius, 0.5 * self.resolution)
        self.where(cx, cy, radius, 1, lambda dx, dy: math.hypot(dx, dy) <= least)

    def turned_box(self, cx, cy, a, b, angle):
        c, s = math.cos(angle), math.sin(angle)
        self.where(cx, cy, math.hypot(a, b), 0,
                   lambda dx, dy: abs(c * dx + s * dy) <= a and abs(-s * dx + c * dy) <= b)

    def legs(self, cx, cy, a, b, angle, leg):
        c, s = math.cos(angle), math.sin(angle)
        for u in (-a, a):
            for v in (-b, b):
                x, y = cx + c * u - s * v, cy + s * u + c * v
                self.box(x - leg / 2, y - leg / 2, x + leg / 2, y + leg / 2)


def rooms_along(plan, random_, width, wall, y0, y1, door_y):
    """Rooms between y0 and y1, each with a door in the wall at door_y; their boxes."""
    rooms, x = [], wall
    while x < width - wall - 2.5:
        end = min(x + random_.uniform(3.2, 6.5), width - wall)
        if width - wall - end < 2.6:
            end = width - wall
        rooms.append((x, y0, end, y1))
        if end < width - wall:
            plan.box(end, y0, end + wall, y1)
        door = random_.uniform(0.85, 1.3)
        at = random_.uniform(x + 0.3, end - 0.3 - door)
        plan.box(at, door_y - 0.01, at + door, door_y + wall + 0.01, FREE)
        frame = random_.choice([0, plan.resolution, 2 * plan.resolution])
        if frame:
            plan.box(at - 0.1, door_y - frame, at, door_y + wall + frame)
            plan.box(at + door, door_y - frame, at + door + 0.1, door_y + wall + frame)
        x = end + wall
        if random_.random() < 0.25 and end < width - wall:
            y = random_.uniform(y0 + 0.5, y1 - 1.5)
            plan.box(end - 0.01, y, end + wall + 0.01, y + 1.0, FREE)
    return rooms


def furnish(plan, random_, room, leg, corridor):
    x0, y0, x1, y1 = room
    for _ in range(int((x1 - x0) * (y1 - y0) / random_.uniform(3.0, 6.0))):
        cx, cy = random_.uniform(x0 + 0.4, x1 - 0.4), random_.uniform(y0 + 0.4, y1 - 0.4)
        if min(abs(cy - y) for y in corridor) < 0.9:  # doors stay free
            continue
        angle = random_.choice([0, 0, math.pi / 2, random_.uniform(0, math.pi)])
        kind = random_.random()
        if kind < 0.35:
            plan.legs(cx, cy, random_.uniform(0.3, 0.8), random_.uniform(0.25, 0.45), angle, leg)
        elif kind < 0.55:
            plan.legs(cx, cy, 0.2, 0.2, angle, leg)
        elif kind < 0.7:
            plan.turned_box(cx, cy, random_.uniform(0.3, 0.9), random_.uniform(0.15, 0.3), angle)
        elif kind < 0.8:
            plan.disc(cx, cy, random_.uniform(plan.resolution / 2, 0.3))
        elif kind < 0.9:
            plan.turned_box(cx, cy, random_.uniform(0.4, 1.0), plan.resolution / 2, angle)
        else:
            plan.box(cx, cy, cx + random_.uniform(0.4, 1.2), cy + 0.4)


def pillars(plan, random_, width, corridor):
    for _ in range(int(width / 6)):
        cx = random_.uniform(2, width - 2)
        cy = corridor[0] + 0.12 if random_.random() < 0.5 else corridor[1] - 0.12
        round_ = random_.random() < 0.5
        radius = random_.uniform(plan.resolution / 2, 0.15)
        if round_:
            plan.disc(cx, cy, radius)
        else:
            plan.box(cx - radius, cy - radius, cx + radius, cy + radius)


def floor(seed, resolution, width, height, leg):
    random_ = random.Random(seed)
    plan = Plan(resolution, width, height)
    wall = 0.1 if resolution > 0.06 else random_.choice([0.1, 0.15])
    for box in ((0, 0, width, wall), (0, height - wall, width, height), (0, 0, wall, height),
                (width - wall, 0, width, height)):
        plan.box(*box)
    broad = random_.uniform(1.8, 2.6)
    y1 = (height - broad) / 2 + random_.uniform(-0.5, 0.5)
    y2 = y1 + broad
    plan.box(0, y1 - wall, width, y1)
    plan.box(0, y2, width, y2 + wall)
    rooms = rooms_along(plan, random_, width, wall, wall, y1 - wall, y1 - wall)
    rooms += rooms_along(plan, random_, width, wall, y2 + wall, height - wall, y2)
    for room in rooms:
        furnish(plan, random_, room, leg, (y1, y2))
    pillars(plan, random_, width, (y1, y2))
    x, y = width / 2, (y1 + y2) / 2  # where the robot starts
    for row in range(int((y - 0.6) / resolution), int((y + 0.6) / resolution)):
        for column in range(int((x - 0.6) / resolution), int((x + 0.6) / resolution)):
            plan.pixels[row][column] = FREE
    return plan


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: furnished_plans.py DIR")
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    for number, (seed, resolution, width, height, leg) in enumerate(FLOORS, 1):
        plan = floor(seed, resolution, width, height, leg)
        name = f"furnished_{number}"
        header = f"P5\n{plan.columns} {plan.rows}\n255\n".encode()
        (out / f"{name}.pgm").write_bytes(header + b"".join(bytes(row) for row in plan.pixels))
        (out / f"{name}.yaml").write_text(f"image: {name}.pgm\nresolution: {resolution}\norigin: [0, 0, 0]\n"
                                          "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n")


if __name__ == "__main__":
    main()
