// SPDX-License-Identifier: MIT
#include "belief/gp_model.hpp"

#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>

namespace palpate {

GpModel::GpModel(GpDescription description, const CandidateGrid& candidates, const Context& context)
    : description_(std::move(description)), candidates_(candidates), context_(context) {
  create_plugins();
  const std::string refusal = fitting_->objection(*kernel_);
  if (!refusal.empty()) throw Error(description_.fitting.options->place.text(), refusal);
  const std::string why = objection(description_.engine, *kernel_, candidates_);
  if (!why.empty()) {
    const char* const engine = description_.engine.engine == EngineSettings::Kind::grid ? "grid" : "lowrank";
    throw Error("engine.type",
                fmt::format("{} cannot be used with the kernel {}: {}", engine, description_.kernel.type, why),
                "engine: {type: dense} serves every kernel");
  }
}

void GpModel::create_plugins() {
  kernel_ = context_.create<Kernel>(description_.kernel);
  fitting_ = context_.create<Fitting>(description_.fitting);
}

bool GpModel::is_fitted_within(int taps) const {
  for (int i = 1; i <= taps; ++i) {
    if (fitting_->due(i)) return true;
  }
  return false;
}

bool GpModel::show(int output) {
  if (!process_) {
    process_ = std::make_unique<GaussianProcess>(kernel_, description_.outputs, candidates_, description_.engine);
  } else if (process_->shown() > output) {
    return false;
  }
  process_->show(output + 1);
  stale_ = true;
  return true;
}

void GpModel::add_data(const ContactLog& log, PhaseClock* clock) {
  if (!process_) return;
  while (process_->size() < size(log)) {
    const Touch& datum = log.datum(row(log, process_->size()));
    const double label = datum.on ? 1.0 : 0.0;
    const std::array<double, 2> values{description_.labels ? label : datum.height, label};
    process_->add(datum.place, Eigen::Map<const Eigen::VectorXd>(
                                   values.data(), static_cast<Eigen::Index>(description_.outputs.size())));
    const int taps = process_->size() - prior_size(log);
    if (taps > 0 && fitting_->due(taps)) fit(taps, clock);
    stale_ = true;
  }
}

void GpModel::fit(int taps, PhaseClock* clock) {
  const PhaseClock::Scope scope(clock, Phase::fit);
  Random random = context_.random(description_.stream, static_cast<std::uint64_t>(taps));
  fit_ = process_->fit(*fitting_, random);
  fit_at_ = process_->size();
  if (fit_.failed) ++failed_fits_;
}

void GpModel::set_heights(const ContactLog& log) {
  if (!process_) return;
  Eigen::VectorXd values(size(log));
  for (int i = 0; i < size(log); ++i) values(i) = log.datum(row(log, i)).height;
  if (process_->set_targets(values)) stale_ = true;
}

void GpModel::set_positions(const ContactLog& log, const Points& positions) {
  if (process_ &&
      process_->set_positions(description_.only_objects ? Points(positions(log.object_rows(), Eigen::all)) : positions))
    stale_ = true;
}

void GpModel::set_trust(const ContactLog& log, const Eigen::VectorXd& trust) {
  if (process_ && process_->set_trust(description_.only_objects ? Eigen::VectorXd(trust(log.object_rows())) : trust))
    stale_ = true;
}

void GpModel::reset() {
  if (!process_) return;
  const int shown = process_->shown();
  create_plugins();
  process_.reset();
  fit_ = {};
  fit_at_ = 0;
  failed_fits_ = 0;
  show(shown - 1);
}

}  // namespace palpate
