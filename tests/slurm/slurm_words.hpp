// SPDX-License-Identifier: MIT
// What the tests over a cluster share.
#pragma once

#include "slurm_lab.hpp"
#include "sweep/sweep.hpp"
#include "system/shipped.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// A test that needs Slurm's daemons.
class Slurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = SlurmLab::missing(); !missing.empty()) GTEST_SKIP() << missing;
  }
};

inline Sweep sweep_in(const std::filesystem::path& folder) { return read_sweep(only_run(folder / "runs")); }

inline std::filesystem::path job_at(const Sweep& sweep, std::size_t job) {
  return job_directory(sweep, sweep.jobs[job]);
}

/// The words with which README sends a sweep to a cluster, and `more`.
inline std::vector<std::string> on_slurm(std::vector<std::string> words, const std::vector<std::string>& more = {}) {
  words.insert(words.end(), {"--launcher", "slurm"});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace palpate::test

namespace palpate {

using test::job_at;
using test::on_slurm;
using test::Slurm;
using test::SlurmLab;
using test::sweep_in;

}  // namespace palpate
