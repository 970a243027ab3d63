// SPDX-License-Identifier: MIT
// Stub of the fitting for builds without Ceres. Creating it throws an error that names the missing packages.
#include "stub.hpp"

#include "fitting/ceres/options.hpp"

PALPATE_STUB_PLUGIN(palpate::Fitting, palpate::fitting::CeresOptions, "ceres",
                    "likelihood or leave-one-out density by Ceres, which this build does not have")
