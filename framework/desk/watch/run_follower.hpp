// SPDX-License-Identifier: MIT
// A run that goes on, lived through again tap by tap as its record grows. It reads and writes nothing else.
#pragma once

#include "record/recording.hpp"
#include "report/history.hpp"
#include "watch/growing_log.hpp"
#include "watch/live_record.hpp"

#include <deque>
#include <filesystem>
#include <memory>
#include <string>

namespace palpate {

/// Follows the run in a directory, which may have no tap yet. What is computed for it is what its report would show,
/// but a tap at a time; of a long run the maps of some moments are let go of.
///
/// A run that is killed and carried on goes on here. Where the record is another one than before (--force), pages begin
/// anew.
class RunFollower final : public LiveRecord {
 public:
  /// `workshop` must outlive it.
  RunFollower(const Workshop& workshop, std::filesystem::path directory);

  bool look(double seconds) override;
  std::string page() override;
  std::optional<std::string> news(const std::string& at) override;
  bool goes_on() const override;

 private:
  void read_record();
  void take_in();
  void take_times();
  void begin_anew();
  std::string at() const;
  std::string why_waiting() const;

  const Workshop& workshop_;
  std::filesystem::path directory_;
  GrowingLog log_;
  std::optional<Tree> manifest_;
  std::vector<TapTimes> timings_;
  std::deque<Row> pending_;                  ///< recorded, and not yet in recording_
  std::unique_ptr<Recording> recording_;     ///< null before the first tap
  std::unique_ptr<HistoryBuilder> builder_;  ///< of as many taps as recording_ has
  std::string trouble_;                      ///< with the record as it is, "" for none
  std::string standing_;                     ///< how the run stood at the last look
  int generation_ = 1;                       ///< of pages: those of another one begin anew
  int revision_ = 0;                         ///< counts what changed without a tap
};

}  // namespace palpate
