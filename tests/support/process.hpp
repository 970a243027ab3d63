// SPDX-License-Identifier: MIT
// A process as tests make and read it: of a single output unless they say otherwise, over any places, its maps by
// value and never behind.
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
  Process(std::shared_ptr<Kernel> kernel, std::vector<ProcessSettings> outputs, const Candidates& candidates,
          PosteriorSettings posterior = {})
      : palpate::Process(std::move(kernel), std::move(outputs), candidates, std::move(posterior)) {
    update_maps();
  }
  Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& output, const Candidates& candidates,
          PosteriorSettings posterior = {})
      : Process(std::move(kernel), std::vector<ProcessSettings>{output}, candidates, std::move(posterior)) {}

  void add(const Target& place, const VectorView& values) {
    palpate::Process::add(place, values);
    update_maps();
  }
  void add(const Target& place, double value) { add(place, Eigen::Map<const Eigen::VectorXd>(&value, 1)); }
  bool trust(const VectorView& shares) { return updated(palpate::Process::trust(shares)); }
  bool correct(const VectorView& values) { return updated(palpate::Process::correct(values)); }
  bool move(const PointsView& places) { return updated(palpate::Process::move(places)); }
  void show(int outputs) {
    palpate::Process::show(outputs);
    update_maps();
  }
  FitSummary fit(const Fitting& fitting, Random& random) { return updated(palpate::Process::fit(fitting, random)); }

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
  template <class Result>
  Result updated(Result result) {
    update_maps();
    return result;
  }
  template <class Read>
  Eigen::VectorXd filled(const Read& read) const {
    Eigen::VectorXd out;
    read(out);
    return out;
  }
};

}  // namespace palpate::test
