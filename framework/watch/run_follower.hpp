// SPDX-License-Identifier: MIT
// A run that is not finished, replayed tap by tap while its record grows.
#pragma once

#include "report/history.hpp"
#include "watch/growing_log.hpp"
#include "watch/live_record.hpp"

#include <deque>
#include <filesystem>
#include <memory>
#include <string>

namespace palpate {

/// Follows the run in a directory, which may have no tap yet. Writes nothing. The page equals the report of the run,
/// except that for a long run, the maps after some of its taps are missing.
///
/// If the run is killed and resumed, the page continues. If a new run replaces the record (--force), the pages start
/// again.
class RunFollower final : public LiveRecord {
 public:
  /// `environment` must outlive the object.
  RunFollower(const RunEnvironment& environment, std::filesystem::path directory);

  bool look(double seconds) override;
  std::string page() override;
  std::optional<std::string> news(const std::string& at) override;
  bool goes_on() const override;

 private:
  void read_record();
  void replay_next_tap();
  void add_times();
  void start_over();
  std::string at() const;
  std::string waiting_reason() const;

  const RunEnvironment& environment_;
  std::filesystem::path directory_;
  GrowingLog log_;
  std::optional<Tree> manifest_;
  std::vector<TapTimes> timings_;
  std::deque<Row> pending_;                  ///< recorded taps that are not yet in recording_
  std::unique_ptr<RecordedRun> recording_;   ///< null before the first tap
  std::unique_ptr<HistoryBuilder> builder_;  ///< has as many taps as recording_
  std::string trouble_;                      ///< error of the present record, "" for none
  std::string standing_;                     ///< state of lock and summary at the last reading
  int generation_ = 1;  ///< increases when open pages must reload, for example after a new run replaced the record
  int revision_ = 0;    ///< number of changes without a new tap
};

}  // namespace palpate
