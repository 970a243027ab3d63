// SPDX-License-Identifier: MIT
#include "gp/workers.hpp"

#include <hwy/cache_control.h>

#include <utility>

namespace palpate {
namespace {

/// Number of polls for the next job before a helper sleeps, about 50 microseconds.
constexpr int kPollsBeforeSleep = 2000;

}  // namespace

Workers::Workers(int threads) {
  for (int worker = 1; worker < threads; ++worker) {
    helpers_.emplace_back([this, worker] { help(worker); });
  }
}

Workers::~Workers() {
  stop_ = true;
  ++jobs_;
  { const std::lock_guard<std::mutex> lock(mutex_); }
  wake_.notify_all();
  for (std::thread& one : helpers_) one.join();
}

void Workers::run(int count, Call call, const void* job) {
  call_ = call;
  job_ = job;
  count_ = count;
  next_ = 0;
  open_ = true;
  ++jobs_;
  if (asleep_ > 0) {
    // The lock ensures that a helper which found no new job is already waiting when it is notified.
    { const std::lock_guard<std::mutex> lock(mutex_); }
    wake_.notify_all();
  }
  take_parts(0);
  // A helper increments inside_ before it reads open_. So a helper that is not counted in inside_ below finds open_
  // false and takes no part.
  open_ = false;
  while (inside_ > 0) std::this_thread::yield();
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Workers::take_parts(int worker) {
  try {
    for (int part = next_++; part < count_; part = next_++) call_(job_, part, worker);
  } catch (...) {
    next_ = count_;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!thrown_) thrown_ = std::current_exception();
  }
}

void Workers::help(int worker) {
  unsigned seen = 0;
  for (;;) {
    for (int poll = 0; poll < kPollsBeforeSleep && jobs_ == seen; ++poll) hwy::Pause();
    if (jobs_ == seen) {
      std::unique_lock<std::mutex> lock(mutex_);
      ++asleep_;
      wake_.wait(lock, [&] { return jobs_ != seen; });
      --asleep_;
    }
    seen = jobs_;
    if (stop_) return;
    ++inside_;
    if (open_) take_parts(worker);
    --inside_;
  }
}

}  // namespace palpate
