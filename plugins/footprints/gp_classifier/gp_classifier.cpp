// SPDX-License-Identifier: MIT
// Gaussian process classification of the labels: a probability that stays in [0, 1] and falls back to the prior where
// nothing was touched.
#include "laplace.hpp"

namespace palpate::footprints {

PALPATE_PLUGIN(Footprint, Classifier, "gp_classifier",
               "Gaussian process classification (Laplace approximation, probit link), for outlines of any form")

}  // namespace palpate::footprints
