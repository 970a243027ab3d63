// SPDX-License-Identifier: MIT
// How threads of Python, forked processes and the end of the interpreter get on with objects of C++.
#pragma once

#include <palpate/error.hpp>

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <pthread.h>
#include <unistd.h>

namespace palpate {

/// The calls that work without Python's lock. Once the interpreter ends, no thread may ask for that lock again: CPython
/// 3.11 ends such a thread by unwinding its stack, which C++ answers with std::terminate().
class Calls {
 public:
  static Calls& all() {
    static Calls* const one = new Calls;
    return *one;
  }

  /// Whether the calling thread, that has or had Python's lock, is never to have it again.
  bool ended() const { return ending_ && std::this_thread::get_id() != last_; }

  /// For the end of the interpreter, from the thread that ends it, with Python's lock. Returns when no call of another
  /// thread is at work any more; those threads, and all that call later, then wait for the end of the process.
  void end() {
    last_ = std::this_thread::get_id();
    ending_ = true;
    PyThreadState* const state = PyEval_SaveThread();
    while (inside_ > depth_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(state);
  }

 private:
  friend class Unlocked;

  Calls() {
    // The child of a fork has none of the other threads.
    ::pthread_atfork(nullptr, nullptr, [] { all().inside_ = depth_; });
  }
  void enter() {
    ++depth_;
    ++inside_;
  }
  void leave() {
    --depth_;
    --inside_;
  }
  [[noreturn]] void wait_for_end() {
    inside_ -= depth_;
    for (;;) ::pause();
  }

  static inline thread_local int depth_ = 0;  ///< calls of this thread: one that is called back may call again
  std::atomic<int> inside_{0};
  std::atomic<bool> ending_{false};
  std::thread::id last_;
};

/// Lets other threads of Python go on for its lifetime.
class Unlocked {
 public:
  Unlocked() {
    Calls::all().enter();
    state_ = PyEval_SaveThread();
    if (Calls::all().ended()) Calls::all().wait_for_end();
  }
  ~Unlocked() {
    if (Calls::all().ended()) Calls::all().wait_for_end();
    PyEval_RestoreThread(state_);
    Calls::all().leave();
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// An object that one thread at a time works with, in the process that made it.
class Owned {
 public:
  /// Returns false in the child of a fork, which has none of the threads that the object may need, and a copy of its
  /// lock that nobody may be left to unlock.
  bool is_here() const { return process_ == ::getpid(); }

 private:
  friend class Turn;
  pid_t process_ = ::getpid();
  std::mutex mutex_;
};

/// A thread's turn with such an object, without Python's lock. Throws Error in the child of a fork.
class Turn {
 public:
  explicit Turn(Owned& owned, const std::string& place = "experiment") {
    if (!owned.is_here()) {
      throw Error(place, "was opened by the process that this one was forked from",
                  "open it in the child, once the parent has closed it", Error::Kind::run);
    }
    unlocked_.emplace();
    lock_ = std::unique_lock(owned.mutex_);
  }

 private:
  std::optional<Unlocked> unlocked_;
  std::unique_lock<std::mutex> lock_;  // unlocked first
};

}  // namespace palpate
