// SPDX-License-Identifier: MIT
#include "record/recording.hpp"

#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// In the place of a backend: knows whether the scene was the truth, and makes no tap.
class Absent final : public Backend {
 public:
  explicit Absent(bool truth_known) : truth_known_(truth_known) {}
  Contact tap(const TapRequest&) override {
    throw Error("", "a recorded run makes no taps", {}, Error::Kind::run);  // would be a mistake in this program
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return truth_known_; }

 private:
  bool truth_known_;
};

}  // namespace

std::shared_ptr<Backend> no_backend(bool truth_known) { return std::make_shared<Absent>(truth_known); }

Quantities recorded_quantities(const Row& row) {
  const auto has = [&](const char* field) { return row.number(field).has_value(); };
  Quantities out;
  if (has("height_process.signal")) out = out | Quantity::uncertainty;
  if (has("weight_process.signal")) out = out | Quantity::weight;
  if (has("surface_process.signal")) out = out | Quantity::height;
  // A summary has no p.
  if (has("p") || row.find("footprint.remark") != nullptr) out = out | Quantity::probability;
  return out;
}

bool Recording::truth_known() const { return rows.front().flag("true_on_surface").has_value(); }

bool Recording::failed() const { return summary && summary->text("status") == "failed"; }

Recording read_recording(const Workshop& workshop, const fs::path& directory) {
  const fs::path file = directory / "taps.jsonl";
  Recording out{directory, load_run(workshop.host, directory), {}, {}, {}};
  for (Row& row : read_json_lines(file).rows) {
    if (!is_intent(row)) out.rows.push_back(std::move(row));
  }
  if (out.rows.empty()) throw Error(directory.string(), "holds no recorded tap", {}, Error::Kind::run);
  for (std::size_t i = 0; i < out.rows.size(); ++i)
    out.taps.push_back(past_tap(out.rows[i], fmt::format("{}: tap {}", file.string(), i + 1)));
  out.summary = read_summary(directory);
  if (out.summary) check_complete(*out.summary, static_cast<int>(out.rows.size()), directory);
  return out;
}

Playback::Playback(const Workshop& workshop, const Recording& recording)
    : recording_(recording),
      experiment_(std::make_unique<Experiment>(recording.config.options, workshop.host, workshop.interrupted,
                                               no_backend(recording.truth_known()))) {}

void Playback::advance_to(int taps) {
  const auto begin = recording_.taps.begin();
  experiment_->resume({begin + taps_, begin + taps});
  taps_ = taps;
}

}  // namespace palpate
