# SPDX-License-Identifier: MIT
"""An acquisition as a Python function, from arrays to scores. A file that contains only

    from palpate_acquisition import acquisition

    @acquisition(reads=["height_std", "object_probability"])
    def score(belief):
        return belief.height_std * (belief.object_probability > 0.3)

is used by `acquisition: {type: program, command: "python3 my.py"}`; palpate adds this module to the path of the programs
that it starts. Under palpate the decorator answers requests and does not return, so the function must be last in the
file. Otherwise the decorator returns the function, and tests can call it. The module needs only NumPy.
"""
import io
import json
import os
import sys

import numpy

PROTOCOL = 1
SERVED = "PALPATE_PROGRAM" in os.environ  # palpate has started this program

if SERVED:  # stdout is only for scores, so other output goes to a file of the run
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)


class Belief:
    """State of the models before a tap. The attributes are the arrays that `reads` names: float64, one value per
    candidate unless the table of framework/docs/strategies.md says otherwise. Further attributes:

    tap         number of the tap to choose, from 1
    seed        seed of the run
    rows, columns  of the grid of candidates, row by row (taps from above): map.reshape(belief.rows, belief.columns)
    area, desk  {"width", "depth"}, and height of the desk, metres

    A test creates one with the attributes that its function reads: Belief(uncertainty=numpy.ones(4), tap=5).
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
        """A numpy.random.Generator that depends only on tap and seed, so that resumed runs draw the same numbers."""
        return numpy.random.default_rng([self.seed, self.tap])


def acquisition(reads):
    """Makes a function an acquisition. `reads` is a literal list of names, because palpate reads it from the text of the
    file. The function takes a Belief and returns one finite number per candidate; the highest one is tapped."""

    def decorate(function):
        if SERVED and function.__module__ == "__main__":
            serve(function, reads)
            sys.exit()
        return function

    return decorate


def serve(function, reads):
    """Answers requests until stdin ends."""
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
        answer = io.BytesIO()  # NumPy cannot write an array to a pipe.
        numpy.save(answer, numpy.ascontiguousarray(scores))
        answers.write(answer.getvalue())
        answers.flush()


def read_npy(data):
    return numpy.load(io.BytesIO(data), allow_pickle=False)
