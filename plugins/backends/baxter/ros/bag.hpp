// SPDX-License-Identifier: MIT
// A rosbag of what is heard, sent and shown. Files are written by a thread of their own: a disk that takes its time
// must not hold up the set-points of an arm in motion.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <ros/this_node.h>
#include <rosbag/bag.h>
#include <boost/asio/thread_pool.hpp>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>

namespace palpate::baxter {

class Bag {
 public:
  Bag() = default;
  ~Bag();  ///< writes what is waiting, and the index
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// From now on write() writes. Throws Error.
  void open(const std::string& file);

  /// Nothing before open(), and after an error, which is told once. `header` is the connection's as the sender sent it.
  template <class Message>
  void write(const std::string& topic, const ros::Time& time, const boost::shared_ptr<const Message>& message,
             const boost::shared_ptr<ros::M_string>& header) {
    add([=](rosbag::Bag& bag) { bag.write(topic, time, message, header); });
  }

  /// The same for a message of our own.
  template <class Message>
  void write_own(const std::string& topic, const Message& message, bool latched) {
    const auto header = boost::make_shared<ros::M_string>();
    *header = {{"topic", topic},
               {"type", ros::message_traits::datatype(message)},
               {"md5sum", ros::message_traits::md5sum(message)},
               {"message_definition", ros::message_traits::definition(message)},
               {"callerid", ros::this_node::getName()},
               {"latching", latched ? "1" : "0"}};
    write<Message>(topic, ros::Time::now(), boost::make_shared<const Message>(message), header);
  }

 private:
  using Job = std::function<void(rosbag::Bag&)>;
  void add(Job job);
  void attempt(const Job& job);
  void abandon_file();
  void give_up(const char* reason);

  std::string file_;
  std::unique_ptr<rosbag::Bag> bag_;  ///< the writer's, once it is open; none once it is abandoned
  std::atomic<bool> recording_{false};
  std::atomic<int> waiting_{0};  ///< jobs
  std::optional<boost::asio::thread_pool> writer_;
};

}  // namespace palpate::baxter
