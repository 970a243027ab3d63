// SPDX-License-Identifier: MIT
#include "launch/parallel_children.hpp"

#include "children/child_process.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// Messages of a child: one dot per finished item; or, as its last message, an exclamation mark and the text of an
/// error.
constexpr const char* kDone = ".";
constexpr const char* kTrouble = "!";

constexpr double kListenSeconds = 0.1;  // longest wait of one call of listen()

}  // namespace

int cores() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

bool in_children(std::size_t count, int workers, const std::function<void(std::size_t)>& work,
                 const std::atomic<bool>* interrupted, const std::function<void(std::size_t)>& progress) {
  const std::size_t step = std::min(count, static_cast<std::size_t>(std::max(1, workers)));
  std::vector<std::unique_ptr<ChildProcess>> owned;
  std::vector<ChildProcess*> children;
  for (std::size_t first = 0; first < step; ++first) {
    owned.push_back(ChildProcess::fork([&](const ChildProcess::Say& say) {
      try {
        // Neighbouring items take similar times, so with a stride of `step` all children end at about the same time.
        for (std::size_t i = first; i < count; i += step) {
          work(i);
          say(kDone);
        }
      } catch (const std::exception& trouble) {  // the parent throws it again
        say(kTrouble + std::string(trouble.what()));
      }
      return 0;
    }));
    children.push_back(owned.back().get());
    if (owned.back()) continue;
    throw Error("", fmt::format("cannot start a child process for a part of the work: {}", std::strerror(errno)), {},
                Error::Kind::run);
  }
  std::size_t done = 0;
  for (bool any = step > 0; any;) {
    ChildProcess::listen(children, kListenSeconds);
    const std::size_t before = std::exchange(done, 0);
    any = false;
    for (const ChildProcess* child : children) {
      const std::string& said = child->said();
      const std::size_t dots = std::min(said.find(kTrouble), said.size());
      done += dots;
      any = any || !child->ended();
      if (child->ended() && dots < said.size()) throw Error("", said.substr(dots + 1), {}, Error::Kind::run);
    }
    if (progress && done != before) progress(done);
    if (interrupted != nullptr && interrupted->load() && done < count) return false;
  }
  if (done < count)
    throw Error("", "a child process was killed during its part of the work", "try again", Error::Kind::run);
  return true;
}

}  // namespace palpate
