// SPDX-License-Identifier: MIT
#include "baxter/ros/bag.hpp"

#include "baxter/error_texts.hpp"

#include <cstdio>
#include <mutex>
#include <utility>
#include <vector>

#include <console_bridge/console.h>
#include <boost/asio/post.hpp>

namespace palpate::baxter {
namespace {

/// Number of messages of a Baxter in one minute.
constexpr int kMostWaiting = 30000;

}  // namespace

Bag::~Bag() {
  if (!writer_) return;
  boost::asio::post(*writer_, [this] { attempt([](rosbag::Bag& bag) { bag.close(); }); });
  writer_->join();
}

void Bag::open(const std::string& file) {
  if (writer_) throw robot_error(file, "a bag is already being recorded");
  file_ = file;
  bag_ = std::make_unique<rosbag::Bag>();
  try {
    bag_->open(file, rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
  } catch (const std::exception& exception) {
    abandon_file();
    throw robot_error(file, fmt::format("cannot be recorded to: {}", exception.what()), "or set bag: false");
  }
  writer_.emplace(1);
  recording_ = true;
}

void Bag::abandon_file() {
  // The destructor of the file would try to write again and throw. So the object is never destroyed. class_loader,
  // which loads rosbag's plugins, would warn about that at the end of the program, so its warnings are switched off.
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  static auto* const abandoned = new std::vector<std::unique_ptr<rosbag::Bag>>;
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  abandoned->push_back(std::move(bag_));
}

void Bag::add(Job job) {
  if (!recording_) return;
  if (++waiting_ > kMostWaiting) return give_up("the disk is too slow");
  boost::asio::post(*writer_, [this, job = std::move(job)] {
    --waiting_;
    if (recording_) attempt(job);
  });
}

void Bag::attempt(const Job& job) {
  if (!bag_) return;
  try {
    job(*bag_);
  } catch (const std::exception& exception) {
    abandon_file();
    give_up(exception.what());
  }
}

void Bag::give_up(const char* reason) {
  if (!recording_.exchange(false)) return;
  std::fprintf(stderr, "palpate: %s: recording ends here: %s\n", file_.c_str(), reason);
}

}  // namespace palpate::baxter
