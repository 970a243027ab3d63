# SPDX-License-Identifier: MIT
"""Active touch from Python: read runs, run experiments, and be asked where to tap.

    import palpate

    run = palpate.load("runs/default/b1c26ab1ef4f")     # or run = palpate.run("configs/default.yaml", "taps=20")
    run.taps["height"], run.surface, run.after(5).probability

    with palpate.Experiment("configs/default.yaml", "taps=40", seed=3) as experiment:
        while tap := experiment.ask():
            height, force = my_arm.tap(tap.x, tap.y)
            experiment.tell(height, force)

All lengths are in metres, forces in newtons, times in seconds. A map has a row for each y and a column for each x of the
candidates: map[i, k] lies at (x[k], y[i]), from the lower left corner of the area.

What is computed is what the program `palpate` computes: the same config and seed give the same bytes.
"""

from __future__ import annotations

import atexit as _atexit
import json as _json
import operator as _operator
import os as _os
import tempfile as _tempfile
import warnings as _warnings

import numpy as _np

from . import _palpate, _program, _show
from ._palpate import Error, InputError, Tap

__all__ = ["Belief", "Error", "Experiment", "InputError", "Maps", "Run", "Sweep", "Tap", "begin_sweep", "describe", "load", "load_sweep", "run", "sweep"]
__version__ = _palpate.version

_atexit.register(_palpate.end_calls)  # other threads may be computing

Error.__doc__ = """What went wrong in one line: `place`, `reason` and `remedy` (perhaps "") say where, what and how."""
InputError.__doc__ = """An Error by input that can be mended, a ValueError as well: an argument, a config, a file. What failed
in a run, as a robot that stopped, is an Error alone."""
Tap.__doc__ = """A tap to make.

`number`: from 1. `x`, `y`: the place, metres. `candidate`: its index among the candidates, row by row. `source`: who
chose it, "initial", "acquisition", "fallback" or "caller"; `why`: of a fallback. `score`: None of an initial tap.
"""


def _overrides(overrides, settings):
    return [*overrides, *(f"{key}={_program.value_text(value)}" for key, value in settings.items())]


def _array(values):
    """An array of truth values, of whole numbers, of numbers with NaN for None, or of objects."""
    kinds = {type(value) for value in values}
    if kinds in ({bool}, {int}):
        return _np.array(values)
    return _np.array(values, dtype=float if kinds <= {int, float, type(None)} else object)


def _table(columns):
    """A structured array of columns: (name, array or list)."""
    columns = [(name, _array(values) if isinstance(values, list) else values) for name, values in columns]
    out = _np.empty(len(columns[0][1]), dtype=[(name, values.dtype) for name, values in columns])
    for name, values in columns:
        out[name] = values
    return out


def _main_error(jobs):
    """The name of the root mean square error of whole reconstructions in a sweep's table: `rmse_m`, or
    `rms_surface_distance_m` where only runs from any side have ended."""
    def has(name):
        return name in jobs.dtype.names and jobs[name].dtype.kind == "f" and bool(_np.isfinite(jobs[name]).any())
    return "rms_surface_distance_m" if has("rms_surface_distance_m") and not has("rmse_m") else "rmse_m"


def _numbers(texts):
    """An array of numbers where all texts are numbers, else the texts."""
    for kind in (int, float):
        try:
            return _np.array([kind(text) for text in texts])
        except ValueError:
            pass
    return texts


class Maps:
    """What was believed after `taps` taps, over the candidates; every map is an array of rows x columns.

    `height_mean`, `height_standard_deviation`: of the height, metres (of `surface: two_part` of that of an object).
    `uncertainty`: u, the variance relative to the prior, 0 to 1. `weight`: w. `probability`: p, that an object is there.
    `surface`: as reconstructed, metres.
    """

    __slots__ = ("taps", "height_mean", "height_standard_deviation", "uncertainty", "weight", "probability", "surface")

    def __init__(self, taps, maps):
        self.taps = taps
        for name, value in maps.items():
            setattr(self, name, value)


class Run:
    """A recorded run: load() opens one. Nothing is read before it is asked for, but for the taps.

    Threads may share it. Another process, forked or by pickle, opens it for itself.
    """

    def __init__(self, directory):
        self.directory = _os.fspath(directory)
        self._opened = _palpate.Record(self.directory)
        self.id = self._record.id()

    def __reduce__(self):  # another process opens it for itself
        return Run, (_os.path.abspath(self.directory),)

    @property
    def _record(self):
        if not self._opened.is_here():  # in the child of a fork
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
        except Error as trouble:  # a run from any side has no maps; a damaged one may have nothing
            return _show.table([*rows, (trouble.place, trouble.reason)])

    def plot(self):
        """A figure of matplotlib: the surface with its taps, its standard deviation and, where the truth is known, its
        error. Raises Error where matplotlib is missing, and for a run from any side."""
        return _plotted(lambda: _show.draw_run(self))

    def __len__(self):
        return self._record.size()

    @property
    def config(self) -> dict:
        """As it was run, every value resolved; quantities are texts with their units."""
        return self._record.config()

    @property
    def summary(self) -> dict | None:
        """What summary.json has, nested by its dots; None of a run that has not ended."""
        return self._record.summary()

    @property
    def manifest(self) -> dict | None:
        """Program, build, plugins, command line; None where nothing is recorded of them."""
        return self._record.manifest()

    @property
    def taps(self) -> _np.ndarray:
        """A structured array of a row a tap; describe() says what its fields mean. Numbers that a tap lacks are NaN.

        `on_object` is what a contact was taken for when it was made: `summary["relabelled"]` names those that are read
        otherwise at the end.
        """
        return _table(self._record.taps())

    def after(self, taps: int) -> Maps:
        """The models after the first `taps` taps, computed again from the record; cheapest in ascending order."""
        return Maps(taps, self._record.after(taps))

    @property
    def surface(self) -> _np.ndarray:
        """The surface as reconstructed from all taps, metres."""
        return self.after(len(self)).surface

    @property
    def truth(self) -> _np.ndarray | None:
        """Heights of the scene that was tapped, metres; None where another world was tapped, as by a robot, or where the file
        of an object is gone or another by now."""
        return self._record.truth()

    @property
    def x(self) -> _np.ndarray:
        """Of the columns of a map, metres."""
        return self._record.axes()[0]

    @property
    def y(self) -> _np.ndarray:
        """Of the rows of a map, metres."""
        return self._record.axes()[1]


class Sweep:
    """A recorded sweep: load_sweep() opens one. sweep[3] is the run of its job 3, opened when it is asked for.

    It iterates over the runs of the jobs that are done. Several directories, of sweeps and runs, are one sweep, whose
    `directory` is the folder that has them all.
    """

    def __init__(self, *directories):
        self._directories = [_os.fspath(one) for one in directories]
        self._record = _palpate.SweepRecord(self._directories)
        self.directory = self._record.directory()
        self.keys = self._record.keys()
        for note in self._record.notes():
            _warnings.warn(note, stacklevel=3)

    def __reduce__(self):
        return Sweep, tuple(map(_os.path.abspath, self._directories))

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
        except Error as trouble:  # runs from any side have no maps
            return out + _show.table([(trouble.place, trouble.reason)])

    def plot(self, metric=None):
        """A figure of matplotlib: a field of the table, of each finished job, in a column per setting (all keys that differ
        but the seed), with its mean. `metric` None: `rmse_m`, or `rms_surface_distance_m` for runs from any side. Raises
        Error where matplotlib is missing."""
        jobs = self.table
        metric = metric or _main_error(jobs)
        if metric not in jobs.dtype.names or jobs[metric].dtype.kind not in "biuf":
            raise _error("plot", f"the table has no numeric column '{metric}'", "name a column of sweep.table")
        return _plotted(lambda: _show.draw_sweep(jobs, self.keys, metric))

    def __len__(self):
        return self._record.size()

    def __getitem__(self, job: int) -> Run:
        index = range(len(self))[job]  # as lists take it, -1 for the last
        return Run(self._record.job(index))

    def __iter__(self):
        table = self.table
        for job in table["job"][table["status"] == "done"]:
            yield self[job]

    def experiments(self, retry_failed=False):
        """Of a sweep of begin_sweep(): the Experiment of each job that has not ended, one after the other. Close each, as
        `with` does, before the next. `retry_failed` resumes failed jobs, too."""
        if len(self._directories) > 1:
            raise _error("experiments", "this Sweep combines several sweeps", "call experiments() of each single sweep")
        try:
            for job, status in enumerate(self.table["status"].tolist()):
                if status is None or retry_failed and status == "failed":
                    yield Experiment.resume(self._record.job(job), retry_failed)
        finally:
            self._record.write_table()

    @property
    def table(self) -> _np.ndarray:
        """A structured array of a row a job, which `pandas.DataFrame` takes: `job`, `id`, the swept keys, the fields of
        the summary by their dotted names. A job that has not ended has the status None and no numbers (NaN)."""
        columns = self._record.table()
        if "status" not in dict(columns):  # before the first job has ended
            columns.append(("status", _np.array([None] * len(self), dtype=object)))
        return _table((name, _numbers(values) if name in self.keys else values) for name, values in columns)

    def curves(self, metric=None, *, by=None, against="taps", where=None, workers=None, progress=None) -> _np.ndarray:
        """Groups of jobs over their taps, as `palpate curves` has them: a structured array of a row per point and group.

        Its fields: the swept keys of scene and group; `at`, taps or (`against="robot_seconds"`) seconds; `mean` with
        `low_95` and `high_95`, its 95 % interval, NaN where there is none; `n`, jobs with a value; `units`, seeds; `jobs`,
        `failed`, `unfinished` and `ended` of the group. SI units. `metric` None: `rmse_m`, or `rms_surface_distance_m` for runs
        from any side. `by`: one key or several; None: all that vary but the seed
        and the scene. What the jobs had come to after each tap is computed from their records by the program, and kept;
        `progress(done, jobs)` is called as jobs are done.
        """
        keys = [by] if isinstance(by, str) else by
        with _tempfile.TemporaryDirectory() as folder:
            file = _os.path.join(folder, "curves.csv")
            command = [_palpate.program, "curves", *self._directories, "--against", against, "-o", file]
            command += ["--metric", metric] if metric is not None else []
            command += ["--by", ",".join(keys)] if keys else []
            command += ["--where", where] if where is not None else []
            command += ["-j", str(_operator.index(workers))] if workers is not None else []
            status, said = _program.conduct(command, progress)
            if status != 0:
                raise _error("curves", said.removeprefix("command line: "), "", InputError if status == 2 else Error)
            return _table((name, _numbers(values) if isinstance(values, list) else values)
                          for name, values in _program.curve_columns(file, self.keys))


def load(directory, runs="runs") -> Run:
    """The run in a directory, or in `runs` by its name: "NAME", "NAME@latest". Raises Error for what is none, or damaged."""
    return Run(_palpate.found(_os.fspath(directory), _os.fspath(runs)))


def load_sweep(directory, runs="runs") -> Sweep:
    """The sweep in a directory, or in `runs` by its name. A list of them, of sweeps and runs, is one sweep, and so are all
    runs of a name that has no sweep. Raises Error for what is none, or damaged."""
    words = [directory] if isinstance(directory, (str, _os.PathLike)) else directory
    return Sweep(*_palpate.found_sweep([_os.fspath(one) for one in words], _os.fspath(runs)))


def describe() -> dict[str, tuple[str, str]]:
    """Unit and meaning of each field of `Run.taps`, by its name. `*` stands for names that only a run knows."""
    return {name: (unit, meaning) for name, unit, meaning in _palpate.tap_fields()}


def run(config, *overrides, runs="runs", force=False, progress=None, **settings) -> Run:
    """Runs an experiment, as `palpate run CONFIG KEY=VALUE ...` does, and loads it.

    `settings` are overrides of keys that are Python names: seed=3 is "seed=3". A finished run of this build is loaded,
    not run again; `force` moves it aside. `progress(n)` is called after every tap. Ctrl-C ends the run; it can be carried
    on by `palpate resume`.
    """
    return Run(_palpate.run(_os.fspath(config), _overrides(overrides, settings), _os.fspath(runs), force, progress))


def sweep(config, *axes, runs="runs", workers=None, progress=None, **settings) -> Sweep:
    """Runs all jobs of a sweep, as `palpate sweep CONFIG KEY=V1,V2 ...` does, and loads it: `sweep(config, "seed=range(0,10)")`.

    `settings` are axes of keys that are Python names: a list is swept, another value is set. The jobs run in the program,
    `workers` at a time (else as many as there are cores), and not in this process. A sweep that exists is carried on.
    `progress(done, jobs)` is called as jobs end. Ctrl-C ends it after the taps under way; the same call carries it on.
    Failed jobs are in the table. Raises Error, also where jobs have not ended.
    """
    words = [*axes, *(f"{key}={_program.values_text(value)}" for key, value in settings.items())]
    workers = workers if workers is None else _operator.index(workers)
    if workers is not None and workers < 1:
        raise _error("sweep", f"workers is {workers}", "give at least 1")
    directory = _palpate.begin_sweep(_os.fspath(config), words, _os.fspath(runs))
    command = [_palpate.program, "resume", directory]
    if workers is not None:
        command += ["-j", str(workers)]
    status, said = _program.conduct(command, progress)
    made = Sweep(directory)
    # 1: jobs failed, what the config expects does not hold, or the sweep itself did.
    if status not in (0, 1) or status == 1 and None in made.table["status"].tolist():
        raise _error(directory, f"the sweep ended with status {status}: {said}", "repeat the call to resume it", Error)
    return made


def begin_sweep(config, *axes, labels=None, runs="runs", **settings) -> Sweep:
    """Makes a sweep whose taps the caller makes, and runs nothing: its experiments() ask for them, job by job.

    `axes` and `settings` as in sweep(), and the backend as in Experiment. `labels`: names of the caller's own strategies,
    which are swept, too, as `backend.label`; `experiment.label` has that of a job. A sweep that exists is carried on.
    """
    words = [*axes, *(f"{key}={_program.values_text(value)}" for key, value in settings.items()), "backend.type=caller"]
    if labels is not None:
        names = [labels] if isinstance(labels, str) else list(labels)
        if not names or not all(isinstance(one, str) and one for one in names):
            raise _error("labels", "has a value that is not a name", "give non-empty texts")
        # A list of texts in YAML's single quotes, within which nothing has a meaning of its own.
        texts = ("'" + one.replace("'", "''") + "'" for one in names)
        words += [f"backend.label=[{', '.join(texts)}]"]
    return Sweep(_palpate.begin_sweep(_os.fspath(config), words, _os.fspath(runs)))


class Belief:
    """What an Experiment believes now: maps of rows x columns, each as of the moment at which it is asked for.

    A map stays as it is, whatever is told later and when the experiment is closed. It is read-only: to change it would
    change nothing. To look changes neither taps nor record.
    """

    __slots__ = ("_asked",)

    def __init__(self, asked):
        self._asked = asked

    @property
    def x(self) -> _np.ndarray:
        """Of the columns, metres."""
        return self._asked.xs()

    @property
    def y(self) -> _np.ndarray:
        """Of the rows, metres."""
        return self._asked.ys()

    @property
    def uncertainty(self) -> _np.ndarray:
        """u: variance of the height relative to its prior, 0 to 1."""
        return self._asked.uncertainty()

    @property
    def weight(self) -> _np.ndarray:
        """w: mean of the label GP."""
        return self._asked.weight()

    @property
    def probability(self) -> _np.ndarray:
        """p: the probability that an object is there."""
        return self._asked.probability()

    @property
    def height_mean(self) -> _np.ndarray:
        """Mean of the height, metres."""
        return self._asked.height_mean()

    @property
    def height_variance(self) -> _np.ndarray:
        """Its variance, square metres."""
        return self._asked.height_variance()


class Experiment:
    """An experiment whose taps the caller makes: ask() says where, tell() takes what came of it.

    The config's backend is replaced by `caller`; of its scene only area and desk count, unless
    `backend.scene_is_truth=true` says that its objects are what is tapped: then errors are known. The record is that of
    `palpate run`, in `runs`: it can be replayed, reported, and carried on by Experiment.resume(). As a context manager it
    is closed at the end, and finished before, unless by an exception or while a tap is still to be told (after `break`):
    then it can be resumed. Threads may share it: one call at a time is at work. The child of a fork may not use it.
    """

    def __init__(self, config, *overrides, runs="runs", force=False, **settings):
        all_overrides = _overrides(overrides, settings) + ["backend.type=caller"]
        self._asked = _palpate.Asked(_os.fspath(config), all_overrides, _os.fspath(runs), force)
        self.directory = self._asked.directory()

    @classmethod
    def resume(cls, directory, retry_failed=False, force=False) -> "Experiment":
        """Carries on a run that has not ended. A tap that was asked for and never told counts as one of outcome unknown."""
        self = cls.__new__(cls)
        self._asked = _palpate.Asked(_os.fspath(directory), retry_failed, force)
        self.directory = self._asked.directory()
        return self

    def __repr__(self):
        return f"<palpate.Experiment {self.directory}>"

    def _repr_html_(self):
        try:
            rows = [("experiment", self.directory), ("taps", len(self)), ("finished", self.finished)]
            return _show.table(rows) + _show.image(self.belief.height_mean, "mean of the height")
        except Error as trouble:  # it is closed
            return _show.table([("experiment", self.directory), (trouble.place, trouble.reason)])

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self._asked.close(kind is None)

    @property
    def label(self) -> str:
        """`backend.label`, the name of the caller's strategy; "" where the config has none."""
        return self._asked.label()

    @property
    def belief(self) -> Belief:
        """What is believed now."""
        return Belief(self._asked)

    @property
    def finished(self) -> bool:
        """Whether the run has ended: ask() gives no further tap."""
        return self._asked.finished()

    def __len__(self):
        """Taps told so far."""
        return self._asked.taps()

    def ask(self, scores=None) -> Tap | None:
        """The tap to make next; the same until tell(). None when the run is over.

        `scores`: one value a candidate, as a map or row by row; above 0 where a tap is worth something. The highest is
        tapped, under the framework's rules about ties, repeats and the fallback, in the place of the config's strategy.
        """
        return self._asked.ask(None if scores is None else _np.asarray(scores, dtype=float))

    def tell(self, height=None, force=None, seconds=None, *, outcome=None, reason="", ends_run=False) -> None:
        """What came of the tap that was asked for.

        `height`: of the touched point, metres; `force` at contact, newtons; `seconds` that it took. Without a height an
        `outcome` says why: "no_contact", "unreachable", "timeout" or "aborted", with a `reason` for people. `ends_run`:
        nobody may tap before somebody has seen to the robot; the run fails, and resume(retry_failed=True) carries it on.

        Raises InputError, a ValueError, for a value that no arm can have measured: a height that is not within 1 cm below
        desk - `backend.overrun` to desk + `backend.hover` (in metres; 4 cm below to 13.5 cm above the desk by default), a
        force outside 0 to 1000 N, seconds outside 0 to 86400, NaN. Nothing is recorded then, and the tap is still to be told.
        """
        if outcome is None:
            if height is None:
                raise _error("tell", "neither a height nor an outcome is given", 'give a height, or outcome="no_contact"')
            outcome = "contact"
        elif (outcome == "contact") != (height is not None):
            raise _error("tell", "a height is valid only with the outcome contact", "leave one of the two out")
        self._asked.tell(outcome, float(height or 0.0), float(force or 0.0), float(seconds or 0.0), reason, ends_run)

    def finish(self) -> dict:
        """Ends the run, its budget reached or not, and returns its summary."""
        return _json.loads(self._asked.finish())

    def close(self) -> None:
        """Closes the record. An unfinished run can be resumed."""
        self._asked.close(False)


def _plotted(draw):
    try:
        return draw()
    except ImportError as trouble:
        raise _error("plot", "matplotlib is missing", "install it: apt install python3-matplotlib", Error) from trouble


def _error(place, reason, remedy, kind=InputError):
    error = kind(f"{place}: {reason}" + (f", {remedy}" if remedy else ""))
    error.place, error.reason, error.remedy = place, reason, remedy
    return error
