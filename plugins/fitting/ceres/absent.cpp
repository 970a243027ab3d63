// SPDX-License-Identifier: MIT
// The fitting of a build without Ceres.
#include "absent.hpp"

#include "fitting/ceres/options.hpp"

PALPATE_ABSENT_PLUGIN(palpate::Fitting, palpate::fitting::CeresOptions, "ceres",
                      "likelihood or leave-one-out density by Ceres, which this build does not have")
