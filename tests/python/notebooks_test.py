# SPDX-License-Identifier: Apache-2.0
"""The notebooks of the docs run as they are written, from top to bottom.

With PROSPECT_FIGURES=FOLDER their figures are kept there, to be looked at.
"""

import contextlib
import glob
import io
import json
import os
import sys
import tempfile
import unittest

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    import scipy  # noqa: F401
    missing = ""
except ImportError as error:
    missing = str(error)

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NOTEBOOKS = sorted(glob.glob(os.path.join(ROOT, "docs", "notebooks", "*.ipynb")))


class NotebooksTest(unittest.TestCase):
    def run_notebook(self, path):
        """Its figures, what it printed, and its names."""
        with open(path, encoding="utf-8") as file:
            cells = json.load(file)["cells"]
        name = os.path.splitext(os.path.basename(path))[0]
        kept = os.environ.get("PROSPECT_FIGURES")
        space, figures, printed = {"__name__": "__main__"}, 0, io.StringIO()
        for n, cell in enumerate(cells):
            if cell["cell_type"] != "code":
                continue
            self.assertEqual(cell["outputs"], [], f"{name}: cell {n} is stored with its output")
            with contextlib.redirect_stdout(printed):
                exec(compile("".join(cell["source"]), f"{name}[{n}]", "exec"), space)
            for number in plt.get_fignums():
                figures += 1
                buffer = io.BytesIO()
                plt.figure(number).savefig(buffer, format="png")
                self.assertGreater(len(buffer.getvalue()), 4000, f"{name}: figure {figures} is empty")
                if kept:
                    with open(os.path.join(kept, f"{name}_{figures}.png"), "wb") as file:
                        file.write(buffer.getvalue())
            plt.close("all")
        return figures, printed.getvalue(), space

    def check_costs(self, steps, parts):
        """Costs times the weights in effect make up the cost that was recorded."""
        cost = steps["cost"]
        planned = np.isfinite(cost)
        self.assertGreater(planned.sum(), 30)
        np.testing.assert_allclose(sum(parts.values())[planned], cost[planned], rtol=1e-12, atol=1e-12)
        changed = sum(np.abs(steps["weight_" + name] - steps["weight_asked_" + name]) for name in parts)
        self.assertGreater((changed[planned] > 0).sum(), 0, "no step tells the one from the other")

    @unittest.skipIf(missing, missing)
    def test_they_run(self):
        self.assertEqual(len(NOTEBOOKS), 3)
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            sys.path.insert(0, os.path.dirname(NOTEBOOKS[0]))  # what lies beside them
            os.chdir(folder)
            try:
                for path in NOTEBOOKS:
                    with self.subTest(os.path.basename(path)):
                        figures, printed, space = self.run_notebook(path)
                        self.assertGreaterEqual(figures, 2)
                        if os.path.basename(path) == "look_at_a_mission.ipynb":
                            self.check_costs(space["steps"], space["parts"])
                        if os.environ.get("PROSPECT_FIGURES"):
                            print(printed)
            finally:
                os.chdir(before)


if __name__ == "__main__":
    unittest.main()
