# SPDX-License-Identifier: Apache-2.0
"""Tables of the program as arrays."""

import os
import subprocess
import tempfile
import unittest

import numpy as np
import prospect


class ResultsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(text)
        return path

    def test_columns_have_their_kinds(self):
        path = self.write("t.csv", 'n,x,text\n1,0.5,a\n2,,"b, ""c"""\n3,nan,\n')
        t = prospect.load_table(path)
        self.assertEqual(t["n"].dtype, np.int64)
        np.testing.assert_array_equal(t["x"], [0.5, np.nan, np.nan])
        self.assertEqual(list(t["text"]), ["a", 'b, "c"', ""])
        self.assertEqual(t.rows, 3)
        self.assertEqual(list(t.where(t["n"] > 1)["n"]), [2, 3])

    def test_numbers_are_read_exactly(self):
        values = np.random.default_rng(1).normal(size=50) * 10.0 ** np.arange(-25, 25)
        path = self.write("t.csv", "x\n" + "\n".join(map(repr, values.tolist())))
        np.testing.assert_array_equal(prospect.load_table(path)["x"], values)

    def test_a_frame_where_pandas_is_there(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("no pandas here: python3-pandas brings it")
        frame = prospect.load_table(self.write("t.csv", "n,x\n1,2.5\n2,\n")).frame()
        self.assertEqual(list(frame.columns), ["n", "x"])
        self.assertTrue(np.isnan(frame["x"][1]))

    def test_a_study_is_its_table(self):
        self.write("results.csv", "condition,seed,coverage\na,1,0.5\nb,2,0.75\n")
        np.testing.assert_array_equal(prospect.load_study(self.folder)["coverage"], [0.5, 0.75])

    def test_a_log_tells_what_the_run_folder_does(self):
        done = subprocess.run(
            [os.environ["PROSPECT"], "explore", "corridor", "--time-limit", "2", "--mcap", "--quiet",
             "--out", self.folder + "/run"],
            capture_output=True, text=True,
        )
        self.assertEqual(done.returncode, 1, done.stderr)  # at the limit
        run = prospect.load_run(self.folder + "/run")
        log = prospect.load_log(self.folder + "/run/mission.mcap")
        self.assertEqual(log.notes, [])
        for name in ["world", "commit", "world_hash"]:
            self.assertEqual(log.info[name], run.info[name])
        self.assertEqual(log.summary, run.summary)
        for told, written in [(log.steps, run.steps), (log.timing, run.timing)]:
            self.assertEqual(list(told), list(written))
            self.assertGreater(told.rows, 3)
        for name in run.steps:
            np.testing.assert_array_equal(log.steps[name], run.steps[name], name)
        np.testing.assert_array_equal(log.true, run.true)
        np.testing.assert_array_equal(log.estimated, run.estimated)
        self.assertEqual([plan.shape for plan in log.plans], [(21, 4)] * log.steps.rows)
        np.testing.assert_allclose(log.plans[0][0, :3], log.estimated[0, 1:4], atol=1e-12)
        # It has seen the ground on which it stood.
        left, right, bottom, top = log.extent
        row = (log.estimated[:, 2] - bottom) / (top - bottom) * log.ground.shape[0]
        column = (log.estimated[:, 1] - left) / (right - left) * log.ground.shape[1]
        np.testing.assert_array_equal(log.ground[row.astype(int), column.astype(int)], 1)

    def test_what_is_wrong_has_file_and_line(self):
        cases = [
            (lambda: prospect.load_table(self.write("a.csv", "x,y\n1,2\n3\n")), "a.csv:3: has 1 fields; expected 2"),
            (lambda: prospect.load_table(self.write("b.csv", "x,x\n")), "b.csv:1: no header"),
            (lambda: prospect.load_table(self.write("c.csv", "")), "c.csv:1: no header"),
            (lambda: prospect.load_table(self.folder), "expected a CSV file"),
            (lambda: prospect.load_run(self.folder + "/absent"), "absent: no such folder"),
            (lambda: prospect.load_run(self.folder), "run.json: no such file"),
            (lambda: prospect.load_bench(self.folder), "bench.csv: No such file"),
            (lambda: prospect.load_log(self.folder + "/absent.mcap"), "absent.mcap: no such file"),
            (lambda: prospect.load_log(self.write("c.mcap", "text")), "c.mcap: "),
        ]
        for call, text in cases:
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()
        self.write("run.json", '{"world": "office",\n oops}')
        with self.assertRaisesRegex(ValueError, "run.json:2: no JSON"):
            prospect.load_run(self.folder)


if __name__ == "__main__":
    unittest.main()
