// SPDX-License-Identifier: MIT
// A sweep that is not finished.
#pragma once

#include "report/page/json.hpp"
#include "sweep/sweep.hpp"
#include "watch/live_record.hpp"

#include <chrono>
#include <string>

namespace palpate {

/// Follows a sweep by the records of its jobs. It reads the records every two seconds, or less often in large sweeps,
/// so that reading takes at most a twentieth of the time.
class SweepFollower final : public LiveRecord {
 public:
  explicit SweepFollower(Sweep sweep) : sweep_(std::move(sweep)) {}

  bool look(double seconds) override;
  std::string page() override;
  std::optional<std::string> news(const std::string& at) override;
  bool goes_on() const override;

 private:
  Sweep sweep_;
  Json data_;  ///< data of the page
  int revision_ = 0;
  std::chrono::steady_clock::time_point next_{};  ///< time of the next reading
};

}  // namespace palpate
