# SPDX-License-Identifier: MIT
"""Active touch from Python: reads runs, runs experiments, and chooses taps for your own arm.

    import palpate

    run = palpate.load("runs/default/b1c26ab1ef4f")     # or run = palpate.run("configs/default.yaml", "taps=20")
    run.taps["height"], run.surface, run.after(5).probability

    with palpate.Experiment("configs/default.yaml", "taps=40", seed=3) as experiment:
        while tap := experiment.ask():
            height, force = my_arm.tap(tap.x, tap.y)
            experiment.tell(height, force)

Lengths are in metres, forces in newtons, times in seconds. A map has one row per y and one column per x of the candidates:
map[i, k] is at (x[k], y[i]), from the lower left corner of the area.

The same config and seed give the same bytes as the program `palpate`.
"""

from __future__ import annotations

import atexit as _atexit
import operator as _operator
import os as _os

from . import _palpate, _program
from ._errors import Error, InputError, make_error as _error
from ._experiment import Belief, Experiment
from ._palpate import Tap
from ._records import Maps, Race, Run, Sweep

__all__ = ["Belief", "Error", "Experiment", "InputError", "Maps", "Race", "Run", "Sweep", "Tap", "begin_sweep", "describe", "load", "load_sweep", "run", "sweep", "tune"]
__version__ = _palpate.version

for _one in (Belief, Experiment, Maps, Race, Run, Sweep):
    _one.__module__ = __name__  # help() and pickle then use the public module name

_atexit.register(_palpate.end_calls)  # at exit, Python waits for calls in other threads

Tap.__doc__ = """A tap to make.

`number`: from 1. `x`, `y`: position, metres. `candidate`: index among the candidates, row by row. `source`: origin of the
choice, "initial", "acquisition", "fallback" or "caller". `why`: reason for a fallback. `score`: None for an initial tap.
"""


def load(directory, runs="runs") -> Run:
    """Returns the run in a directory, or in `runs` by its name: "NAME", "NAME@latest". Raises Error if missing or damaged."""
    return Run(_palpate.found(_os.fspath(directory), _os.fspath(runs)))


def load_sweep(directory, runs="runs") -> Sweep:
    """Returns the sweep in a directory, or in `runs` by its name. A list of sweeps and runs, and all runs of a name, are read
    as one sweep. Raises Error if a record is missing or damaged."""
    words = [directory] if isinstance(directory, (str, _os.PathLike)) else directory
    return Sweep(*_palpate.found_sweep([_os.fspath(one) for one in words], _os.fspath(runs)))


def describe() -> dict[str, tuple[str, str]]:
    """Returns unit and meaning of each field of `Run.taps`, by name. `*` stands for names that depend on the run."""
    return {name: (unit, meaning) for name, unit, meaning in _palpate.tap_fields()}


def run(config, *overrides, runs="runs", force=False, progress=None, **settings) -> Run:
    """Runs an experiment, as `palpate run CONFIG KEY=VALUE ...` does, and loads it.

    `settings` are overrides of keys that are Python names: seed=3 is "seed=3". A finished run of this build is loaded and
    not repeated, unless `force` moves it aside. `progress(n)` is called after every tap. Ctrl-C interrupts the run;
    `palpate resume` resumes it.
    """
    return Run(_palpate.run(_os.fspath(config), _program.override_texts(overrides, settings), _os.fspath(runs), force, progress))


def sweep(config, *axes, runs="runs", workers=None, progress=None, **settings) -> Sweep:
    """Runs all jobs of a sweep, as `palpate sweep CONFIG KEY=V1,V2 ...` does, and loads it: `sweep(config, "seed=range(0,10)")`.

    `settings` are axes of keys that are Python names: a list is swept, another value is set. The program runs the jobs in
    processes of its own, `workers` at a time (default: the number of cores). An existing sweep is resumed.
    `progress(done, jobs)` is called when jobs end. Ctrl-C interrupts the sweep after the present taps; the same call
    resumes it. Failed jobs are in the table. Raises Error, also if jobs have not ended.
    """
    words = [*axes, *(f"{key}={_program.values_text(value)}" for key, value in settings.items())]
    workers = workers if workers is None else _operator.index(workers)
    if workers is not None and workers < 1:
        raise _error("sweep", f"workers is {workers}", "give at least 1")
    directory = _palpate.begin_sweep(_os.fspath(config), words, _os.fspath(runs))
    command = [_palpate.program, "resume", directory]
    if workers is not None:
        command += ["-j", str(workers)]
    status, said, _ = _program.conduct(command, progress)
    made = Sweep(directory)
    # Status 1 means that a job, an expectation of the config, or the sweep itself failed.
    if status not in (0, 1) or status == 1 and None in made.table["status"].tolist():
        raise _error(directory, f"the sweep ended with status {status}: {said}", "repeat the call to resume it", Error)
    return made


def tune(config, keys, *, metric, cost=None, jobs=None, time=None, within=None, fresh=None, over=None, where=None, runs="runs",
         workers=None, progress=None) -> Race:
    """Finds the best setting of some keys, as `palpate tune CONFIG KEY=RANGE ... --metric FIELD --jobs N` does.

    `keys`: a dict of keys to a list, or to a text such as "log_uniform(5mm,10cm)" or "logspace(1cm,5cm,8)"; another value
    applies to all runs: {"seed": 1000}. `jobs`: budget in runs, or `time`: in wall time, "10min". `within`: "0.5mm".
    `over`: a list of scenes. Further arguments as in sweep(); progress(runs, jobs). An existing race is resumed. Raises Error,
    also if runs have not ended.
    """
    words = [f"{key}={_program.values_text(value)}" for key, value in keys.items()]
    options = {"--metric": metric, "--cost": cost, "--jobs": jobs, "--time": time, "--within": within, "--fresh": fresh, "--where": where,
               "--over": over if over is None or isinstance(over, str) else ",".join(over), "--runs": _os.fspath(runs), "-j": workers}
    words += [text for name, value in options.items() if value is not None for text in (name, str(value))]
    status, said, directory = _program.conduct([_palpate.program, "tune", _os.fspath(config), *words], progress)
    if status == 2:
        raise _error("tune", said, "")
    if status != 0:
        raise _error("tune", f"the race ended with status {status}: {said}", "repeat the call to resume it", Error)
    return Race(directory)


def begin_sweep(config, *axes, labels=None, runs="runs", **settings) -> Sweep:
    """Creates a sweep whose taps the caller makes, job by job in its experiments(). Makes no tap.

    `axes` and `settings` as in sweep(), and the backend as in Experiment. `labels`: names of the caller's own strategies.
    They are swept as `backend.label`; `experiment.label` is the label of a job. An existing sweep is resumed.
    """
    words = [*axes, *(f"{key}={_program.values_text(value)}" for key, value in settings.items()), "backend.type=caller"]
    if labels is not None:
        names = [labels] if isinstance(labels, str) else list(labels)
        if not names or not all(isinstance(one, str) and one for one in names):
            raise _error("labels", "has a value that is not a name", "give non-empty texts")
        # The labels become a YAML list of texts in single quotes. In such a text, only the single quote itself is
        # special.
        texts = ("'" + one.replace("'", "''") + "'" for one in names)
        words += [f"backend.label=[{', '.join(texts)}]"]
    return Sweep(_palpate.begin_sweep(_os.fspath(config), words, _os.fspath(runs)))
