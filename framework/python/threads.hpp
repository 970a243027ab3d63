// SPDX-License-Identifier: MIT
// How threads of Python, forked processes and the end of the interpreter get on with objects of C++.
#pragma once

#include <palpate/error.hpp>

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

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
  /// thread is at work any more; those threads, and all that call later, then wait for the end of the process. Throws
  /// what a signal raises, as Ctrl-C does: then the process ends without the calls that still work.
  void end() {
    last_ = std::this_thread::get_id();
    ending_ = true;
    while (inside_ > depth_) {
      PyThreadState* const state = PyEval_SaveThread();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      PyEval_RestoreThread(state);
      if (PyErr_CheckSignals() == 0) continue;
      // They may not outlive what the process destroys at its end.
      ::on_exit([](int status, void*) { static_cast<void>(std::fflush(nullptr)), ::_exit(status); }, nullptr);
      throw pybind11::error_already_set();
    }
  }

  /// Calls `function(number)` of Python from within a call, with Python's lock. Throws what it raises. The end of the
  /// interpreter does not wait for it: then this thread never returns from here.
  void call_back(const pybind11::object& function, int number) {
    Away away;
    PyObject* const result = PyObject_CallFunction(function.ptr(), "i", number);
    away.is_back = true;
    if (result == nullptr) throw pybind11::error_already_set();
    Py_DECREF(result);
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

  /// A thread that is called back: at work it does not count. Has Python's lock where it begins and ends.
  struct Away {
    Away() : depth(std::exchange(depth_, 0)) { all().inside_ -= depth; }
    ~Away() {
      // Unless it is back, Python is unwinding the stack: see Calls.
      if (is_back && all().ended()) PyEval_SaveThread();
      if (!is_back || all().ended()) all().wait_for_end();
      depth_ = depth;
      all().inside_ += depth;
    }
    Away(const Away&) = delete;
    Away& operator=(const Away&) = delete;

    int depth;
    bool is_back = false;
  };

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

/// For a long call without Python's lock: throws what a signal raises, as Ctrl-C does, and once the interpreter ends.
inline void check_signals() {
  if (Calls::all().ended()) throw Error("palpate", "the Python interpreter is shutting down", {}, Error::Kind::run);
  const pybind11::gil_scoped_acquire held;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

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
      throw Error(place, "was opened by the parent of this forked process",
                  "open it in the child after the parent has closed it", Error::Kind::run);
    }
    unlocked_.emplace();
    lock_ = std::unique_lock(owned.mutex_);
  }

 private:
  std::optional<Unlocked> unlocked_;
  std::unique_lock<std::mutex> lock_;  // unlocked first
};

}  // namespace palpate
