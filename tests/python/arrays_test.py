# SPDX-License-Identifier: Apache-2.0
"""Arrays are the numbers that were given, or are refused: no function casts them to others."""

import copy
import inspect
import pathlib
import pickle
import re
import tempfile
import unittest

import numpy as np
import prospect
from prospect import _core, _program
from samples import Attraction, path_problem, rosenbrock

NAN = float("nan")


def room():
    voxels = np.zeros((40, 30, 8), np.uint8)
    voxels[:20] = 1
    voxels[:20, :, 0] = voxels[:, 0] = voxels[:, -1] = voxels[0] = 2
    return voxels


class Recorded(prospect.Solver):
    """Lends its evaluator to a test."""

    name, description = "recorded", "of a test"

    def __init__(self, use):
        self.use = use

    def run(self, evaluator, options, start):
        self.use(evaluator)
        return evaluator.finish()


def in_solve(method):
    """method(evaluator, array) within a solve, whose error comes out as it was raised."""

    def call(array):
        caught = []

        def use(evaluator):
            try:
                getattr(evaluator, method)(array)
            except (TypeError, ValueError) as error:
                caught.append(error)

        prospect.solve(rosenbrock(), Recorded(use))
        if caught:
            raise caught[0]

    return call


CONFIGURATION = prospect.Configuration(settings={"planner.threads": 1})
MAPS = prospect.Maps(room(), 0.1, (0.0, 0.0, -0.1), CONFIGURATION)
POSE = [1.5, 1.0, 0.0, 1.57]
BELIEF = prospect.Belief(MAPS, POSE, stamp=0.0)
PROBLEM = path_problem()
FUNCTIONS = prospect.Problem.from_functions
UNICYCLE = prospect.motion_model("unicycle")
Z = np.zeros(PROBLEM.n)


def setter(name):
    return lambda array: setattr(prospect.WarmStart(), name, array)


def position(**more):
    return prospect.Landmarks(np.zeros((2, 3)), **more)


def belief(**more):
    return prospect.Belief(MAPS, more.pop("pose", POSE), stamp=0.0, **more)


def planner():
    if not planner.made:
        planner.made.append(prospect.Planner(CONFIGURATION))
        planner.made.append(planner.made[0].plan(BELIEF))
    return planner.made


planner.made = []


def check(previous):
    p, plan = planner()
    p.check(plan, 0, previous, BELIEF, 0.0)


def simulation(command):
    if not simulation.made:
        simulation.made.append(prospect.Simulation("office"))
    simulation.made[0].apply(command, 0.0)


simulation.made = []

# Of each argument that is an array: a call with it, numbers that it takes, and whether all must be
# finite. What may not be finite says what becomes of it: a candidate is not valid, a command a stop.
FINITE, ANY = True, False
ARGUMENTS = {
    "Maps.__init__ voxels": (lambda a: prospect.Maps(a, 0.1, (0, 0, 0), CONFIGURATION), room(), FINITE),
    "Maps.__init__ origin": (lambda a: prospect.Maps(room(), 0.1, a, CONFIGURATION), [0.1, 0.2, -0.1], FINITE),
    "Landmarks.__init__ position": (prospect.Landmarks, np.ones((2, 3)), FINITE),
    "Landmarks.__init__ covariance": (lambda a: position(covariance=a), np.tile(np.eye(3), (2, 1, 1)), FINITE),
    "Landmarks.__init__ direction": (lambda a: position(direction=a), np.ones((2, 3)), FINITE),
    "Landmarks.__init__ range": (lambda a: position(range=a), [2.0, 1.0], FINITE),
    "Landmarks.__init__ survival": (lambda a: position(survival=a), [0.5, 1.0], FINITE),
    "Belief.__init__ pose": (lambda a: belief(pose=a), POSE, FINITE),
    "Belief.__init__ covariance": (lambda a: belief(covariance=a), 1e-4 * np.eye(4), FINITE),
    "Belief.__init__ velocity": (lambda a: belief(velocity=a), [0.1, 0, 0, 0], FINITE),
    "Belief.__init__ command": (lambda a: belief(command=a), [0.1, 0, 0, 0], FINITE),
    "Belief.__init__ movers": (lambda a: belief(movers=a), [[1.0, 2.0, 0.5, 0.1, 0.3, 0.2]], FINITE),
    "Belief.__init__ map_frame": (lambda a: belief(map_frame=a), [1.0, 2.0, 0.5], FINITE),
    "Planner.set_task goal": (lambda a: planner()[0].set_task("go", a), [1.5, 1.2], FINITE),
    "Planner.check previous": (check, np.zeros(4), ANY),
    "Simulation.apply command": (simulation, np.zeros(4), ANY),
    "Problem.__init__ x0": (lambda a: prospect.Problem(UNICYCLE, a, [Attraction(1, 1)]), [0, 0, 0.2], FINITE),
    "Problem.__init__ u_previous": (
        lambda a: prospect.Problem(UNICYCLE, [0, 0, 0], [Attraction(1, 1)], u_previous=a),
        [0.1, 0.0],
        FINITE,
    ),
    "Problem.__init__ start": (
        lambda a: prospect.Problem(UNICYCLE, [0, 0, 0], [Attraction(1, 1)], M=2, start=a),
        [0.1, 0.0, 0.1, 0.0],
        FINITE,
    ),
    "Problem.from_functions lower": (lambda a: FUNCTIONS(a, [2, 2], sum), [-2, -2], FINITE),
    "Problem.from_functions upper": (lambda a: FUNCTIONS([-2, -2], a, sum), [2, 2], FINITE),
    "Problem.from_functions start": (lambda a: FUNCTIONS([-2, -2], [2, 2], sum, start=a), [1, 1], FINITE),
    "Problem.evaluate z": (PROBLEM.evaluate, Z, ANY),
    "Problem.cost z": (PROBLEM.cost, Z, ANY),
    "Problem.gradient z": (PROBLEM.gradient, Z, ANY),
    "Problem.constraints z": (PROBLEM.constraints, Z, ANY),
    "Problem.jacobian z": (PROBLEM.jacobian, Z, ANY),
    "Problem.residuals z": (lambda a: path_problem(False).residuals(a), Z, ANY),
    "Problem.explain z": (PROBLEM.explain, Z, ANY),
    "Problem.rollout z": (PROBLEM.rollout, Z, FINITE),
    "Problem.knots_from_inputs inputs": (PROBLEM.knots_from_inputs, np.zeros((PROBLEM.N, 2)), FINITE),
    "WarmStart.x": (setter("x"), [1.0, 2.0], FINITE),
    "WarmStart.multipliers": (setter("multipliers"), [1.0, 2.0], FINITE),
    "WarmStart.z_lower": (setter("z_lower"), [1.0, 2.0], FINITE),
    "WarmStart.z_upper": (setter("z_upper"), [1.0, 2.0], FINITE),
    "WarmStart.seeds": (setter("seeds"), [[1.0, 2.0]], FINITE),
    "Evaluator.cost x": (in_solve("cost"), [1.0, 1.0], ANY),
    "Evaluator.cost_and_gradient x": (in_solve("cost_and_gradient"), [1.0, 1.0], ANY),
    "Evaluator.constraints x": (in_solve("constraints"), [1.0, 1.0], ANY),
    "Evaluator.jacobian x": (in_solve("jacobian"), [1.0, 1.0], ANY),
    "Evaluator.evaluate_batch X": (in_solve("evaluate_batch"), [[1.0, 1.0]], ANY),
    # One argument for two types: an array or a WarmStart.
    "solve start": (lambda a: prospect.solve(rosenbrock(), start=a, max_evaluations=3), [1.0, 1.0], FINITE),
}
BY_HAND = {"solve start"}


def signatures():
    """(name, signature) of every function, constructor, method and setter of the package."""
    for module in (_core, _program):
        for name, thing in vars(module).items():
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    value = getattr(value, "__func__", value)
                    if isinstance(value, property):
                        if value.fset is not None:
                            yield f"{name}.{member}", value.fset.__doc__ or "", True
                    elif getattr(value, "__doc__", None) and callable(value):
                        yield f"{name}.{member}", value.__doc__, False
            elif callable(thing) and getattr(thing, "__doc__", None):
                yield name, thing.__doc__, False


def arrays_of(document):
    """Names of the arguments that are arrays, of the first line of a docstring of pybind11."""
    line = document.strip().splitlines()[0]
    if "->" not in line:
        return [], line
    given = line[line.index("(") + 1 : line.rindex(") ->")]
    return re.findall(r"(\w+): (?:Optional\[)?ArrayLike", given), given


class ArraysTest(unittest.TestCase):
    def test_every_argument_that_is_an_array_stands_in_the_table(self):
        found = set()
        for name, document, is_setter in signatures():
            names, given = arrays_of(document)
            # An argument of numpy's own type is cast by pybind11, without a word.
            self.assertNotIn("ndarray", given, name)
            found |= {name if is_setter else f"{name} {argument}" for argument in names}
        self.assertEqual(found, set(ARGUMENTS) - BY_HAND)

    def assertRefused(self, what, call, array, *said):
        try:
            call(array)
        except (TypeError, ValueError) as error:
            for text in said:
                self.assertIn(text, str(error), what)
            self.assertIn("expected", str(error), what)
            return
        self.fail(f"{what}: took {array!r:.200}")

    def test_what_is_given_is_taken_as_it_is(self):
        for what, (call, good, _) in ARGUMENTS.items():
            good = np.array(good)
            with self.subTest(what):
                call(good)
                call(good.tolist())
                call(np.asfortranarray(good))
                wide = np.zeros([2 * n for n in good.shape], good.dtype)
                every = tuple(slice(None, None, 2) for _ in good.shape)
                wide[every] = good
                call(wide[every])
                call(good.astype(good.dtype.newbyteorder(">")))

    def test_what_would_become_other_numbers_is_refused(self):
        for what, (call, good, finite) in ARGUMENTS.items():
            good = np.array(good)
            name = what.split(" ")[-1].split(".")[-1]
            with self.subTest(what):
                self.assertRefused(what, call, good.astype(bool), name, "bool")
                self.assertRefused(what, call, good.astype(complex), name, "complex")
                self.assertRefused(what, call, good.astype(object), name, "object")
                self.assertRefused(what, call, good.astype(str), name)
                self.assertRefused(what, call, good.astype("m8[s]"), name)
                self.assertRefused(what, call, np.ma.masked_array(good, good > 0), name, "mask")
                self.assertRefused(what, call, {"a": 1}, name)
                self.assertRefused(what, call, good[..., np.newaxis, np.newaxis], name, "shape")
                self.assertRefused(what, call, np.full(good.shape, 2**53 + 1), name, str(2**53 + 1))
                for bad in (NAN, np.inf, -np.inf):
                    array = good.astype(float)
                    array[-1] = bad
                    if finite:
                        self.assertRefused(what, call, array, name, str(bad))
                    else:
                        call(array)

    def test_probabilities_are_no_voxels(self):
        def maps(voxels):
            return prospect.Maps(voxels, 0.1, (0.0, 0.0, -0.1), CONFIGURATION)

        probabilities = np.full((20, 20, 8), 0.5)
        probabilities[:10] = 0.0
        probabilities[10] = 1.0
        with self.assertRaisesRegex(ValueError, r"voxels: holds 0.5 at \(11, 0, 0\); expected 0 \(unknown\)"):
            maps(probabilities)
        with self.assertRaisesRegex(TypeError, "voxels: has dtype float64; expected whole numbers"):
            maps(np.round(probabilities))
        with self.assertRaisesRegex(TypeError, "voxels: has dtype bool"):
            maps(probabilities > 0.5)
        for dtype in (np.int64, np.int32, np.uint16, np.int16):
            codes = np.ones((20, 20, 8), dtype)
            codes[3, 4, 5] = 258
            with self.assertRaisesRegex(ValueError, r"voxels: holds 258 at \(3, 4, 5\)"):
                maps(codes)
            codes[3, 4, 5] = 2
            np.testing.assert_array_equal(maps(codes).ground, maps(codes.astype(np.uint8)).ground)
        for wrong in (-1, 3, 2**62):
            with self.assertRaisesRegex(ValueError, f"voxels: holds {wrong} at"):
                maps(np.full((2, 2, 2), wrong))

    def test_voxels_are_where_they_are_told_to_be(self):
        def maps(voxels, resolution=0.1, origin=(0.0, 0.0, 0.0)):
            return prospect.Maps(voxels, resolution, origin, CONFIGURATION)

        # An octree's addresses have 16 bits: what lies beyond came in again at the other side.
        for shape, origin, axis in (
            ((2, 2, 2), (5000.0, 0.0, 0.0), "x"),
            ((2, 2, 2), (0.0, -3276.9, 0.0), "y"),
            ((2, 2, 2), (448262.8, 5411932.3, 0.0), "x"),
            ((40000, 1, 1), (0.0, 0.0, 0.0), "y"),
            ((1, 1, 33000), (0.0, 0.0, 0.0), "z"),
        ):
            with self.assertRaisesRegex(ValueError, f"origin: along {axis} the voxels reach .*; expected within 3276"):
                maps(np.ones(shape, np.uint8), origin=origin)
        for origin in ((3276.6, -3276.8, 0.0), (-3276.8, 3276.6, 0.0)):
            made = maps(np.ones((2, 2, 5), np.uint8), origin=origin)
            left, _, bottom, _ = made.extent
            row, column = np.argwhere(made.ground == 1).min(axis=0)
            self.assertAlmostEqual(left + 0.1 * column, origin[0], 6)
            self.assertAlmostEqual(bottom + 0.1 * row, origin[1], 6)
        # Without the memory that it would take: no entry of these is stored.
        for shape in ((100_000, 100_000, 1), (2**20, 2**20, 2**20)):
            with self.assertRaisesRegex(ValueError, "voxels: has [0-9]+ entries; expected at most 400000000"):
                maps(np.broadcast_to(np.uint8(1), shape))
        with self.assertRaisesRegex(ValueError, "voxels: is empty; expected"):
            maps(np.ones((2, 0, 2), np.uint8))

    def test_ranges(self):
        for more in ({"range": [1.0, 0.0]}, {"survival": [0.5, 1.1]}, {"survival": [-0.1, 0.5]}):
            with self.assertRaisesRegex(ValueError, f"^{next(iter(more))}: holds .*; expected"):
                position(**more)
        skewed = np.eye(3)
        skewed[0, 1] = 0.5
        for more, said in (
            ({"covariance": [np.eye(3), skewed]}, "covariance: 1: is not symmetric"),
            ({"covariance": [-np.eye(3), np.eye(3)]}, "covariance: 0: has a variance of -1"),
            ({"direction": [[1, 0, 0], [0, 0, 0]]}, "direction: 1 is 0"),
            ({"feature_density": -1.0}, "feature_density: is -1"),
        ):
            with self.assertRaisesRegex(ValueError, f"^{said}.*; expected"):
                position(**more)
        for more, said in (
            ({"covariance": np.diag([1, 1, 0, -1e-3])}, "covariance: has a variance of -0.001"),
            ({"covariance": np.arange(16.0).reshape(4, 4)}, "covariance: is not symmetric"),
            ({"velocity": [1e6, 0, 0, 0]}, "velocity: is 1000000"),
            ({"command": [0, 0, 0, 360.0]}, "command: is 360"),
            ({"tracked_features": -1}, "tracked_features: is -1"),
        ):
            with self.assertRaisesRegex(ValueError, f"^{said}.*; expected"):
                belief(**more)
        belief(covariance=np.diag([1.0, 1.0, 0.0, 0.5]))
        with self.assertRaisesRegex(ValueError, "stamp: is nan; expected"):
            prospect.Belief(MAPS, POSE, stamp=NAN)

    def test_what_functions_in_python_give_is_held_to_the_same(self):
        def cost(z):
            return float(z @ z)

        for name, more in {
            "gradient": {"gradient": lambda z: np.array(["1", "2"])},
            "constraints": {"rows": 1, "constraints": lambda z: [True], "jacobian": lambda z: [[1, 1]]},
            "jacobian": {"rows": 1, "constraints": lambda z: [1.0], "jacobian": lambda z: [[1j, 1]]},
        }.items():
            problem = FUNCTIONS([-1, -1], [1, 1], cost, more.pop("gradient", lambda z: 2 * z), **more)
            with self.assertRaisesRegex(Exception, f"{name}: has dtype"):
                problem.evaluate([0.1, 0.2], "gradient")

        class Flags(Attraction):
            def value(self, t):
                return np.ones(t.B, bool)

        with self.assertRaisesRegex(Exception, r"attraction.value: has dtype bool"):
            prospect.Problem(UNICYCLE, [0, 0, 0], [Flags(1, 1)]).cost(np.zeros(20))

    def test_a_cost_is_one_number(self):
        wrong = {
            (2,): np.ones(2),
            (2, 1): np.ones((2, 1)),
            (0,): np.ones(0),
            "dtype bool": True,
            "dtype complex128": 1j,
            "dtype object": None,
            "dtype <U1": "1",
        }
        for said, given in wrong.items():
            problem = FUNCTIONS([-1, -1], [1, 1], lambda z, given=given: given)
            with self.subTest(said):
                with self.assertRaises((TypeError, ValueError)) as caught:
                    problem.cost([0.1, 0.2])
                self.assertRegex(str(caught.exception), f"cost: has (shape )?{re.escape(str(said))}; expected")
        for given in (2, 2.0, np.float32(2), np.array(2.0), np.array([[2.0]])):
            self.assertEqual(FUNCTIONS([-1, -1], [1, 1], lambda z, given=given: given).cost([0.1, 0.2]), 2.0)

    def test_numbers_that_are_none_are_refused_in_words(self):
        problem = rosenbrock()
        for call, said in (
            (lambda: prospect.motion_model("unicycle", v_max="1"), "v_max: has dtype"),
            (lambda: prospect.motion_model("unicycle", v_max=True), "v_max: has dtype bool"),
            (lambda: prospect.solve(problem, max_evaluations=2**70), f"option 'max_evaluations': is {2**70}"),
            (lambda: prospect.solve(problem, tolerance=1j), "option 'tolerance': has dtype complex"),
            (lambda: prospect.solve(problem, deadline=NAN), "deadline: is nan s"),
            (lambda: prospect.solve(problem, deadline=-1.0), "deadline: is -1 s"),
            (lambda: planner()[0].plan(BELIEF, NAN), "deadline: is nan s"),
            (lambda: prospect.Registries().add_term("t", None, options={"a": ("1", 0, 2, "m", "x")}), "option 'a': has"),
            (lambda: simulation([0, 0, 0, 0]) or simulation.made[0].apply(np.zeros(4), 1e300), r"duration: is 1e\+300 s"),
            (lambda: prospect.Maps(room(), 1e-9, (0, 0, 0), CONFIGURATION), "resolution: is 1e-09 m"),
        ):
            with self.assertRaisesRegex((TypeError, ValueError), said + ".*; expected"):
                call()
        # Whatever it gives that Python takes for true.
        for true in (1, "yes", np.True_, [0]):
            result = prospect.solve(problem, "nlopt:GN_DIRECT_L", cancelled=lambda true=true: true, deadline=5.0)
            self.assertIn(result.stop, (prospect.StopReason.CANCELLED, prospect.StopReason.ITERATION_LIMIT))

    def test_an_error_has_words_whatever_it_names(self):
        for path in (b"/tmp/\xff\xfe", "/tmp/\udcff", "/tmp/\x1b[31mx"):
            for call in (prospect.Configuration, prospect.load_problem):
                with self.assertRaisesRegex(ValueError, r"/tmp/[? ].*; expected") as caught:
                    call(path)
                self.assertNotIn("\x1b", str(caught.exception))

    def test_what_lives_in_the_process_is_not_copied(self):
        for thing in (PROBLEM, CONFIGURATION, MAPS, BELIEF, UNICYCLE, PROBLEM.start, prospect.Registries()):
            for call in (pickle.dumps, copy.copy, copy.deepcopy):
                with self.assertRaisesRegex(TypeError, f"{type(thing).__name__}: cannot be pickled or copied"):
                    call(thing)

    def test_paths_are_paths(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "c.yaml"
            file.write_text("planner: {weights: {w_l: 0}}\n")
            for path in (file, str(file), bytes(file)):
                self.assertEqual(prospect.Configuration(path).values["planner.weights.w_l"], "0")
            for call in (
                prospect.load_problem,
                prospect.Configuration,
                prospect.Simulation,
                prospect.Registries().load_plugin,
                prospect.load_log,
            ):
                with self.assertRaises(Exception) as error:
                    call(pathlib.Path(folder) / "none.x")
                self.assertNotIsInstance(error.exception, TypeError, call)


if __name__ == "__main__":
    unittest.main()
