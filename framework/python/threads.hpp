// SPDX-License-Identifier: MIT
// Access to C++ objects from threads of Python, from forked processes and at the end of the interpreter.
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

/// Calls from Python that run without the GIL, Python's global lock. After the end of the interpreter no thread may
/// take the GIL again: CPython 3.11 unwinds the stack of such a thread, for which C++ calls std::terminate().
class CallsWithoutGil {
 public:
  static CallsWithoutGil& all() {
    static CallsWithoutGil* const one = new CallsWithoutGil;
    return *one;
  }

  /// Returns whether the interpreter ends in another thread, so that the calling thread can never take the GIL again.
  bool ended() const { return ending_ && std::this_thread::get_id() != last_; }

  /// Ends the calls. The thread that ends the interpreter calls this function, with the GIL. Returns when no other
  /// thread is in a call. These threads, and all later calls, then wait for the end of the process. Throws the
  /// exception of a signal, such as Ctrl-C; then the process ends without the remaining calls.
  void end() {
    last_ = std::this_thread::get_id();
    ending_ = true;
    while (inside_ > depth_) {
      PyThreadState* const state = PyEval_SaveThread();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      PyEval_RestoreThread(state);
      if (PyErr_CheckSignals() == 0) continue;
      // The remaining calls must not run while exit() destroys static objects.
      ::on_exit([](int status, void*) { static_cast<void>(std::fflush(nullptr)), ::_exit(status); }, nullptr);
      throw pybind11::error_already_set();
    }
  }

  /// Calls the Python function `function(number)` from within a call, with the GIL. Throws the function's exception.
  /// The end of the interpreter does not wait for the function; then this thread never returns.
  void call_back(const pybind11::object& function, int number) {
    Callback callback;
    PyObject* const result = PyObject_CallFunction(function.ptr(), "i", number);
    callback.has_returned = true;
    if (result == nullptr) throw pybind11::error_already_set();
    Py_DECREF(result);
  }

 private:
  friend class GilRelease;

  CallsWithoutGil() {
    // The child of a fork has only the forking thread.
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

  /// A call back to Python, during which the thread does not count as inside. The thread has the GIL at the beginning
  /// and at the end.
  struct Callback {
    Callback() : depth(std::exchange(depth_, 0)) { all().inside_ -= depth; }
    ~Callback() {
      // Without a return, CPython is unwinding the stack of this thread.
      if (has_returned && all().ended()) PyEval_SaveThread();
      if (!has_returned || all().ended()) all().wait_for_end();
      depth_ = depth;
      all().inside_ += depth;
    }
    Callback(const Callback&) = delete;
    Callback& operator=(const Callback&) = delete;

    int depth;
    bool has_returned = false;
  };

  static inline thread_local int depth_ = 0;  ///< nested calls of this thread, because a callback may call again
  std::atomic<int> inside_{0};                ///< calls of all threads
  std::atomic<bool> ending_{false};
  std::thread::id last_;  ///< the thread that ends the interpreter
};

/// Releases the GIL for its lifetime, so that other threads of Python can run.
class GilRelease {
 public:
  GilRelease() {
    CallsWithoutGil::all().enter();
    state_ = PyEval_SaveThread();
    if (CallsWithoutGil::all().ended()) CallsWithoutGil::all().wait_for_end();
  }
  ~GilRelease() {
    if (CallsWithoutGil::all().ended()) CallsWithoutGil::all().wait_for_end();
    PyEval_RestoreThread(state_);
    CallsWithoutGil::all().leave();
  }
  GilRelease(const GilRelease&) = delete;
  GilRelease& operator=(const GilRelease&) = delete;

 private:
  PyThreadState* state_;
};

/// Throws the exception of a signal, such as Ctrl-C, from a long call without the GIL. Throws Error once the
/// interpreter ends.
inline void check_signals() {
  if (CallsWithoutGil::all().ended())
    throw Error("palpate", "the Python interpreter is shutting down", {}, Error::Kind::run);
  const pybind11::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

/// Lock of an object that one thread at a time may use, in the process that created it.
class ObjectLock {
 public:
  /// Returns false in the child of a fork. The child lacks threads that the object may need, and its copy of the lock
  /// may stay locked for ever.
  bool is_here() const { return process_ == ::getpid(); }

 private:
  friend class ObjectGuard;
  pid_t process_ = ::getpid();
  std::mutex mutex_;
};

/// Holds an ObjectLock, without the GIL. Throws Error, with `place`, in the child of a fork.
class ObjectGuard {
 public:
  explicit ObjectGuard(ObjectLock& lock, const std::string& place = "experiment") {
    if (!lock.is_here()) {
      throw Error(place, "was opened by the parent of this forked process",
                  "open it in the child after the parent has closed it", Error::Kind::run);
    }
    no_gil_.emplace();
    lock_ = std::unique_lock(lock.mutex_);
  }

 private:
  std::optional<GilRelease> no_gil_;
  std::unique_lock<std::mutex> lock_;  ///< after no_gil_, because it must be released first
};

}  // namespace palpate
