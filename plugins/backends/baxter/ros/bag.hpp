// SPDX-License-Identifier: MIT
// A rosbag of what is heard, sent and shown. Files are written by a thread of their own: a disk that takes its time
// must not hold up the set-points of an arm in motion.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <ros/datatypes.h>
#include <ros/time.h>
#include <boost/shared_ptr.hpp>

namespace rosbag {
class Bag;
}

namespace palpate::baxter {

class Bag {
 public:
  Bag();
  ~Bag();  ///< writes what is waiting, and the index
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// From now on write() writes. Throws Error.
  void open(const std::string& file);

  /// Nothing before open(), and after an error, which is told once. For the messages of this backend. `header` is the
  /// connection's as the sender sent it.
  template <class Message>
  void write(const std::string& topic, const ros::Time& time, const boost::shared_ptr<const Message>& message,
             const boost::shared_ptr<ros::M_string>& header);

  /// The same for a message of our own.
  template <class Message>
  void write_own(const std::string& topic, const Message& message, bool latched);

 private:
  using Job = std::function<void(rosbag::Bag&)>;
  void add(Job job);
  void run();
  void abandon_file();
  void give_up(const char* reason);  ///< with mutex_ held

  std::string file_;
  std::unique_ptr<rosbag::Bag> bag_;
  std::mutex mutex_;
  std::condition_variable more_;
  std::deque<Job> jobs_;    ///< guarded by mutex_
  bool recording_ = false;  ///< guarded by mutex_
  bool finishing_ = false;  ///< guarded by mutex_
  std::thread writer_;
};

/// The bag of the process' connection; none without a connection.
std::shared_ptr<Bag> current_bag();
void set_current_bag(const std::shared_ptr<Bag>& bag);

}  // namespace palpate::baxter
