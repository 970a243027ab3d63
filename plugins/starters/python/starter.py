"""How much one wants to tap each candidate: where the height is unknown and an object is probable. Arrays and their
units: framework/docs/strategies.md of palpate."""
import numpy

from palpate_acquisition import acquisition

TRUST = 0.5  # in the probability of an object: 0 taps wherever the height is unknown


@acquisition(reads=["uncertainty", "object_probability"])  # last in the file: from here on it answers
def score(belief):
    return numpy.sqrt(belief.uncertainty) * belief.object_probability**TRUST
