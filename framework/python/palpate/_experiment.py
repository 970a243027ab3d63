# SPDX-License-Identifier: MIT
# mypy: ignore-errors
"""Experiments whose taps the caller makes."""

from __future__ import annotations

import json
import os

import numpy as np

from . import _palpate, _program, _show
from ._errors import Error, make_error
from ._palpate import Tap


class Belief:
    """Maps of the present belief of an Experiment, rows x columns.

    Each map is a read-only copy, which later taps do not change. Reading a map changes neither taps nor record.
    """

    __slots__ = ("_run",)

    def __init__(self, run):
        self._run = run

    @property
    def x(self) -> np.ndarray:
        """x of the columns, metres."""
        return self._run.xs()

    @property
    def y(self) -> np.ndarray:
        """y of the rows, metres."""
        return self._run.ys()

    @property
    def uncertainty(self) -> np.ndarray:
        """u: variance of the height relative to its prior, 0 to 1."""
        return self._run.uncertainty()

    @property
    def weight(self) -> np.ndarray:
        """w: mean of the label GP."""
        return self._run.weight()

    @property
    def probability(self) -> np.ndarray:
        """p: probability of an object at the position."""
        return self._run.probability()

    @property
    def height_mean(self) -> np.ndarray:
        """Mean of the height, metres."""
        return self._run.height_mean()

    @property
    def height_variance(self) -> np.ndarray:
        """Variance of the height, square metres."""
        variance = np.square(self._run.height_std())
        variance.setflags(write=False)
        return variance

    @property
    def lines(self) -> np.ndarray:
        """Lines among which the next tap is chosen, M x 7: start, unit direction and length, metres. From any side, they are
        drawn before each tap; the maps above then have the shape (M,)."""
        return self._run.lines()

    def values(self, quantity) -> np.ndarray:
        """Values of any quantity of the belief, such as "surface_std", one per line."""
        return self._run.values(quantity)


class Experiment:
    """An experiment whose taps the caller makes: ask() returns the next tap, tell() takes its result.

    The backend `caller` replaces that of the config. Of the scene, only area and desk are used. With
    `backend.scene_is_truth=true` the scene's objects are the truth, and errors are computed. The record, in `runs`, is like
    that of `palpate run`: it can be replayed, reported, and resumed by Experiment.resume().

    A `with` block closes the experiment at its end. It finishes the run first, unless an exception is raised or a tap is
    pending, such as after `break`. Threads may share the experiment; calls run one at a time. A forked child may not use it.
    """

    def __init__(self, config, *overrides, runs="runs", force=False, **settings):
        all_overrides = _program.override_texts(overrides, settings) + ["backend.type=caller"]
        self._run = _palpate.AskTellRun(os.fspath(config), all_overrides, os.fspath(runs), force)
        self.directory = self._run.directory()

    @classmethod
    def resume(cls, directory, retry_failed=False, force=False) -> "Experiment":
        """Resumes a run that has not ended. A pending tap is recorded with the outcome unknown."""
        self = cls.__new__(cls)
        self._run = _palpate.AskTellRun(os.fspath(directory), retry_failed, force)
        self.directory = self._run.directory()
        return self

    def __repr__(self):
        return f"<palpate.Experiment {self.directory}>"

    def _repr_html_(self):
        try:
            rows = [("experiment", self.directory), ("taps", len(self)), ("finished", self.finished)]
            return _show.table(rows) + _show.image(self.belief.height_mean, "mean of the height")
        except Error as trouble:  # The experiment is closed.
            return _show.table([("experiment", self.directory), (trouble.place, trouble.reason)])

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self._run.close(kind is None)

    @property
    def label(self) -> str:
        """`backend.label`, the name of the caller's strategy; "" without a label."""
        return self._run.label()

    @property
    def belief(self) -> Belief:
        """The present belief."""
        return Belief(self._run)

    @property
    def finished(self) -> bool:
        """Whether the run has ended, so that ask() returns None."""
        return self._run.finished()

    def __len__(self):
        """Returns the number of taps with a result."""
        return self._run.taps()

    def ask(self, scores=None) -> Tap | None:
        """Returns the next tap. Repeated calls return the same tap until tell(). Returns None if the run has ended.

        `scores`: one value per candidate, as a map or row by row; useful taps have values above 0. They replace the scores of
        the config's acquisition. The candidate with the highest score is tapped, and the config's rules for ties, repeats
        and the fallback apply.
        """
        return self._run.ask(None if scores is None else np.asarray(scores, dtype=float))

    def tell(self, height=None, force=None, seconds=None, *, distance=None, contacts=None, outcome=None, reason="",
             ends_run=False) -> None:
        """Takes the result of the tap that ask() returned.

        `height`: of the contact, metres; `force` at the contact, newtons; `seconds`: duration. From any side, `distance` along
        the line replaces the height; `contacts`, a list whose first item has the touched point as "position", can be added or
        replace it. A tap without a contact has an `outcome`: "no_contact", "unreachable", "timeout" or "aborted", and a
        `reason` in words. `ends_run`: a person has to check the robot before the next tap. The run fails, and
        resume(retry_failed=True) resumes it.

        Raises InputError, a ValueError, for a value that no arm can have measured: a height outside 1 cm below desk -
        `backend.overrun` to desk + `backend.hover` (in metres; 4 cm below to 13.5 cm above the desk by default), a distance
        outside the line, a force outside 0 to 1000 N, seconds outside 0 to 86400, or NaN. Then nothing is recorded, and the
        tap stays pending.
        """
        point = contacts[0]["position"] if contacts else None
        has_contact = height is not None or point is not None
        if outcome is None:
            if not has_contact and distance is None:
                raise make_error("tell", "neither a height nor an outcome is given", 'give a height, or outcome="no_contact"')
            outcome = "contact"
        elif (outcome == "contact") != has_contact and (outcome != "contact" or distance is None):
            raise make_error("tell", "a height is valid only with the outcome contact", "leave one of the two out")
        self._run.tell(outcome, height, distance, point, float(force or 0.0), float(seconds or 0.0), reason, ends_run)

    def finish(self) -> dict:
        """Ends the run, also before its budget is spent, and returns its summary."""
        return json.loads(self._run.finish())

    def close(self) -> None:
        """Closes the record. An unfinished run can be resumed."""
        self._run.close(False)
