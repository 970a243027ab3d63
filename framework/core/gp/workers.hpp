// SPDX-License-Identifier: MIT
// A few threads that share the pieces of one short job after the other.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

/// The caller and `threads` - 1 helpers. Pieces are taken by whoever is free, so a job whose pieces do not depend on
/// each other has the same result on any number of threads. A helper waits awake for a moment after a job, as the next
/// one mostly follows at once, and then sleeps; the caller never waits for a helper that has not begun.
class Workers {
 public:
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int threads() const { return static_cast<int>(helpers_.size()) + 1; }

  /// Calls job(piece, worker) for all pieces 0 .. count - 1 and returns when all are done; `worker` is below
  /// threads(), and each worker has one piece at a time. What a job throws first, in any thread, is thrown here once
  /// all workers have stopped; pieces that nobody had begun are then left out.
  template <class Job>
  void for_each(int count, const Job& job) {
    if (helpers_.empty() || count < 2) {
      for (int piece = 0; piece < count; ++piece) job(piece, 0);
      return;
    }
    run(
        count, [](const void* work, int piece, int worker) { (*static_cast<const Job*>(work))(piece, worker); }, &job);
  }

 private:
  using Call = void (*)(const void*, int, int);
  void run(int count, Call call, const void* job);
  void help(int worker);
  void take_pieces(int worker);

  Call call_ = nullptr;
  const void* job_ = nullptr;
  int count_ = 0;
  std::atomic<int> next_{0};
  std::atomic<int> inside_{0};     ///< helpers that may be at work
  std::atomic<bool> open_{false};  ///< there is a job
  std::atomic<unsigned> jobs_{0};  ///< so far
  std::atomic<int> asleep_{0};
  std::atomic<bool> stop_{false};
  std::exception_ptr thrown_;  ///< what the job threw first; guarded by mutex_
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> helpers_;
};

}  // namespace palpate
