# SPDX-License-Identifier: Apache-2.0
"""What the program wrote, as arrays: runs, benches, studies."""

import csv
import io
import json
import os

import numpy as np


class Columns(dict):
    """A table: the array (rows,) of each column, by its name.

    Columns of whole numbers are int, of numbers float (an empty field is nan), all others str.
    """

    def frame(self):
        """The same as a pandas DataFrame, where pandas is there."""
        import pandas

        return pandas.DataFrame(dict(self))

    @property
    def rows(self):
        """How many rows there are."""
        return len(next(iter(self.values()))) if self else 0

    def where(self, rows):
        """The rows chosen by `rows`: a mask, a slice or indices."""
        return Columns((name, column[rows]) for name, column in self.items())

    def __repr__(self):
        return f"Columns({self.rows} rows: {', '.join(self)})"


def _column(fields):
    for kind in (int, float):
        try:
            if kind is float:
                return np.array([float(f) if f else np.nan for f in fields])
            return np.array([int(f) for f in fields], dtype=np.int64)
        except (ValueError, OverflowError):
            continue
    return np.array(fields, dtype=str)


def _table(file, path):
    reader = csv.reader(file, strict=True)
    try:
        header, rows = next(reader, []), []
        if not header or len(set(header)) != len(header) or "" in header:
            raise ValueError(f"{path}:1: no header; expected names of columns, each once")
        for row in reader:
            if len(row) != len(header):
                raise ValueError(
                    f"{path}:{reader.line_num}: has {len(row)} fields; expected {len(header)}"
                )
            rows.append(row)
    except UnicodeDecodeError:
        raise ValueError(f"{path}: no text; expected a CSV file") from None
    except csv.Error as error:
        raise ValueError(f"{path}:{reader.line_num}: {error}; expected a CSV file") from None
    return Columns((name, _column([row[n] for row in rows])) for n, name in enumerate(header))


def load_table(path):
    """The Columns of a CSV file with a header. ValueError, "FILE:LINE: ...", for one that is none."""
    path = os.fspath(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return _table(file, path)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; expected a CSV file") from None


def _json(path, absent_ok=False):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except FileNotFoundError:
        if absent_ok:
            return None
        raise ValueError(f"{path}: no such file; expected one that the program wrote") from None
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; expected a JSON file") from None
    except ValueError as error:
        line = getattr(error, "lineno", 1)
        raise ValueError(f"{path}:{line}: no JSON; expected what the program wrote") from None


def _trajectory(path):
    if not os.path.exists(path):
        return np.zeros((0, 8))
    rows = []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            if not line.strip() or line.startswith("#"):
                continue
            try:
                row = [float(field) for field in line.split()]
            except ValueError:
                row = []
            if len(row) != 8:
                raise ValueError(f"{path}:{number}: expected time x y z qx qy qz qw")
            rows.append(row)
    return np.array(rows).reshape(-1, 8)


class Run:
    """A mission, as `prospect explore` or `prospect drive` wrote it (docs/reference/report.md)."""

    def __init__(self, folder):
        folder = os.fspath(folder)
        if not os.path.isdir(folder):
            raise ValueError(f"{folder}: no such folder; expected that of a run")
        self.folder = folder
        """The path."""
        self.info = _json(os.path.join(folder, "run.json"))
        """dict: what it was started with."""
        self.summary = _json(os.path.join(folder, "summary.json"), absent_ok=True)
        """dict: the results in numbers; None of a run that did not end."""
        self.steps = load_table(os.path.join(folder, "steps.csv"))
        """Columns: a row a planning step."""
        timing = os.path.join(folder, "timing.csv")
        self.timing = load_table(timing) if os.path.exists(timing) else Columns()
        """Columns: wall-clock times of each step [ms]."""
        self.true = _trajectory(os.path.join(folder, "trajectory_true.tum"))
        """(K, 8): time [s], x, y, z [m], qx, qy, qz, qw of the true pose."""
        self.estimated = _trajectory(os.path.join(folder, "trajectory_estimated.tum"))
        """(K, 8): the same of the estimate."""
        problems = os.path.join(folder, "problems")
        self.problems = (
            sorted(os.path.join(problems, f) for f in os.listdir(problems) if f.endswith(".h5"))
            if os.path.isdir(problems)
            else []
        )
        """Paths of the problem files, by step."""

    def __repr__(self):
        return f"Run('{self.folder}', {self.steps.rows} steps)"


class Log:
    """A mission by its log, mission.mcap (docs/reference/log.md): as Run, and what it planned."""

    def __init__(self, path):
        from prospect import _program

        self.path = os.fspath(path)
        """The path."""
        read = _program.read_log(self.path)
        self.info = read["info"]
        """dict of str: what it was started with, and the whole configuration."""
        self.summary = json.loads(read["summary"]) if read["summary"] else None
        """dict: the results in numbers; None of a log that ends early."""
        self.steps = _table(io.StringIO(read["steps"]), self.path)
        """Columns: a row a planning step."""
        self.timing = _table(io.StringIO(read["timing"]), self.path)
        """Columns: wall-clock times of each step [ms]."""
        self.true = read["true"]
        """(K, 8): time [s], x, y, z [m], qx, qy, qz, qw of the true pose."""
        self.estimated = read["estimated"]
        """(K, 8): the same of the estimate."""
        self.plans = read["plans"]
        """K arrays (N+1, 4): x, y, z [m], yaw [rad] that each step predicted."""
        self.ground = read["ground"]
        """(ny, nx) uint8: 0 unknown, 1 free, 2 occupied, as the last step knew it; row j at y."""
        self.extent = read["extent"]
        """left, right, bottom, top [m] of the ground."""
        self.notes = read["notes"]
        """list of str: what the log has to do without, such as its end."""

    def __repr__(self):
        return f"Log('{self.path}', {self.steps.rows} steps)"


class Bench:
    """What `prospect bench` measured (docs/reference/bench.md)."""

    def __init__(self, folder):
        folder = os.fspath(folder)
        if not os.path.isdir(folder):
            raise ValueError(f"{folder}: no such folder; expected that of a bench")
        self.folder = folder
        """The path."""
        self.rows = load_table(os.path.join(folder, "bench.csv"))
        """Columns: a row a problem, back end and deadline."""
        self.json = _json(os.path.join(folder, "bench.json"))
        """dict: everything, with summaries, profiles and curves."""

    def __repr__(self):
        return f"Bench('{self.folder}', {self.rows.rows} rows)"


def load_run(folder):
    """The Run in a folder. ValueError, one line with file and line, for one that is none."""
    return Run(folder)


def load_log(path):
    """The Log in a file mission.mcap. ValueError likewise."""
    return Log(path)


def load_bench(folder):
    """The Bench in a folder. ValueError likewise."""
    return Bench(folder)


def load_study(folder):
    """The Columns of a study, `prospect study`: a row a run. `folder`, or its results.csv."""
    path = os.fspath(folder)
    return load_table(os.path.join(path, "results.csv") if os.path.isdir(path) else path)
