# SPDX-License-Identifier: Apache-2.0
"""Problems: shapes, derivatives, lifetimes, errors, threads."""

import gc
import threading
import unittest

import numpy as np
import prospect
from samples import Attraction, Corridor, path_problem, rosenbrock


def differences(f, z, h=1e-6):
    """Central differences of f, (...,) at (n,), as (..., n)."""
    return np.stack([(f(z + h * e) - f(z - h * e)) / (2 * h) for e in np.eye(z.size)], axis=-1)


class ProblemTest(unittest.TestCase):
    def setUp(self):
        self.problem = path_problem()
        self.z = np.linspace(-0.2, 0.3, self.problem.n)

    def test_shapes_of_one_point_and_of_a_batch(self):
        p = self.problem
        self.assertEqual((p.n, p.m, p.N, p.M, p.dt), (10, 20, 20, 5, 0.25))
        batch = np.stack([self.z, 0 * self.z, self.z[::-1]])
        e = p.evaluate(batch)
        self.assertEqual(e.cost.shape, (3,))
        self.assertEqual(e.constraints.shape, (3, p.m))
        self.assertEqual(e.terms.shape, (3, 2))
        self.assertTrue(e.valid.all())
        for b in range(3):
            alone = p.evaluate(batch[b])
            self.assertEqual(alone.cost.shape, (1,))
            self.assertEqual(alone.cost[0], e.cost[b])
            np.testing.assert_array_equal(alone.constraints[0], e.constraints[b])
        self.assertEqual(p.cost(self.z), e.cost[0])
        np.testing.assert_array_equal(p.cost(batch), e.cost)
        np.testing.assert_array_equal(p.constraints(batch), e.constraints)
        np.testing.assert_array_equal(p.cost(np.asfortranarray(batch)), e.cost)
        np.testing.assert_array_equal(p.cost(batch.tolist()), e.cost)

    def test_derivatives_of_terms_in_python_are_those_of_differences(self):
        p = self.problem
        np.testing.assert_allclose(p.gradient(self.z), differences(p.cost, self.z), atol=1e-7)
        J = p.jacobian(self.z)
        self.assertEqual(J.shape, (p.m, p.n))
        np.testing.assert_allclose(J, differences(p.constraints, self.z), atol=1e-7)
        self.assertFalse(np.any(J[~p.jacobian_pattern]))

    def test_residuals_are_the_cost(self):
        p = path_problem(constrained=False)
        e = p.residuals(self.z)
        self.assertAlmostEqual(e.residual_offset + 0.5 * e.residuals @ e.residuals, e.cost[0], 12)
        np.testing.assert_allclose(e.residual_jacobian.T @ e.residuals, e.gradient, atol=1e-9)

    def test_rollout_follows_the_model(self):
        t = self.problem.rollout(self.z)
        self.assertEqual(t.states.shape, (1, 21, 3))
        self.assertEqual(t.inputs.shape, (1, 20, 2))
        self.assertEqual(t.poses.shape, (1, 21, 4))
        np.testing.assert_allclose(t.times, np.arange(21) * 0.25)
        np.testing.assert_array_equal(t.inputs[0, ::4], self.z.reshape(5, 2))
        turned = np.diff(t.states[0, :, 2]) / 0.25
        np.testing.assert_allclose(turned, t.inputs[0, :, 1], atol=1e-12)
        within = np.clip(self.z, self.problem.lower, self.problem.upper)
        np.testing.assert_allclose(self.problem.knots_from_inputs(t.inputs[0]), within)

    def test_explain_adds_up(self):
        e = self.problem.explain(self.z)
        self.assertEqual([t.name for t in e.terms], ["attraction", "corridor"])
        self.assertAlmostEqual(sum(t.weighted for t in e.terms), e.cost, 12)
        self.assertEqual(e.terms[1].raw, self.problem.constraints(self.z).min())
        self.assertIn("attraction", str(e))

    def test_arrays_outlive_the_problem(self):
        problem = path_problem()
        e = problem.evaluate(self.z, "gradient")
        expected = [np.array(a) for a in (e.cost, e.gradient, e.jacobian, e.constraints)]
        kept = [e.cost, e.gradient, e.jacobian, e.constraints]
        states = problem.rollout(self.z).states
        expected_states = np.array(states)
        del e, problem
        gc.collect()
        [path_problem().evaluate(self.z + n, "gradient") for n in range(20)]
        for a, b in zip(kept, expected):
            np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(states, expected_states)

    def test_a_problem_outlives_what_it_was_made_from(self):
        x0, term = np.zeros(3), Attraction(1.0, 2.0)
        p = prospect.Problem(prospect.motion_model("unicycle"), x0, [(term, 2.0)])
        before = p.cost(np.zeros(p.n))
        x0[:] = 5.0  # a copy was taken
        del term
        gc.collect()
        self.assertEqual(p.cost(np.zeros(p.n)), before)
        np.testing.assert_array_equal(p.x0, np.zeros(3))

    def test_an_evaluation_is_not_changed_by_the_next(self):
        first = self.problem.evaluate(self.z).cost
        value = float(first[0])
        self.problem.evaluate(self.z + 0.1)
        self.assertEqual(first[0], value)

    def test_two_threads_evaluate_one_problem(self):
        points = np.random.default_rng(1).uniform(-0.3, 0.3, (200, self.problem.n))
        expected = [self.problem.cost(z) for z in points]
        found = [None, None]

        def work(n):
            found[n] = [self.problem.cost(z) for z in points]

        threads = [threading.Thread(target=work, args=(n,)) for n in range(2)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        self.assertEqual(found, [expected, expected])

    def test_plain_functions_are_a_problem(self):
        p = rosenbrock()
        self.assertEqual(p.cost([0, 0]), 1.0)
        np.testing.assert_allclose(p.gradient([0.5, 0.2]), differences(p.cost, np.array([0.5, 0.2])), rtol=1e-6)
        np.testing.assert_array_equal(p.start.x, [-1.2, 1.0])

    def test_what_is_wrong_is_said_in_one_line(self):
        p, z = self.problem, self.z
        model = prospect.motion_model("unicycle")
        cases = [
            (lambda: p.cost(z[:3]), r"z: has shape \(3,\); expected \(10,\)"),
            (lambda: p.cost(np.zeros((2, 3))), r"z: has shape \(2, 3\); expected \(any, 10\)"),
            (lambda: p.evaluate(np.zeros((2, 10)), "gradient"), "z: has 2 candidates; expected one"),
            (lambda: p.evaluate(z, "hessian"), "what: is 'hessian'; expected one of: score, value"),
            (lambda: prospect.Problem(model, [0, 0], []), r"x0: has shape \(2,\); expected \(3,\)"),
            (lambda: prospect.Problem(model, [0, 0, 0], [], N=5, M=9), "M = 9; expected"),
            (lambda: prospect.Problem(model, [0, 0, 0], [object()]), "has no name"),
            (lambda: prospect.motion_model("unicicle"), "did you mean 'unicycle'"),
            (lambda: prospect.motion_model("unicycle", v_mx=1), "did you mean 'v_max'"),
            (lambda: prospect.load_problem("absent.h5"), "^absent.h5: "),
            (lambda: prospect.load_problem(__file__), "problem_test.py: no HDF5 file"),
            (lambda: p.save("x.h5"), "x.h5: a problem of functions"),
        ]
        for call, text in cases:
            with self.subTest(text), self.assertRaisesRegex(ValueError, text) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))

    def test_an_exception_of_a_term_keeps_its_cause_and_place(self):
        class Broken(Attraction):
            def value(self, t):
                return {}["absent"]

        p = prospect.Problem(prospect.motion_model("unicycle"), [0, 0, 0], [Broken(0, 0)])
        with self.assertRaisesRegex(
            prospect.CallbackError, r"attraction\.value: KeyError: 'absent' \(.*problem_test\.py:\d+\)"
        ) as caught:
            p.cost(np.zeros(p.n))
        self.assertIsInstance(caught.exception.__cause__, KeyError)

    def test_a_value_of_another_shape_is_refused(self):
        class Flat(Attraction):
            def value(self, t):
                return np.zeros((t.B, 2))

        p = prospect.Problem(prospect.motion_model("unicycle"), [0, 0, 0], [Flat(0, 0)])
        with self.assertRaisesRegex(ValueError, r"attraction.value: has shape \(1, 2\); expected \(1,\)"):
            p.cost(np.zeros(p.n))

    def test_a_term_may_reject_a_candidate(self):
        class Partial(Attraction):
            def value(self, t):
                return np.where(t.inputs[:, 0, 0] > 0, np.nan, super().value(t))

        p = prospect.Problem(prospect.motion_model("unicycle"), [0, 0, 0], [Partial(0, 0)])
        e = p.evaluate(np.stack([np.full(p.n, -0.1), np.full(p.n, 0.1)]))
        np.testing.assert_array_equal(e.valid, [True, False])
        self.assertTrue(np.isfinite(e.cost).all())

    def test_terms_see_every_model(self):
        for name in ["unicycle", "unicycle_accel", "holonomic", "multirotor"]:
            model = prospect.motion_model(name)
            p = prospect.Problem(model, np.zeros(model.nx), [Attraction(1, 2), Corridor(3.0)], N=6, M=3)
            z = np.linspace(-0.1, 0.2, p.n)
            with self.subTest(name):
                np.testing.assert_allclose(p.gradient(z), differences(p.cost, z), atol=1e-7)
                np.testing.assert_allclose(p.jacobian(z), differences(p.constraints, z), atol=1e-7)


if __name__ == "__main__":
    unittest.main()
