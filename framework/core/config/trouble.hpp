// SPDX-License-Identifier: MIT
// Errors as values: for who goes on without what could not be done, or has more to say of it.
#pragma once

#include <palpate/error.hpp>

#include <optional>

namespace palpate {

/// Does `work` and returns the Error that it threw, none if it did not.
template <class Work>
std::optional<Error> trouble_in(const Work& work) {
  try {
    work();
  } catch (const Error& trouble) {  // each caller says what becomes of it
    return trouble;
  }
  return std::nullopt;
}

}  // namespace palpate
