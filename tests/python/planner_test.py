# SPDX-License-Identifier: Apache-2.0
"""A planner fed with arrays, terms in it, and problems that it leaves."""

import gc
import os
import tempfile
import unittest

import numpy as np
import prospect
from samples import Attraction


def room(width=60, depth=80, height=8):
    """A room of 6 m x 8 m, of which the half nearer to the robot is known, as voxels of 0.1 m."""
    voxels = np.zeros((depth, width, height), np.uint8)
    voxels[: depth // 2] = 1
    voxels[:, 0] = voxels[:, -1] = voxels[0] = 2
    voxels[: depth // 2, :, 0] = 2  # the floor lies below z = 0
    return voxels


def belief(maps, stamp=0.0, **more):
    return prospect.Belief(maps, [3.0, 1.5, 0.0, 1.57], stamp=stamp, **more)


class PlannerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.configuration = prospect.Configuration(settings={"planner.threads": 1})
        cls.maps = prospect.Maps(room(), 0.1, (0.0, 0.0, -0.1), cls.configuration)
        cls.planner = prospect.Planner(cls.configuration)
        cls.plan = cls.planner.plan(belief(cls.maps))

    def test_maps_are_the_voxels(self):
        left, right, bottom, top = self.maps.extent
        ground = self.maps.ground
        self.assertEqual(ground.shape, (round((top - bottom) / 0.1), round((right - left) / 0.1)))

        def at(x, y):
            return ground[int((y - bottom) / 0.1), int((x - left) / 0.1)]

        self.assertEqual([at(3.0, 1.0), at(0.05, 1.0), at(3.0, 6.0)], [1, 2, 0])

    def test_a_plan_leads_into_the_unknown(self):
        plan = self.plan
        self.assertTrue(plan.certified, plan.detail)
        self.assertEqual(plan.mode, "explore")
        N = plan.states.shape[0] - 1
        self.assertEqual(plan.commands.shape, (N, 4))
        self.assertGreater(plan.committed, 0)
        self.assertGreater(self.planner.target[1], 1.5)
        values, extent = self.planner.cost_to_go
        self.assertEqual(values.ndim, 2)
        self.assertLess(extent[0], extent[1])
        np.testing.assert_array_equal(plan.command_at(plan.stamp), plan.commands[0])
        self.assertGreater(plan.times_ms["total"], 0)
        self.assertIn("executed", [c["verdict"] for c in plan.candidates])

    def test_the_guard_passes_it_and_refuses_an_old_one(self):
        newest = belief(self.maps)
        good = self.planner.check(self.plan, 0, np.zeros(4), newest, 0.0)
        self.assertTrue(good["passed"], good["detail"])
        np.testing.assert_allclose(good["command"], self.plan.commands[0])
        late = self.planner.check(self.plan, 0, np.zeros(4), newest, 30.0)
        self.assertFalse(late["passed"])
        np.testing.assert_array_equal(late["command"], np.zeros(4))

    def test_the_same_beliefs_give_the_same_bits(self):
        again = prospect.Planner(self.configuration).plan(belief(self.maps))
        np.testing.assert_array_equal(again.states, self.plan.states)

    def test_its_problem_can_be_solved_saved_and_read(self):
        problem = self.planner.problem()
        z = problem.start.x
        self.assertEqual(problem.start.seeds.shape[1], problem.n)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "step.h5")
            problem.save(path)
            read = prospect.load_problem(path)
        gc.collect()
        self.assertEqual(read.cost(z), problem.cost(z))
        np.testing.assert_array_equal(read.gradient(z), problem.gradient(z))
        self.assertIn("world", read.origin)
        r = prospect.solve(read, "nlopt:LD_SLSQP", max_evaluations=60)
        self.assertLessEqual(r.cost, problem.cost(z))

    def test_it_drives_into_nobody(self):
        planner = prospect.Planner(self.configuration)
        planner.set_task("go", (3.0, 3.4))
        alone = planner.plan(belief(self.maps))
        ahead = [[3.0, 1.95, 0.0, -0.3, 0.2, 0.1]]
        self.assertGreater(alone.commands[0][0], 0.0)
        refused = self.planner.check(alone, 0, np.zeros(4), belief(self.maps, movers=ahead), 0.0)
        self.assertFalse(refused["passed"])
        self.assertIn("somebody", refused["detail"])
        with self.assertRaisesRegex(ValueError, "movers: row 0"):
            belief(self.maps, movers=[[0.0, 0.0, 0.0, 0.0, -1.0, 0.0]])

    def test_it_goes_where_it_is_told(self):
        planner = prospect.Planner(self.configuration)
        planner.set_task("go", (4.0, 2.5))
        plan = planner.plan(belief(self.maps))
        self.assertEqual(plan.mode, "go to goal")
        planner.set_task("hold")
        self.assertEqual(planner.plan(belief(self.maps, 0.5)).mode, "hold")

    def test_landmarks_are_predicted(self):
        rng = np.random.default_rng(1)
        wall = np.column_stack([rng.uniform(0.5, 5.5, 60), np.full(60, 3.95), rng.uniform(0.2, 0.6, 60)])
        toward_robot = np.tile([0.0, -1.0, 0.0], (60, 1))
        landmarks = prospect.Landmarks(wall, direction=toward_robot)
        np.testing.assert_array_equal(landmarks.position, wall)
        plan = prospect.Planner(self.configuration).plan(
            belief(self.maps, landmarks=landmarks, tracked_features=40)
        )
        self.assertEqual(plan.visible.shape, (plan.states.shape[0],))
        self.assertGreater(plan.visible[0], 1.0)

    def test_a_term_in_python_is_part_of_the_plan(self):
        contexts = []

        def make(options, context):
            contexts.append(context)
            return Attraction(options["x"], options["y"])

        registries = prospect.Registries()
        registries.add_term(
            "attraction",
            make,
            options={"x": (0.0, -100, 100, "m", "of the point"), "y": (0.0, -100, 100, "m", "of the point")},
        )
        configuration = prospect.Configuration(
            settings={"planner.terms.attraction": "{weight: 2, x: 4.5, y: 1}"}, registries=registries
        )
        planner = prospect.Planner(configuration)
        plan = planner.plan(belief(self.maps))
        self.assertIn("attraction", [t.name for t in plan.explanation.terms])
        self.assertIn(("attraction", 2.0), planner.problem().terms)
        context = contexts[0]
        self.assertEqual(context.x0.shape, (3,))
        self.assertEqual(context.targets.shape[1], 4)
        del planner
        gc.collect()
        self.assertGreater(context.ground.size, 0)  # it outlives the planner
        with self.assertRaisesRegex(ValueError, "planner.terms.attraction.z"):
            prospect.Configuration(
                settings={"planner.terms.attraction": "{weight: 2, z: 4.5}"}, registries=registries
            )

    def test_a_term_that_fails_costs_the_step_that_term(self):
        class Broken(Attraction):
            def value(self, t):
                raise ArithmeticError("no")

        registries = prospect.Registries()
        registries.add_term("broken", lambda options, context: 1 / 0)
        registries.add_term("attraction", lambda options, context: Broken(0, 0))
        for name in ["broken", "attraction"]:
            configuration = prospect.Configuration(
                settings={f"planner.terms.{name}": "{weight: 1}"}, registries=registries
            )
            plan = prospect.Planner(configuration).plan(belief(self.maps))
            with self.subTest(name):
                self.assertTrue(plan.certified)
                self.assertIn(name, plan.detail)

    def test_a_solver_in_python_plans(self):
        class Least(prospect.Solver):
            name, description, needs_gradient = "least", "the start", False

            def run(self, evaluator, options, warm_start):
                evaluator.cost(evaluator.start)
                return evaluator.finish()

        plan = prospect.Planner(self.configuration, solver=Least()).plan(belief(self.maps))
        self.assertEqual(plan.solver, "least")
        self.assertTrue(plan.certified)

    def test_a_configuration_is_read_strictly(self):
        c = self.configuration
        self.assertEqual(c.values["planner.threads"], "1")
        self.assertIn("w_l", c.yaml)
        self.assertEqual(c.motion_model.name, "unicycle")
        with self.assertRaisesRegex(ValueError, "planner.weights.w_ll"):
            prospect.Configuration(settings={"planner.weights.w_ll": 1})
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("planner:\n  horizon: -3\n")
            file.flush()
            with self.assertRaisesRegex(ValueError, r"\.yaml:2: "):
                prospect.Configuration(file.name)

    def test_what_is_wrong_with_maps_and_beliefs_is_said(self):
        c, maps = self.configuration, self.maps
        cases = [
            (lambda: prospect.Maps(np.zeros((2, 2)), 0.1, (0, 0, 0), c), r"voxels: has shape \(2, 2\)"),
            (lambda: prospect.Maps(np.full((2, 2, 2), 3), 0.1, (0, 0, 0), c), "voxels: holds 3"),
            (lambda: prospect.Maps(room(), 0.1, (0.05, 0, 0), c), "origin: x is 0.05"),
            (lambda: prospect.Belief(maps, [0, 0, 0], stamp=0), r"pose: has shape \(3,\)"),
            (lambda: belief(maps, localization="fine"), "localization: is 'fine'"),
            (lambda: prospect.Landmarks(np.zeros((3, 2))), r"position: has shape \(3, 2\)"),
            (lambda: self.planner.set_task("fly"), "task: is 'fly'"),
            (lambda: self.planner.set_task("go"), "goal: is missing"),
            (lambda: self.planner.set_task("go", (1e9, 0)), "goal"),
        ]
        for call, text in cases:
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()


if __name__ == "__main__":
    unittest.main()
