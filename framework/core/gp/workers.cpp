// SPDX-License-Identifier: MIT
#include "gp/workers.hpp"

#include <hwy/cache_control.h>

#include <utility>

namespace palpate {
namespace {

/// Looks at the next job before a helper goes to sleep: some 50 microseconds.
constexpr int kPatience = 2000;

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
    // The lock makes sure that who has just seen no job is really waiting, and hears this.
    { const std::lock_guard<std::mutex> lock(mutex_); }
    wake_.notify_all();
  }
  take_pieces(0);
  // A helper announces itself in inside_ before it looks at open_: who is not counted here finds the job closed, and
  // who is counted is waited for.
  open_ = false;
  while (inside_ > 0) std::this_thread::yield();
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Workers::take_pieces(int worker) {
  try {
    for (int piece = next_++; piece < count_; piece = next_++) call_(job_, piece, worker);
  } catch (...) {
    next_ = count_;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!thrown_) thrown_ = std::current_exception();
  }
}

void Workers::help(int worker) {
  unsigned seen = 0;
  for (;;) {
    for (int look = 0; look < kPatience && jobs_ == seen; ++look) hwy::Pause();
    if (jobs_ == seen) {
      std::unique_lock<std::mutex> lock(mutex_);
      ++asleep_;
      wake_.wait(lock, [&] { return jobs_ != seen; });
      --asleep_;
    }
    seen = jobs_;
    if (stop_) return;
    ++inside_;
    if (open_) take_pieces(worker);
    --inside_;
  }
}

}  // namespace palpate
