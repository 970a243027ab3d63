"""python3 starter/test_starter.py"""
import unittest

import numpy
from palpate_acquisition import Belief

from starter import score


class Score(unittest.TestCase):
    def test_is_highest_where_the_height_is_unknown_and_an_object_probable(self):
        belief = Belief(uncertainty=numpy.array([1.0, 1.0, 0.1]), object_probability=numpy.array([0.0, 0.9, 0.9]))
        self.assertEqual(numpy.argmax(score(belief)), 1)
        self.assertEqual(score(belief)[0], 0.0)


unittest.main()
