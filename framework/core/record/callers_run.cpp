// SPDX-License-Identifier: MIT
#include "record/callers_run.hpp"

#include "answers/answer.hpp"
#include "config/quantity.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace palpate {
namespace {

HeightBounds bounds_of(const ResolvedConfig& config, const Experiment& experiment) {
  const auto length = [&](const char* name) {
    const Tree* const value = config.tree.find_path(std::string("backend.") + name);
    if (value == nullptr) throw Error("backend", std::string("has no option '") + name + "'", "rebuild the plugin");
    return read_quantity(*value, name, Unit::metre);
  };
  return height_bounds(experiment.scene().desk(), length("overrun"), length("hover"));
}

/// What is said of a run that is there already.
Error finished_error(const std::filesystem::path& directory) {
  return Error(directory.string(), "this run is finished", "add force=True to move it aside and run again");
}

}  // namespace

CallersRun::CallersRun(const ResolvedConfig& config, Begun begun)
    : config_(config), begun_(std::move(begun)), course_(config_, *begun_.directory, *begun_.experiment, watch_) {}

std::unique_ptr<CallersRun> CallersRun::start(const Workshop& workshop, const ResolvedConfig& config,
                                              const std::filesystem::path& directory, bool force) {
  check_who_taps(config, Taps::by_caller, "run");
  Begun begun = begin_run(workshop, config, directory, force, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<CallersRun>(config, std::move(begun));
}

std::unique_ptr<CallersRun> CallersRun::resume(const Workshop& workshop, const std::filesystem::path& directory,
                                               const ResumeOptions& options) {
  const ResolvedConfig config = load_run(workshop.host, directory);
  Begun begun;
  begun.directory = std::make_unique<RunDirectory>(directory);
  begun.experiment = go_on(workshop, config, *begun.directory, options, Taps::by_caller, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<CallersRun>(config, std::move(begun));
}

const TapRecord* CallersRun::begin(const Eigen::VectorXd* scores) {
  if (finished()) return nullptr;
  if (tap_ && scores != nullptr) {
    throw Error(fmt::format("tap {}", tap_->number), "is pending", "call tell() with its result first");
  }
  if (tap_) return &*tap_;
  const std::optional<Wish> wish = scores != nullptr ? std::optional(Wish{*scores, {}}) : std::nullopt;
  const std::string failure = Course::failure_in(
      [&] { tap_ = begun_.experiment->begin(course_, std::numeric_limits<int>::max(), wish ? &*wish : nullptr); });
  if (tap_ && failure.empty()) return &*tap_;
  end_with(failure);
  return nullptr;
}

void CallersRun::end(Contact contact) {
  if (!tap_) throw Error("tell", "no tap is pending", "call ask() first");
  if (const auto fault = find_fault(contact, bounds_of(config_, *begun_.experiment)))
    throw Error("tell", fault->reason, fault->remedy);
  contact.reason = plain_line(contact.reason);
  tap_->contact = std::move(contact);
  const std::string failure = Course::failure_in([&] { begun_.experiment->end(*tap_, course_); });
  tap_.reset();
  if (!failure.empty()) end_with(failure);
}

const RunReport& CallersRun::finish() {
  if (!finished()) {
    if (tap_) throw Error(fmt::format("tap {}", tap_->number), "is pending", "call tell() with its result first");
    begun_.experiment->stop("ended by the caller");
    end_with({});
  }
  return *report_;
}

/// A run that failed is finished as well.
void CallersRun::end_with(const std::string& failure) {
  tap_.reset();
  report_.emplace();
  report_->directory = directory();
  *report_ = course_.finish(failure);
}

}  // namespace palpate
