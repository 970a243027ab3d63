// SPDX-License-Identifier: MIT
// Everything that once broke a door, and a few of each kind that a fuzzer found to lead somewhere new: a crash, a hang
// or an exception that is no Error fails here, and what the sanitizers find where this is built with them.
#include "fuzz/ground.hpp"
#include "fuzz/harness.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::TestWithParam<const Door*> {};

TEST_P(Corpus, IsReadOrRefusedInWords) {
  const fs::path folder = shipped_configs().parent_path() / "tests" / "fuzz" / "corpus" / GetParam()->name;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename().string());
    std::ifstream file(entry.path(), std::ios::binary);
    EXPECT_NO_THROW(GetParam()->open(std::string(std::istreambuf_iterator<char>(file), {})));
    ++files;
  }
  EXPECT_GT(files, 0) << "every door has its corpus";
}

std::vector<const Door*> all() {
  std::vector<const Door*> out;
  for (const Door& door : doors()) out.push_back(&door);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Of, Corpus, testing::ValuesIn(all()), [](const auto& door) { return door.param->name; });

}  // namespace
}  // namespace palpate::fuzz
