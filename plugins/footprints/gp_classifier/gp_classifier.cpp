// SPDX-License-Identifier: MIT
// Gaussian process classification of the labels. The probability is always in [0, 1] and equals the prior far from all
// taps.
#include "laplace.hpp"

namespace palpate::footprints {

PALPATE_PLUGIN(Footprint, Classifier, "gp_classifier",
               "Gaussian process classification (Laplace approximation, probit link), for outlines of any form")

}  // namespace palpate::footprints
