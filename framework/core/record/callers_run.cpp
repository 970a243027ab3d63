// SPDX-License-Identifier: MIT
#include "record/callers_run.hpp"

#include "answers/answer.hpp"
#include "config/quantity.hpp"
#include "record/course.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

namespace palpate {
namespace {

/// The one CallersRun: what is begun or carried on, whichever, goes on alike.
class Held final : public CallersRun {
 public:
  Held(const ResolvedConfig& config, Begun begun)
      : config_(config),
        begun_(std::move(begun)),
        course_(config_, *begun_.directory, *begun_.experiment, {}, watch_) {}

  const TapRecord* begin(const Eigen::VectorXd* scores) override {
    if (finished()) return nullptr;
    if (tap_ && scores != nullptr) {
      throw Error(fmt::format("tap {}", tap_->number), "is pending", "call tell() with its result first");
    }
    if (tap_) return &*tap_;
    const std::optional<Wish> wish = scores != nullptr ? std::optional(Wish{*scores, {}}) : std::nullopt;
    const std::string failure = Course::failure_in([&] {
      tap_ = begun_.experiment->begin(course_.journal(), std::numeric_limits<int>::max(), wish ? &*wish : nullptr);
    });
    if (tap_ && failure.empty()) return &*tap_;
    end_with(failure);
    return nullptr;
  }

  void end(Contact contact) override {
    if (!tap_) throw Error("tell", "no tap is pending", "call ask() first");
    if (const auto fault = find_fault(contact, bounds())) throw Error("tell", fault->reason, fault->remedy);
    contact.reason = plain_line(contact.reason);
    tap_->contact = std::move(contact);
    const std::string failure = Course::failure_in([&] { begun_.experiment->end(*tap_, course_.journal()); });
    tap_.reset();
    if (!failure.empty()) end_with(failure);
  }

  const RunReport& finish() override {
    if (!finished()) {
      if (tap_) throw Error(fmt::format("tap {}", tap_->number), "is pending", "call tell() with its result first");
      begun_.experiment->stop("ended by the caller");
      end_with({});
    }
    return *report_;
  }

  bool finished() const override { return report_.has_value(); }
  bool pending() const override { return tap_.has_value(); }
  FromAbove& experiment() override { return from_above_of(*begun_.experiment, directory().string()); }
  const ResolvedConfig& config() const override { return config_; }
  const std::filesystem::path& directory() const override { return begun_.directory->path(); }

 private:
  HeightBounds bounds() const {
    const auto length = [&](const char* name) {
      const Tree* const value = config_.tree.find_path(std::string("backend.") + name);
      if (value == nullptr) throw Error("backend", std::string("has no option '") + name + "'", "rebuild the plugin");
      return read_quantity(*value, name, Unit::metre);
    };
    return height_bounds(begun_.experiment->scene().desk(), length("overrun"), length("hover"));
  }

  /// A run that failed is finished as well.
  void end_with(const std::string& failure) {
    tap_.reset();
    report_.emplace();
    report_->directory = directory();
    *report_ = course_.finish(failure);
  }

  Stopwatch watch_;
  ResolvedConfig config_;
  Begun begun_;
  Course course_;
  std::optional<TapRecord> tap_;  ///< that is to be made
  std::optional<RunReport> report_;
};

/// What is said of a run that is there already.
Error finished_error(const std::filesystem::path& directory) {
  return Error(directory.string(), "this run is finished", "add force=True to move it aside and run again");
}

}  // namespace

std::unique_ptr<CallersRun> CallersRun::start(const Workshop& workshop, const ResolvedConfig& config,
                                              const std::filesystem::path& directory, bool force) {
  check_who_taps(config, Taps::by_caller, "run");
  Begun begun = begin_run(workshop, config, directory, force, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<Held>(config, std::move(begun));
}

std::unique_ptr<CallersRun> CallersRun::resume(const Workshop& workshop, const std::filesystem::path& directory,
                                               const ResumeOptions& options) {
  const ResolvedConfig config = load_run(workshop.host, directory);
  Begun begun;
  begun.directory = std::make_unique<RunDirectory>(directory);
  begun.experiment = go_on(workshop, config, *begun.directory, options, Taps::by_caller, false);
  if (!begun.experiment) throw finished_error(directory);
  return std::make_unique<Held>(config, std::move(begun));
}

}  // namespace palpate
