// SPDX-License-Identifier: MIT
// Access to C++ objects from Python threads, from forked processes, and while the interpreter ends.
#pragma once

#include <palpate/error.hpp>

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <pthread.h>
#include <unistd.h>

namespace palpate {

/// Counts the calls from Python that run without the GIL (Python's global interpreter lock). After the interpreter has
/// ended, no thread may request the GIL: CPython 3.11 would unwind the stack of the thread, and C++ would then call
/// std::terminate().
class CallsWithoutGil {
 public:
  static CallsWithoutGil& all() {
    static CallsWithoutGil* const one = new CallsWithoutGil;
    return *one;
  }

  /// Returns whether another thread is ending the interpreter. The calling thread can then never get the GIL again.
  bool ended() const { return ending_ && std::this_thread::get_id() != last_; }

  /// Waits until no other thread is in a call. The thread that ends the interpreter must call this function while it
  /// holds the GIL. From then on, any other thread that returns from a call or begins a call waits until the process
  /// ends. If a signal such as Ctrl-C arrives, throws the exception of the signal. The process then ends without
  /// waiting for the remaining calls.
  void end() {
    last_ = std::this_thread::get_id();
    ending_ = true;
    while (inside_ > depth_) {
      PyThreadState* const state = PyEval_SaveThread();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      PyEval_RestoreThread(state);
      if (PyErr_CheckSignals() == 0) continue;
      // The remaining calls must not run while exit() destroys static objects, so the process ends before exit()
      // destroys them.
      ::on_exit([](int status, void*) { static_cast<void>(std::fflush(nullptr)), ::_exit(status); }, nullptr);
      throw pybind11::error_already_set();
    }
  }

  /// Calls the Python function `function(number)` from within a call. The caller must hold the GIL. Throws the
  /// exception of the function. The end of the interpreter does not wait for the function. If the interpreter ends
  /// while the function runs, this thread never returns.
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
    // A forked child has only the thread that called fork(), so only the calls of this thread count in the child.
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

  /// A call from C++ to a Python function. During this call, the thread does not count as inside a call from Python.
  /// The thread must hold the GIL at the beginning and at the end.
  struct Callback {
    Callback() : depth(std::exchange(depth_, 0)) { all().inside_ -= depth; }
    ~Callback() {
      // If the function did not return, CPython is unwinding the stack of this thread.
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

  /// number of nested calls in this thread; more than 1 if a callback calls the module again
  static inline thread_local int depth_ = 0;
  std::atomic<int> inside_{0};  ///< number of calls in all threads
  std::atomic<bool> ending_{false};
  std::thread::id last_;  ///< the thread that ends the interpreter
};

/// Releases the GIL while the object exists, so that other Python threads can run.
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

/// Throws the exception of a signal, such as Ctrl-C, during a long call without the GIL. Throws Error if the
/// interpreter is ending.
inline void check_signals() {
  if (CallsWithoutGil::all().ended())
    throw Error("palpate", "the Python interpreter is shutting down", {}, Error::Kind::run);
  const pybind11::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

/// Lock of an object. Only one thread at a time may use the object, and only in the process that created the object.
class ObjectLock {
 public:
  /// Returns whether this is the process that created the object, and not the child of a fork. In the child, threads
  /// that the object may need do not exist, and the lock may stay locked for ever.
  bool is_here() const { return process_ == ::getpid(); }

 private:
  friend class ObjectGuard;
  pid_t process_ = ::getpid();
  std::mutex mutex_;
};

/// Releases the GIL and holds an ObjectLock while the object exists. The constructor throws Error with `place` in the
/// child of a fork.
class ObjectGuard {
 public:
  explicit ObjectGuard(ObjectLock& lock, const std::string& place = "experiment") {
    if (!lock.is_here())
      throw Error(place, "was opened by the parent of this forked process",
                  "open it in the child after the parent has closed it", Error::Kind::run);
    no_gil_.emplace();
    lock_ = std::unique_lock(lock.mutex_);
  }

 private:
  std::optional<GilRelease> no_gil_;
  std::unique_lock<std::mutex> lock_;  ///< declared after no_gil_, because the lock must be released first
};

}  // namespace palpate
