// SPDX-License-Identifier: MIT
// Results in the XML of JUnit, which continuous integration shows test by test.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct TestCase {
  std::string group;  ///< JUnit's classname
  std::string name;
  double seconds = 0.0;
  std::string failure;     ///< one line; "" when it passed
  bool tolerated = false;  ///< its failure is told, but not counted
};

/// A document with one suite. Bytes that XML 1.0 cannot hold become U+FFFD.
std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases);

}  // namespace palpate
