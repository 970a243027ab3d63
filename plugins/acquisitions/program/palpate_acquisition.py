# SPDX-License-Identifier: MIT
"""An acquisition as a Python function: maps in, scores out. A file with nothing but

    from palpate_acquisition import acquisition

    @acquisition(reads=["height_std", "object_probability"])
    def score(belief):
        return belief.height_std * (belief.object_probability > 0.3)

is `acquisition: {type: program, command: "python3 my.py"}`: palpate finds this module for the programs that it starts.
Under palpate the file answers from the decorator on, so the function stands last in it; otherwise the decorator returns
the function, for a test to call. It needs NumPy and nothing else.
"""
import io
import json
import os
import sys

import numpy

PROTOCOL = 1
SERVED = "PALPATE_PROGRAM" in os.environ  # palpate has started this program

if SERVED:  # stdout is for scores alone: what anybody prints goes to a file of the run
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)


class Belief:
    """What is believed before a tap. Its attributes are the arrays that `reads` names, float64, with one value per
    candidate unless the table of framework/docs/strategies.md says otherwise, and

    tap         number of the tap that is chosen, from 1
    seed        of the run
    rows, columns  of the grid of candidates, row after row (taps from above): map.reshape(belief.rows, belief.columns)
    area, desk  {"width", "depth"}, and the desk's height, metres

    A test makes one with what its function reads: Belief(uncertainty=numpy.ones(4), tap=5).
    """

    def __init__(self, **values):
        self.__dict__.update(values)

    def __getattr__(self, name):
        if SERVED:
            raise AttributeError(f"the belief has no {name}: add it to reads=[...]")
        missing = "seed=1, tap=1" if name == "random" else f"{name}=..."
        raise AttributeError(f"this belief was made without {name}: add {missing} to its Belief(...)")

    @property
    def random(self):
        """A numpy.random.Generator of this tap and seed: the same each time, so that a run can be carried on."""
        return numpy.random.default_rng([self.seed, self.tap])


def acquisition(reads):
    """Makes a function an acquisition. `reads` is a list of names, written out: palpate looks for it in the file. The
    function takes a Belief and returns one finite number per candidate; the highest is tapped."""

    def decorate(function):
        if SERVED and function.__module__ == "__main__":
            serve(function, reads)
            sys.exit()
        return function

    return decorate


def serve(function, reads):
    """Answers every ask until stdin ends."""
    for line in iter(sys.stdin.buffer.readline, b""):
        ask = json.loads(line)
        if ask["palpate"] != PROTOCOL:
            sys.exit(f"{__file__} has protocol {PROTOCOL}, but palpate has {ask['palpate']}: remove that file")
        sent = [array["name"] for array in ask["arrays"]]
        if sent != list(reads):
            sys.exit(f"the config has 'reads: {', '.join(sent)}', but {function.__name__} has reads={list(reads)}")
        arrays = {array["name"]: read_npy(sys.stdin.buffer.read(array["bytes"])) for array in ask["arrays"]}
        scores = numpy.asarray(function(Belief(**ask, **arrays)), dtype="<f8")
        if scores.shape != (ask["candidates"],):
            sys.exit(f"{function.__name__} returned an array of shape {scores.shape}, not ({ask['candidates']},)")
        answer = io.BytesIO()  # to a pipe NumPy does not write
        numpy.save(answer, numpy.ascontiguousarray(scores))
        answers.write(answer.getvalue())
        answers.flush()


def read_npy(data):
    return numpy.load(io.BytesIO(data), allow_pickle=False)
