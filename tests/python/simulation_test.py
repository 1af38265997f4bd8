# SPDX-License-Identifier: Apache-2.0
"""A simulated mission step by step, and the command line with plug-ins in Python."""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import prospect

NOTEBOOKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "notebooks")
STUDY = """
worlds: corridor
seeds: 1
conditions:
  near: {planner.terms: {keep_distance: {weight: 2, x: 3, y: 2, radius: 0.8}}}
mission: {time_limit: 1}
"""
PLUGIN = '''
import numpy as np
import prospect
from beside import POINT


class Walk(prospect.Solver):
    name, description, needs_gradient = "walk", "a random walk", False

    def run(self, evaluator, options, warm_start):
        rng, x = np.random.default_rng(options["seed"]), evaluator.start
        best = evaluator.cost(x)
        while True:
            trial = np.clip(x + 0.1 * rng.normal(size=x.size), evaluator.lower, evaluator.upper)
            cost = evaluator.cost(trial)
            if cost < best:
                x, best = trial, cost


def prospect_plugin(registries):
    registries.add_solver(Walk())
    square = prospect.Problem.from_functions(
        [-1, -1], [1, 1], lambda z: z @ z, lambda z: 2 * z, start=POINT)
    registries.add_problem("mine", "square", square, best_known=0.0, description="a square")
'''


class SimulationTest(unittest.TestCase):
    def test_step_by_step_it_is_the_mission_of_the_program(self):
        simulation = prospect.Simulation("corridor", seed=2)
        planner = prospect.Planner(simulation.configuration)
        rows = []
        while simulation.time < 6.0:
            plan = planner.plan(simulation.belief())
            rows.append([simulation.time, *simulation.true_pose, *simulation.estimated_pose, *plan.commands[0]])
            simulation.drive(plan)
        with tempfile.TemporaryDirectory() as folder:
            code = prospect.main(
                ["explore", "corridor", "--seed", "2", "--time-limit", "6", "--quiet", "--out", folder + "/run"]
            )
            run = prospect.load_run(folder + "/run")
        self.assertEqual(code, 1)  # time is up before all is explored
        steps, rows = run.steps, np.array(rows)
        self.assertGreaterEqual(steps.rows, 10)
        for column, n in [("time", 0), ("true_x", 1), ("true_y", 2), ("true_yaw", 4), ("estimated_x", 5),
                          ("command_v", 9), ("command_omega", 12)]:
            np.testing.assert_array_equal(rows[: steps.rows, n], steps[column], err_msg=column)
        self.assertEqual(run.info["world"], "corridor")
        self.assertEqual(run.summary["reason"], "time limit")
        self.assertEqual(run.true.shape, (steps.rows, 8))

    def test_reset_begins_anew_with_the_same_bits(self):
        simulation = prospect.Simulation("office", seed=5)
        before = simulation.true_pose
        for _ in range(3):
            simulation.apply([0.4, 0, 0, 0.2], 0.5)
        first = (simulation.true_pose, simulation.estimated_pose, simulation.belief().landmarks)
        self.assertGreater(simulation.path_length, 0.3)
        self.assertGreater(simulation.coverage, 0.0)
        belief = simulation.belief()
        np.testing.assert_allclose(belief.command, [0.4, 0, 0, 0.2])
        ground = belief.ground.copy()
        simulation.reset(seed=5)
        self.assertEqual(simulation.time, 0.0)
        np.testing.assert_array_equal(simulation.true_pose, before)
        for _ in range(3):
            simulation.apply([0.4, 0, 0, 0.2], 0.5)
        for a, b in zip(first, (simulation.true_pose, simulation.estimated_pose, simulation.belief().landmarks)):
            np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(belief.ground, ground)  # a belief never changes
        cells, extent = simulation.true_ground
        self.assertEqual(set(np.unique(cells)) - {0, 1, 2}, set())
        with self.assertRaisesRegex(ValueError, "command: has shape"):
            simulation.apply([0.4, 0.2], 0.5)

    def test_an_unknown_world_is_said_in_one_line(self):
        with self.assertRaisesRegex(ValueError, "ofice.*did you mean 'office'"):
            prospect.Simulation("ofice")


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.write("walk.py", PLUGIN)
        self.write("beside.py", "POINT = [0.8, -0.9]\n")

    def write(self, name, text):
        with open(os.path.join(self.folder.name, name), "w") as file:
            file.write(text)

    def run_program(self, *arguments):
        return subprocess.run(
            [sys.executable, "-B", "-m", "prospect", *arguments],
            cwd=self.folder.name, capture_output=True, text=True, timeout=100,
        )

    def test_a_solver_and_a_problem_in_python_are_benched(self):
        done = self.run_program(
            "bench", "mine", "--plugin", "walk.py", "--solver", "walk,nlopt:LD_SLSQP", "--quick", "--quiet",
            "--max-evaluations", "300", "--deadline", "0", "--out", "out",
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        bench = prospect.load_bench(os.path.join(self.folder.name, "out"))
        self.assertEqual(sorted(bench.rows["solver"]), ["nlopt:LD_SLSQP", "walk"])
        walk = bench.rows.where(bench.rows["solver"] == "walk")
        self.assertEqual(walk["cost_evaluations"][0], 300)
        self.assertLess(walk["cost"][0], 0.01)
        self.assertEqual(walk["set"][0], "mine")

    def test_what_is_wrong_with_a_plugin_is_one_line(self):
        self.write("broken.py", "x = 1\ny = x / 0\n")
        self.write("empty.py", "x = 1\n")
        for name, text in [
            ("broken.py", r"broken.py:2\)"),
            ("empty.py", "has no function prospect_plugin"),
            ("absent.py", "no such file"),
        ]:
            done = self.run_program("list", "solvers", "--plugin", name)
            with self.subTest(name):
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, rf"^prospect: plug-in '{name}': .*{text}")
                self.assertEqual(done.stderr.count("\n"), 1)

    def test_missions_of_a_study_and_a_replay_run_by_this_interpreter(self):
        # The program knows no plug-in in Python.
        plugin = os.path.join(NOTEBOOKS, "keep_distance.py")
        self.write("near.yaml", STUDY)
        done = self.run_program("study", "near.yaml", "--plugin", plugin, "--quiet")
        self.assertIn("1 cells: 0 there before, 1 run, 0 failed", done.stdout, done.stderr)
        cells = os.path.join(self.folder.name, "runs", "near", "cells")
        (cell,) = [name for name in os.listdir(cells) if "." not in name]
        run = prospect.load_run(os.path.join(cells, cell))
        self.assertIn("term_keep_distance", run.steps)
        done = self.run_program("replay", run.folder, "--plugin", plugin, "--quiet")
        self.assertIn(f"{run.steps.rows} steps, the same bits", done.stdout, done.stderr)

    def test_the_program_is_the_same(self):
        ours = self.run_program("list", "terms", "--json").stdout
        theirs = subprocess.run(
            [os.environ["PROSPECT"], "list", "terms", "--json"], capture_output=True, text=True
        ).stdout
        self.assertEqual(ours, theirs)


if __name__ == "__main__":
    unittest.main()
