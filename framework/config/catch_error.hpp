// SPDX-License-Identifier: MIT
// Returns errors as values, for callers that continue after an error or add information to it.
#pragma once

#include <palpate/error.hpp>

#include <optional>

namespace palpate {

/// Calls `work` and returns the Error that it threw; nullopt if it returned.
template <class Work>
std::optional<Error> catch_error(const Work& work) {
  try {
    work();
  } catch (const Error& trouble) {  // the caller handles the error
    return trouble;
  }
  return std::nullopt;
}

}  // namespace palpate
