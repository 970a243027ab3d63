// SPDX-License-Identifier: MIT
// A sweep that goes on, and the runs in it.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"
#include "watch/live_record.hpp"

#include <chrono>
#include <string>

namespace palpate {

/// Follows a sweep by what its jobs have written: looked at every two seconds, or, where they are so many that this
/// takes its time, so seldom that it takes a twentieth of it.
class SweepFollower final : public LiveRecord {
 public:
  explicit SweepFollower(Sweep sweep) : sweep_(std::move(sweep)) {}

  bool look(double seconds) override;
  std::string page() override;
  std::optional<std::string> news(const std::string& at) override;
  bool goes_on() const override;

 private:
  Sweep sweep_;
  Json data_;  ///< of the page
  int revision_ = 0;
  std::chrono::steady_clock::time_point next_{};  ///< when it is looked at again
};

}  // namespace palpate
