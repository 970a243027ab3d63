// SPDX-License-Identifier: MIT
// A process as tests make and read it: of a single output unless they say otherwise, over any places, its maps by
// value.
#pragma once

#include "gp/process.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace palpate::test {

/// Candidates at any places, one row.
inline Candidates scattered(Points points) {
  const auto count = static_cast<int>(points.rows());
  return {count, 1, std::move(points), {}, {}};
}

class Process : public palpate::Process {
 public:
  using palpate::Process::add;
  using palpate::Process::Process;
  Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& output, const Candidates& candidates,
          PosteriorSettings posterior = {})
      : Process(std::move(kernel), std::vector<ProcessSettings>{output}, candidates, std::move(posterior)) {}

  void add(const Target& place, double value) { add(place, Eigen::Map<const Eigen::VectorXd>(&value, 1)); }

  Eigen::VectorXd mean(int output = 0) const {
    return filled([&](Eigen::VectorXd& out) { read_mean(output, out); });
  }
  Eigen::VectorXd variance(int output = 0) const {
    return filled([&](Eigen::VectorXd& out) { read_variance(output, out); });
  }
  Eigen::VectorXd relative_variance() const {
    return filled([&](Eigen::VectorXd& out) { read_relative_variance(out); });
  }

 private:
  template <class Read>
  Eigen::VectorXd filled(const Read& read) const {
    Eigen::VectorXd out;
    read(out);
    return out;
  }
};

}  // namespace palpate::test
