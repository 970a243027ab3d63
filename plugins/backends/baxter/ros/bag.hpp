// SPDX-License-Identifier: MIT
// Rosbag of all messages that are received, sent and displayed. A separate thread writes the file, so that a slow disk
// does not delay set-points.
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
  ~Bag();  ///< writes the queued messages and the index
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// Opens the file; write() has an effect from now on. Throws Error.
  void open(const std::string& file);

  /// Queues a message with the connection header of its sender. Has no effect before open(), or after an error, which
  /// is printed once.
  template <class Message>
  void write(const std::string& topic, const ros::Time& time, const boost::shared_ptr<const Message>& message,
             const boost::shared_ptr<ros::M_string>& header) {
    add([=](rosbag::Bag& bag) { bag.write(topic, time, message, header); });
  }

  /// Queues a message of this program.
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
  std::unique_ptr<rosbag::Bag> bag_;  ///< used by the writer thread after open(); null after an error
  std::atomic<bool> recording_{false};
  std::atomic<int> waiting_{0};  ///< number of queued jobs
  std::optional<boost::asio::thread_pool> writer_;
};

}  // namespace palpate::baxter
