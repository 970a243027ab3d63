// SPDX-License-Identifier: MIT
// Everything that once broke a door, and a few of each kind that a fuzzer found to lead somewhere new: a crash, a hang
// or an exception that is no Error fails here, and what the sanitizers find where this is built with them.
#include "fuzz/harness.hpp"
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::TestWithParam<const Door*> {};

TEST_P(Corpus, IsReadOrRefusedInWords) {
  const fs::path folder = test::source_folder() / "tests" / "fuzz" / "corpus" / GetParam()->name;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_NO_THROW(GetParam()->open(test::text_of(entry.path())));
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
