# SPDX-License-Identifier: MIT
"""Acquisition with NumPy: uncertainty of the height, weighted by the mean probability of an object around the
position."""
import numpy

from palpate_acquisition import acquisition


def blurred(grid):
    """Returns the mean over each cell and its four neighbours."""
    padded = numpy.pad(grid, 1, mode="edge")
    return (padded[1:-1, 1:-1] + padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]) / 5


@acquisition(reads=["uncertainty", "object_probability"])
def score(belief):
    near = blurred(belief.object_probability.reshape(belief.rows, belief.columns)).ravel()
    return numpy.sqrt(belief.uncertainty) * near
