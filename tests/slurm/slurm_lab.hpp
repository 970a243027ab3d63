// SPDX-License-Identifier: MIT
// A cluster of one node on this machine, for one test: Slurm's own daemons on free ports of the loopback, all they
// write in one folder. Tests may run at the same time. The daemons end with the test, even one that is killed; tasks
// that run then go on to their own end.
#pragma once

#include "support/support.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

struct SlurmSettings {
  int cpus = 8;  ///< of the node, whatever the machine has: tasks of these tests mostly sleep
  int max_array_size = 1001;
};

class SlurmLab {
 public:
  /// Why there can be no cluster on this machine; "" if there can.
  static std::string missing();

  /// Starts munged, slurmctld and slurmd and waits until the node is idle. Throws std::runtime_error with their words.
  explicit SlurmLab(const SlurmSettings& settings = {});
  /// Cancels what is in the queue, and ends the daemons.
  ~SlurmLab();
  SlurmLab(const SlurmLab&) = delete;
  SlurmLab& operator=(const SlurmLab&) = delete;

  /// Where programs run; the cluster's own files are in it, too, below "cluster".
  const std::filesystem::path& folder() const { return folder_.path(); }
  std::vector<std::string> environment() const;

  /// Runs a program in this cluster, `more` in its environment.
  Ended run(const std::vector<std::string>& words, const std::vector<std::string>& more = {}) const;
  std::unique_ptr<Child> start_palpate(const std::vector<std::string>& words) const;
  Ended palpate(const std::vector<std::string>& words, const std::vector<std::string>& more = {}) const;

  /// A task, and the state that squeue names.
  struct Task {
    int array = 0;
    int index = 0;
    std::string state;
  };
  /// All tasks that ever were, ended ones included, by array and index.
  std::vector<Task> tasks() const;
  /// The indices of an array, ascending.
  std::vector<int> indices(int array) const;
  /// Waits until every task has ended, at most a minute; whether that is so.
  bool becomes_idle() const;

 private:
  /// Starts a daemon and waits until it is up.
  void begin(const std::vector<std::string>& daemon, const std::function<bool()>& is_up);
  void write_config() const;
  std::filesystem::path cluster() const { return folder_.path() / "cluster"; }

  SlurmSettings settings_;
  TemporaryFolder folder_;
  std::vector<std::unique_ptr<Child>> daemons_;
};

}  // namespace palpate::test
