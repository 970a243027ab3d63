"""Score of each candidate: uncertainty of the height, weighted by the probability of an object. The arrays and their
units are in framework/docs/strategies.md of palpate."""
import numpy

from palpate_acquisition import acquisition

TRUST = 0.5  # exponent of the object probability; with 0 only the uncertainty counts


@acquisition(reads=["uncertainty", "object_probability"])  # must be last in the file: under palpate, it does not return
def score(belief):
    return numpy.sqrt(belief.uncertainty) * belief.object_probability**TRUST
