// SPDX-License-Identifier: MIT
// A GP for tests, at any positions, by default with one output. Its maps are returned by value and always up to date.
#pragma once

#include "gp/gaussian_process.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace palpate::test {

/// Returns candidates at any positions, in one row.
inline CandidateGrid scattered(Points points) {
  const auto count = static_cast<int>(points.rows());
  return {count, 1, std::move(points), {}, {}};
}

class GaussianProcess : public palpate::GaussianProcess {
 public:
  GaussianProcess(std::shared_ptr<Kernel> kernel, std::vector<GpSettings> outputs, const CandidateGrid& candidates,
                  EngineSettings posterior = {})
      : palpate::GaussianProcess(std::move(kernel), std::move(outputs), candidates, std::move(posterior)) {
    update_maps();
  }
  GaussianProcess(std::shared_ptr<Kernel> kernel, const GpSettings& output, const CandidateGrid& candidates,
                  EngineSettings posterior = {})
      : GaussianProcess(std::move(kernel), std::vector<GpSettings>{output}, candidates, std::move(posterior)) {}

  void add(const Target& place, const VectorView& values) {
    palpate::GaussianProcess::add(place, values);
    update_maps();
  }
  void add(const Target& place, double value) { add(place, Eigen::Map<const Eigen::VectorXd>(&value, 1)); }
  bool set_trust(const VectorView& trust) { return updated(palpate::GaussianProcess::set_trust(trust)); }
  bool set_targets(const VectorView& values) { return updated(palpate::GaussianProcess::set_targets(values)); }
  bool set_positions(const PointsView& positions) {
    return updated(palpate::GaussianProcess::set_positions(positions));
  }
  void show(int outputs) {
    palpate::GaussianProcess::show(outputs);
    update_maps();
  }
  FitSummary fit(const Fitting& fitting, Random& random) {
    return updated(palpate::GaussianProcess::fit(fitting, random));
  }

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
