// SPDX-License-Identifier: MIT
// Threads that share the work of short jobs.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

/// The calling thread and `threads` - 1 helper threads. A job is divided into parts, and each free thread takes the
/// next part. So a job with independent parts has the same result on any number of threads. After a job, a helper polls
/// for the next job for some time and then sleeps, because jobs often follow each other immediately. The caller never
/// waits for a helper that has not joined the job.
class Workers {
 public:
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int threads() const { return static_cast<int>(helpers_.size()) + 1; }

  /// Calls job(part, worker) for the parts 0 to `count` - 1 and returns when all parts are done. `worker` is the index
  /// of the thread, below threads(); a worker executes one part at a time. After an exception in any thread, no further
  /// part starts. The first exception is thrown here once all workers have stopped.
  template <class Job>
  void for_each(int count, const Job& job) {
    if (helpers_.empty() || count < 2) {
      for (int part = 0; part < count; ++part) job(part, 0);
      return;
    }
    run(
        count, [](const void* work, int part, int worker) { (*static_cast<const Job*>(work))(part, worker); }, &job);
  }

 private:
  using Call = void (*)(const void*, int, int);
  void run(int count, Call call, const void* job);
  void help(int worker);
  void take_parts(int worker);

  Call call_ = nullptr;
  const void* job_ = nullptr;
  int count_ = 0;
  std::atomic<int> next_{0};
  std::atomic<int> inside_{0};     ///< helpers that may take parts
  std::atomic<bool> open_{false};  ///< whether helpers may join the job
  std::atomic<unsigned> jobs_{0};  ///< number of jobs until now
  std::atomic<int> asleep_{0};
  std::atomic<bool> stop_{false};
  std::exception_ptr thrown_;  ///< first exception of the job; guarded by mutex_
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> helpers_;
};

}  // namespace palpate
