// SPDX-License-Identifier: MIT
// The fitting in builds without Ceres. It only reports that Ceres is missing.
#include "stub.hpp"

#include "fitting/ceres/options.hpp"

PALPATE_STUB_PLUGIN(palpate::Fitting, palpate::fitting::CeresOptions, "ceres",
                    "likelihood or leave-one-out density by Ceres, which this build does not have")
