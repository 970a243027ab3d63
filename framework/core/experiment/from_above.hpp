// SPDX-License-Identifier: MIT
// An experiment that taps from above: one height per place.
#pragma once

#include "experiment/chooser.hpp"
#include "experiment/experiment.hpp"
#include "experiment/read_plan.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/watch.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class FromAbove final : public Experiment {
 public:
  /// Throws Error as Experiment does.
  FromAbove(const ExperimentOptions& options, const PluginFactory& factory, const std::atomic<bool>* interrupted,
            std::shared_ptr<Backend> backend = nullptr, const std::string& directory = {});

  std::optional<TapRecord> choose_next(const Wish* wish = nullptr) override;
  void observe(const PastTap& tap) override;
  /// Asks for what was read then, too.
  void resume(const std::vector<PastTap>& past) override;
  void stop(const std::string& reason) override { watch_.stop(reason); }
  const RunResult& counts() const override { return watch_.counts(); }
  RunResult result() override { return watch_.result(belief_); }
  Errors errors() override { return watch_.errors(belief_); }
  std::optional<double> expected_rmse() override { return watch_.expected_rmse(belief_); }
  void ask(Quantities quantities) override { belief_.ask(quantities); }
  Preview preview(const TapRecord& tap) const override;
  std::vector<ModelReader> readers() const override;

  /// What the acquisition gives each candidate as of now: asked again, which changes nothing (its law); 0 where
  /// it is not asked.
  Eigen::VectorXd scores();

  /// Has the belief hold these quantities as of now, for who looks at it; the record is the same without.
  void build(Quantities quantities) { belief_.build(quantities); }

  const Candidates& candidates() const { return candidates_; }
  const TapBelief& belief() const { return belief_; }
  /// The scene at the candidates; null where the backend taps another world.
  const Truth* truth() { return watch_.truth(); }

 private:
  void update() override;
  std::optional<std::string> stop_rule(Source source) override;
  void read(TapRecord& tap) override;
  ReadPlan make_plan() const;
  Manner manner_of(const PastTap& tap) const {
    return {tap.source == Source::initial, tap.motion, chooser_.roughness(tap.motion)};
  }

  Candidates candidates_;
  TapBelief belief_;
  Chooser chooser_;
  ReadPlan plan_;
  Watch watch_;
};

}  // namespace palpate
