# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""Recorded runs and sweeps as arrays."""

from __future__ import annotations

import operator
import os
import tempfile
import warnings

import numpy as np

from . import _palpate, _program, _show
from ._errors import Error, InputError, make_error
from ._experiment import Experiment


def _array(values):
    """Returns an array of bool, of int, of float with NaN for None, or of objects."""
    kinds = {type(value) for value in values}
    if kinds in ({bool}, {int}):
        return np.array(values)
    return np.array(values, dtype=float if kinds <= {int, float, type(None)} else object)


def _table(columns):
    """Returns a structured array of columns, each a name with an array or a list."""
    columns = [(name, _array(values) if isinstance(values, list) else values) for name, values in columns]
    out = np.empty(len(columns[0][1]), dtype=[(name, values.dtype) for name, values in columns])
    for name, values in columns:
        out[name] = values
    return out


def _main_error(jobs):
    """Returns the error field of a sweep's table: `rmse_m`, or `rms_surface_distance_m` if all runs are from any side."""
    def has(name):
        return name in jobs.dtype.names and jobs[name].dtype.kind == "f" and bool(np.isfinite(jobs[name]).any())
    return "rms_surface_distance_m" if has("rms_surface_distance_m") and not has("rmse_m") else "rmse_m"


def _numbers(texts):
    """Returns an array of numbers if all texts are numbers, else the texts."""
    for kind in (int, float):
        try:
            return np.array([kind(text) for text in texts])
        except ValueError:
            pass
    return texts


class Maps:
    """Maps of the belief after `taps` taps; every map is an array of rows x columns.

    `height_mean`, `height_standard_deviation`: mean and standard deviation of the height, metres; with `surface: two_part`,
    of an object's height. `uncertainty`: u, the variance of the height relative to the prior, 0 to 1. `weight`: w, the mean
    of the label GP. `probability`: p, the probability of an object at the position. `surface`: reconstructed height, metres.
    """

    __slots__ = ("taps", "height_mean", "height_standard_deviation", "uncertainty", "weight", "probability", "surface")

    def __init__(self, taps, maps):
        self.taps = taps
        for name, value in maps.items():
            setattr(self, name, value)


class Run:
    """A recorded run, opened by load(). The taps are read at once, all other data on first use.

    Threads may share a run. Another process, after fork or pickle, opens the record again.
    """

    def __init__(self, directory):
        self.directory = os.fspath(directory)
        self._opened = _palpate.Record(self.directory)
        self.id = self._record.id()

    def __reduce__(self):  # unpickling in another process opens the record again
        return Run, (os.path.abspath(self.directory),)

    @property
    def _record(self):
        if not self._opened.is_here():  # this is the child of a fork
            self._opened = _palpate.Record(self.directory)
        return self._opened

    def __repr__(self):
        return f"<palpate.Run {self.directory}: {len(self)} taps>"

    def _repr_html_(self):
        shown = ("status", "stop_reason", "rmse_m", "rms_surface_distance_m", "rmse_object_m", "footprint_iou", "robot_seconds")
        rows = [("run", self.directory), ("taps", len(self))]
        try:
            end = self.summary or {"status": "unfinished"}
            rows += [(name, end[name]) for name in shown if end.get(name) is not None]
            return _show.table(rows) + _show.image(self.surface, "surface")
        except Error as trouble:  # A run from any side has no maps, and a damaged record may lack everything.
            return _show.table([*rows, (trouble.place, trouble.reason)])

    def plot(self):
        """Returns a matplotlib figure of surface and taps, standard deviation, and error if the truth is known. Raises Error
        without matplotlib, and for a run from any side."""
        return _plotted(lambda: _show.draw_run(self))

    def __len__(self):
        return self._record.size()

    @property
    def config(self) -> dict:
        """The complete config of the run. Quantities are texts with their units."""
        return self._record.config()

    @property
    def summary(self) -> dict | None:
        """Content of summary.json, nested at the dots of its names; None for a run that has not ended."""
        return self._record.summary()

    @property
    def manifest(self) -> dict | None:
        """Program, build, plugins and command line; None if not recorded."""
        return self._record.manifest()

    @property
    def taps(self) -> np.ndarray:
        """Structured array with one row per tap. describe() returns the meaning of its fields. Missing numbers are NaN.

        `on_object` is the label of a contact at the time of the tap. `summary["relabelled"]` lists the contacts with another
        label at the end of the run.
        """
        return _table(self._record.taps())

    def after(self, taps: int) -> Maps:
        """Computes the models after the first `taps` taps again from the record. Ascending order is fastest."""
        return Maps(taps, self._record.after(taps))

    @property
    def surface(self) -> np.ndarray:
        """Surface reconstructed from all taps, metres."""
        return self.after(len(self)).surface

    @property
    def truth(self) -> np.ndarray | None:
        """True heights of the scene, metres. None for a robot, or if the file of an object is missing or has changed."""
        return self._record.truth()

    @property
    def x(self) -> np.ndarray:
        """x of the columns of a map, metres."""
        return self._record.axes()[0]

    @property
    def y(self) -> np.ndarray:
        """y of the rows of a map, metres."""
        return self._record.axes()[1]


class Sweep:
    """A recorded sweep, opened by load_sweep(). sweep[3] opens the run of job 3.

    Iteration yields the runs of the finished jobs. Several directories, of sweeps and runs, form one sweep; its `directory`
    is the folder that contains them all.
    """

    def __init__(self, *directories):
        self._directories = [os.fspath(one) for one in directories]
        self._record = _palpate.SweepRecord(self._directories)
        self.directory = self._record.directory()
        self.keys = self._record.keys()
        for note in self._record.notes():
            warnings.warn(note, stacklevel=3)

    def __reduce__(self):
        return Sweep, tuple(map(os.path.abspath, self._directories))

    def __repr__(self):
        return f"<palpate.Sweep {self.directory}: {len(self)} jobs>"

    def _repr_html_(self):
        out = ""
        try:
            jobs = self.table
            names = ["job", *self.keys, *(name for name in ("status", "taps", _main_error(jobs), "footprint_iou")
                                          if name in jobs.dtype.names and name not in self.keys)]
            ended = [int(job) for job in jobs["job"][jobs["status"] == "done"]]
            out = _show.table([(f"{len(ended)} of {len(jobs)} jobs done in {self.directory}",)])
            out += _show.table(jobs[names][:20].tolist(), names)
            if len(jobs) > 20:
                out += _show.table([(f"and {len(jobs) - 20} more",)])
            return out + (_show.image(self[ended[0]].surface, f"surface of job {ended[0]}") if ended else "")
        except Error as trouble:  # A run from any side has no maps.
            return out + _show.table([(trouble.place, trouble.reason)])

    def plot(self, metric=None):
        """Returns a matplotlib figure of a field of the table: one point per finished job and the mean, one column per setting
        (all keys that differ except the seed). Default of `metric`: `rmse_m`, or `rms_surface_distance_m` for runs from any
        side. Raises Error without matplotlib."""
        jobs = self.table
        metric = metric or _main_error(jobs)
        if metric not in jobs.dtype.names or jobs[metric].dtype.kind not in "biuf":
            raise make_error("plot", f"the table has no numeric column '{metric}'", "name a column of sweep.table")
        return _plotted(lambda: _show.draw_sweep(jobs, self.keys, metric))

    def __len__(self):
        return self._record.size()

    def __getitem__(self, job: int) -> Run:
        index = range(len(self))[job]  # as in lists, -1 means the last job
        return Run(self._record.job(index))

    def __iter__(self):
        table = self.table
        for job in table["job"][table["status"] == "done"]:
            yield self[job]

    def experiments(self, retry_failed=False):
        """Yields one Experiment per job of begin_sweep() that has not ended; with `retry_failed`, also per failed job. Close each
        experiment, for example by `with`, before the next job."""
        if len(self._directories) > 1:
            raise make_error("experiments", "this Sweep combines several sweeps", "call experiments() of each single sweep")
        try:
            for job, status in enumerate(self.table["status"].tolist()):
                if status is None or retry_failed and status == "failed":
                    yield Experiment.resume(self._record.job(job), retry_failed)
        finally:
            self._record.write_table()

    @property
    def table(self) -> np.ndarray:
        """Structured array with one row per job, for example for `pandas.DataFrame`: `job`, `id`, the swept keys, and the
        fields of the summary by their dotted names. A job that has not ended has the status None and NaN for numbers."""
        columns = self._record.table()
        if "status" not in dict(columns):  # no job has ended yet
            columns.append(("status", np.array([None] * len(self), dtype=object)))
        return _table((name, _numbers(values) if name in self.keys else values) for name, values in columns)

    def curves(self, metric=None, *, by=None, against="taps", where=None, workers=None, progress=None) -> np.ndarray:
        """Computes curves of groups of jobs, as `palpate curves` does: a structured array with one row per point and group.

        Fields: the swept keys of scene and group; `at`, taps or (`against="robot_seconds"`) seconds; `mean` with `low_95` and
        `high_95`, its 95 % interval, NaN without an interval; `n`, jobs with a value; `units`, seeds; `jobs`, `failed`,
        `unfinished` and `ended` of the group. SI units. Default of `metric`: `rmse_m`, or `rms_surface_distance_m` for runs
        from any side. `by`: one or several keys; default: all varied keys except the seed and the scene. The program computes
        the results after each tap from the records, and stores them. `progress(done, jobs)` is called when jobs are done.
        """
        keys = [by] if isinstance(by, str) else by
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "curves.csv")
            command = [_palpate.program, "curves", *self._directories, "--against", against, "-o", file]
            command += ["--metric", metric] if metric is not None else []
            command += ["--by", ",".join(keys)] if keys else []
            command += ["--where", where] if where is not None else []
            command += ["-j", str(operator.index(workers))] if workers is not None else []
            status, said, _ = _program.conduct(command, progress)
            if status != 0:
                raise make_error("curves", said.removeprefix("command line: "), "", InputError if status == 2 else Error)
            return _table((name, _numbers(values) if isinstance(values, list) else values)
                          for name, values in _program.curve_columns(file, self.keys))

    def importance(self, metric=None, *, where=None) -> np.ndarray:
        """Computes which key matters, as `palpate compare --importance` does: a structured array with one row per key and per
        pair of keys, the most important key first.

        Fields: `keys`, a text with commas, "" for the rest; `share` of the variance between the settings, 0 to 1, with the ends
        `low_95` and `high_95` of its 95 % interval, NaN without an interval; `exact`, False if a Gaussian process approximates
        the shares; `noise`. Default of `metric` as in curves(). Raises InputError, also for fewer than two varied keys.
        """
        rows = _program.importance_rows(self._directories, metric or _main_error(self.table), where)
        return _table((name, [row[name] for row in rows]) for name in rows[0] if name != "metric")

def _plotted(draw):
    try:
        return draw()
    except ImportError as trouble:
        raise make_error("plot", "matplotlib is missing", "install it: apt install python3-matplotlib", Error) from trouble


class Race:
    """A race of settings that tune() ran."""

    def __init__(self, directory):
        self.directory = os.fspath(directory)
        self.best_config = os.path.join(self.directory, "best.yaml")

    def __repr__(self):
        return f"<palpate.Race {self.directory}: {len(self.table)} settings>"

    def _repr_html_(self):
        rows = self.table
        return _show.table(rows.tolist(), rows.dtype.names)

    @property
    def table(self) -> np.ndarray:
        """Structured array with one row per setting: the values of the keys as texts, `seeds` and the mean of the metric. A
        setting that lost has the number of seeds after which it did, its difference to the best one, and p. The row of
        the winner has the gain over the config as it stands on `fresh_seeds`, with its 95 % interval. In SI units."""
        return _table(_program.race_columns(os.path.join(self.directory, "race.csv")))

    @property
    def best(self) -> dict[str, str]:
        """The values of the keys in the best setting."""
        rows = self.table
        names = rows.dtype.names[1:rows.dtype.names.index("seeds")]
        return {name: str(rows[name][rows["is_best"]][0]) for name in names}

    @property
    def sweep(self) -> Sweep:
        """All runs of the race."""
        return Sweep(self.directory)
