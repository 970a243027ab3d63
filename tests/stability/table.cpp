// SPDX-License-Identifier: MIT
// Prints the table of the extremes, or of the cases whose names begin with one of the words given. Exit status 1 if a
// row does not hold.
#include "stability/check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  using namespace palpate::stability;
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  fmt::print("{}\n", header());
  bool holds = true;
  for (const Case& one : cases()) {
    const auto begins = [&](const std::string& word) { return one.name.rfind(word, 0) == 0; };
    if (!wanted.empty() && std::none_of(wanted.begin(), wanted.end(), begins)) continue;
    for (const Row& row : check(one)) {
      fmt::print("{}\n", text(row));
      holds &= row.trouble.empty();
    }
  }
  return holds ? 0 : 1;
}
