// SPDX-License-Identifier: MIT
// Experiments inside a test: configs from the shipped ones, journals that collect, factories that count.
#pragma once

#include "config/compose.hpp"
#include "experiment/experiment.hpp"
#include "record/resolved.hpp"
#include "support/support.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate::test {

/// A shipped config (path below configs/) with overrides as typed on the command line.
inline ResolvedConfig shipped_config(const std::string& file, const std::vector<std::string>& overrides = {}) {
  Composer composer(source_folder() / "configs", config_keys());
  std::vector<Override> parsed;
  for (const std::string& text : overrides) parsed.push_back(parse_override(text));
  return load_experiment(composer, shared_host(), source_folder() / "configs" / file, parsed);
}

/// Keeps every record.
class Collector : public Journal {
 public:
  std::vector<TapRecord> taps;
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { taps.push_back(tap); }
};

/// Answers with what the test scripts; a plain desk at 0 once the script has ended. Reads of the belief what `reading`
/// reads when it is shown.
class ScriptedBackend final : public Backend {
 public:
  explicit ScriptedBackend(std::vector<Contact> answers, bool truth = false)
      : answers_(std::move(answers)), truth_(truth) {}
  std::vector<TapRequest> requests;
  std::function<void(const Belief&)> reading;
  Quantities read;  ///< by `reading`

  Contact tap(const TapRequest& request) override {
    requests.push_back(request);
    const auto index = static_cast<std::size_t>(request.number - 1);
    return index < answers_.size() ? answers_[index] : Contact{Outcome::contact, 0.0, 8.0, 1.0, {}};
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return truth_; }
  Quantities reads() const override { return read; }
  void show(const Belief& belief) override {
    if (reading) reading(belief);
  }

 private:
  std::vector<Contact> answers_;
  bool truth_;
};

}  // namespace palpate::test
