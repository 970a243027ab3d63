// SPDX-License-Identifier: MIT
// tests/size.sh over a tree of files whose lines of code are known.
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace palpate {
namespace {

TEST(Size, OfTheSourcesIsTheirLinesThatAreNeitherBlankNorComment) {
  const test::TemporaryFolder tree;
  tree.write("framework/gp/one.cpp", "// no\n\n  /* no\n no */ int a;\n/* no */\nint b;  // of it\n \t\n");
  tree.write("framework/report/page/web/one.js", "let c = 1;\n  // no\n");
  tree.write("framework/report/page/vendor/theirs.js", "let d;\n");
  tree.write("plugins/one.inc", "/*\nno\n*/\n#define E\n");
  tree.write("tests/unit/one_test.hpp", "int f;\nint g;");
  tree.write("tests/one.sh", "#!/bin/sh\n# no\necho h\n");
  tree.write("notes.md", "no\n");
  std::filesystem::copy(test::source_folder() / "tests" / "size.sh", tree.path() / "tests");
  const auto run = [&](const std::string& command) {
    return test::run_program({"/bin/sh", "-c", command}, tree.path(), {"HOME=" + tree.path().string()});
  };
  const test::Ended known = run("git init -q && echo tests/size.sh >.git/info/exclude");
  if (known.status != 0) GTEST_SKIP() << "no git: " << known.err;

  const std::string expected = R"(                                 code  scripts
framework/gp                        2        0
framework/report                    1        0
plugins                             1        0
tests                               0        1
tests/unit                          2        0
all of framework and plugins        4        0
all of tests                        2        1
all of the rest                     0        0
)";
  EXPECT_EQ(run("sh tests/size.sh").out, expected);
  EXPECT_EQ(run("git add . && git -c user.name=a -c user.email=a@b commit -qm one && echo 'int i;' "
                ">>tests/unit/one_test.hpp && "
                "sh tests/size.sh HEAD")
                .out,
            expected);
  EXPECT_THAT(run("sh tests/size.sh none").err, ::testing::HasSubstr("there is no commit 'none'"));
}

}  // namespace
}  // namespace palpate
