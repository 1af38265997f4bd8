# SPDX-License-Identifier: Apache-2.0
"""Solves from Python, and back ends written in Python."""

import threading
import time
import unittest

import numpy as np
import prospect
from prospect import Quality, StopReason
from samples import Attraction, path_problem, rosenbrock


class Descent(prospect.Solver):
    """Gradient descent with steps that halve until the cost falls."""

    name = "descent"
    description = "gradient descent, a sample"
    options = {"rate": (1.0, "first step")}
    takes_constraints = False

    def run(self, evaluator, options, warm_start):
        x, rate = evaluator.start, options["rate"]
        cost, gradient = evaluator.cost_and_gradient(x)
        while rate > 1e-12:
            evaluator.count_iteration()
            trial = np.clip(x - rate * gradient, evaluator.lower, evaluator.upper)
            if evaluator.cost(trial) < cost:
                x, rate = trial, 2 * rate
                cost, gradient = evaluator.cost_and_gradient(x)
            else:
                rate *= 0.5
        return evaluator.finish(StopReason.CONVERGED, optimum=True, detail="steps vanish")


class SolverTest(unittest.TestCase):
    def test_back_ends_find_the_optimum(self):
        for name in ["nlopt:LD_SLSQP", "nlopt:LN_BOBYQA", "hybrid", "sampling"]:
            with self.subTest(name):
                r = prospect.solve(rosenbrock(), name, max_evaluations=4000)
                np.testing.assert_allclose(r.x, [1, 1], atol=2e-2)
                self.assertIn(r.quality, [Quality.FEASIBLE_OPTIMUM, Quality.FEASIBLE])

    def test_constraints_are_kept(self):
        r = prospect.solve(path_problem(), "nlopt:LD_SLSQP")
        self.assertLessEqual(r.violation, 1e-6)
        free = prospect.solve(path_problem(constrained=False), "nlopt:LD_SLSQP")
        self.assertLess(free.cost, r.cost)
        self.assertAlmostEqual(r.explanation.cost, r.cost)

    def test_a_start_shortens_the_next_solve(self):
        p = path_problem()
        first = prospect.solve(p, "nlopt:LD_SLSQP")
        for start in [first.next, first.x]:
            again = prospect.solve(p, "nlopt:LD_SLSQP", start=start)
            self.assertLess(again.cost_evaluations, first.cost_evaluations)
            self.assertLessEqual(again.cost, first.cost + 1e-6)

    def test_the_same_seed_gives_the_same_bits(self):
        runs = [prospect.solve(path_problem(), "sampling", seed=3, max_evaluations=300) for _ in range(2)]
        np.testing.assert_array_equal(runs[0].x, runs[1].x)

    def test_a_deadline_ends_a_solve(self):
        class Slow(Attraction):
            def value(self, t):
                time.sleep(0.01)
                return super().value(t)

        p = prospect.Problem(prospect.motion_model("unicycle"), [0, 0, 0], [Slow(1, 1)])
        r = prospect.solve(p, "nlopt:LN_SBPLX", deadline=0.1)
        self.assertEqual(r.stop, StopReason.DEADLINE)
        self.assertLess(r.seconds, 0.5)
        self.assertEqual(r.x.shape, (p.n,))

    def test_a_solve_can_be_cancelled(self):
        end = time.monotonic() + 0.1
        r = prospect.solve(
            rosenbrock(), "nlopt:GN_ISRES", max_evaluations=10**9, cancelled=lambda: time.monotonic() > end
        )
        self.assertEqual(r.stop, StopReason.CANCELLED)

    def test_an_exception_while_it_is_asked_ends_it(self):
        def cancelled():
            raise KeyError("asked")

        with self.assertRaisesRegex(KeyError, "asked"):
            prospect.solve(rosenbrock(), "nlopt:GN_ISRES", max_evaluations=10**9, cancelled=cancelled)

    def test_a_trace_tells_every_improvement(self):
        r = prospect.solve(rosenbrock(), "nlopt:LD_LBFGS", trace=1)
        self.assertEqual(r.trace.shape[1], 4)
        self.assertTrue((np.diff(r.trace[:, 2]) < 0).all())
        self.assertEqual(r.trace[-1, 2], r.cost)

    def test_wrong_arguments_are_said_in_one_line(self):
        p = rosenbrock()
        cases = [
            (lambda: prospect.solve(p, "nlop"), "unknown solver 'nlop' .did you mean 'nlopt'"),
            (lambda: prospect.solve(p, max_evaluation=3), "did you mean 'max_evaluations'"),
            (lambda: prospect.solve(p, max_evaluations=-3), "max_evaluations"),
            (lambda: prospect.solve(p, start=[1, 2, 3]), r"start: has shape \(3,\); expected \(2,\)"),
            (lambda: prospect.solve(p, "ceres"), "no residual form"),
            (lambda: prospect.solve(path_problem(), Descent()), "has constraints"),
        ]
        for call, text in cases:
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()

    def test_a_term_that_fails_is_a_solve_error_with_its_place(self):
        class Late(Attraction):
            calls = 0

            def value(self, t):
                self.calls += 1
                if self.calls > 4:
                    raise ArithmeticError("late")
                return super().value(t)

        p = prospect.Problem(prospect.motion_model("unicycle"), [0, 0, 0], [Late(1, 1)])
        with self.assertRaisesRegex(
            prospect.SolveError, r"attraction\.value.*: ArithmeticError: late \(.*solver_test\.py:\d+\)"
        ) as caught:
            prospect.solve(p, "nlopt:LD_SLSQP")
        result = caught.exception.result
        self.assertEqual(result.stop, StopReason.ERROR)
        self.assertTrue(np.isfinite(result.cost))  # the best point until then stands

    def test_two_threads_solve_at_once(self):
        expected = prospect.solve(path_problem(), "nlopt:LD_SLSQP")
        found = {}

        def work(n, problem):
            found[n] = [prospect.solve(problem, "nlopt:LD_SLSQP").x for _ in range(3)]

        shared = path_problem()
        threads = [threading.Thread(target=work, args=(n, shared)) for n in range(2)]
        threads += [threading.Thread(target=work, args=(2, path_problem()))]
        [t.start() for t in threads]
        [t.join() for t in threads]
        for n in range(3):
            for x in found[n]:
                np.testing.assert_array_equal(x, expected.x)

    def test_python_goes_on_while_a_solve_runs(self):
        stop, ticks = threading.Event(), []

        def tick():
            while not stop.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        prospect.solve(rosenbrock(), "nlopt:GN_ISRES", deadline=0.2, max_evaluations=10**9)
        stop.set()
        thread.join()
        self.assertGreater(len(ticks), 5)


class OwnSolverTest(unittest.TestCase):
    def test_it_solves(self):
        r = prospect.solve(path_problem(constrained=False), Descent())
        best = prospect.solve(path_problem(constrained=False), "nlopt:LD_SLSQP", tolerance=1e-10)
        self.assertAlmostEqual(r.cost, best.cost, 4)
        self.assertEqual(r.quality, Quality.FEASIBLE_OPTIMUM)
        self.assertGreater(r.iterations, 3)
        self.assertEqual(r.detail, "steps vanish")

    def test_it_is_had_by_name_with_its_options(self):
        registries = prospect.Registries()
        registries.add_solver(Descent())
        entry = next(s for s in registries.solvers() if s["name"] == "descent")
        self.assertEqual(entry["options"]["rate"], (1.0, "first step"))
        r = prospect.solve(rosenbrock(), "descent", registries=registries, rate=0.01)
        self.assertLess(r.cost, 0.1)
        with self.assertRaisesRegex(ValueError, "unknown option 'rat'"):
            prospect.solve(rosenbrock(), "descent", registries=registries, rat=0.01)
        with self.assertRaisesRegex(ValueError, "descent"):
            registries.add_solver(Descent())

    def test_evaluations_end_it_and_the_best_point_stands(self):
        r = prospect.solve(rosenbrock(), Descent(), max_evaluations=20)
        self.assertEqual(r.stop, StopReason.ITERATION_LIMIT)
        self.assertEqual(r.cost_evaluations, 20)
        self.assertEqual(r.cost, rosenbrock().cost(r.x))

    def test_what_goes_wrong_in_it_is_one_line(self):
        class Fails(Descent):
            def run(self, evaluator, options, warm_start):
                evaluator.cost([1, 2, 3])

        class Forgets(Descent):
            def run(self, evaluator, options, warm_start):
                return None

        class Keeps(Descent):
            def run(self, evaluator, options, warm_start):
                self.kept = evaluator
                return evaluator.finish()

        with self.assertRaisesRegex(prospect.SolveError, r"descent.run: ValueError: x: has shape \(3,\)"):
            prospect.solve(rosenbrock(), Fails())
        with self.assertRaisesRegex(prospect.SolveError, "gave no Result"):
            prospect.solve(rosenbrock(), Forgets())
        solver = Keeps()
        prospect.solve(rosenbrock(), solver)
        with self.assertRaisesRegex(RuntimeError, "the solve is over"):
            solver.kept.cost([0, 0])

    def test_it_is_run_by_one_thread_at_a_time(self):
        class Counts(Descent):
            inside = most = 0

            def run(self, evaluator, options, warm_start):
                self.inside += 1
                self.most = max(self.most, self.inside)
                for _ in range(20):
                    evaluator.cost(evaluator.start)
                    time.sleep(0.0005)
                self.inside -= 1
                return evaluator.finish()

        registries, solver = prospect.Registries(), Counts()
        registries.add_solver(solver)
        work = lambda: prospect.solve(rosenbrock(), "descent", registries=registries)
        threads = [threading.Thread(target=work) for _ in range(3)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        self.assertEqual(solver.most, 1)

    def test_batches_and_constraints(self):
        class Random(prospect.Solver):
            name, description, needs_gradient = "random", "random search", False

            def run(self, evaluator, options, warm_start):
                rng = np.random.default_rng(options["seed"])
                while not evaluator.should_stop():
                    X = rng.uniform(evaluator.lower, evaluator.upper, (16, evaluator.n))
                    cost, violation = evaluator.evaluate_batch(X)
                    assert cost.shape == violation.shape == (16,)
                    assert evaluator.constraints(X[0]).shape == (evaluator.m,)
                return evaluator.finish(StopReason.ITERATION_LIMIT)

        r = prospect.solve(path_problem(), Random(), max_evaluations=400)
        self.assertEqual(r.cost_evaluations, 400)
        self.assertLessEqual(r.violation, 1e-6)


if __name__ == "__main__":
    unittest.main()
