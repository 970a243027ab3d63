// SPDX-License-Identifier: MIT
#include "baxter/ros/bag.hpp"

#include <palpate/error.hpp>

#include <cstdio>
#include <utility>
#include <vector>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <console_bridge/console.h>
#include <ros/this_node.h>
#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Float64.h>
#include <visualization_msgs/MarkerArray.h>

namespace palpate::baxter {
namespace {

/// A minute of everything that a Baxter says.
constexpr std::size_t kMostWaiting = 30000;

std::mutex current_mutex;  ///< of what the process shares
std::weak_ptr<Bag> current;

}  // namespace

Bag::Bag() = default;

Bag::~Bag() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  more_.notify_one();
  writer_.join();
}

void Bag::open(const std::string& file) {
  if (writer_.joinable()) throw Error(file, "there is a bag being recorded already", {}, Error::Kind::run);
  bag_ = std::make_unique<rosbag::Bag>();
  try {
    bag_->open(file, rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
  } catch (const std::exception& exception) {
    abandon_file();
    throw Error(file, std::string("cannot be recorded to: ") + exception.what(), "or set bag: false", Error::Kind::run);
  }
  file_ = file;
  {
    const std::lock_guard lock(mutex_);
    recording_ = true;
  }
  writer_ = std::thread([this] { run(); });
}

void Bag::abandon_file() {
  // Its destructor would try once more to write, and throw: so it is kept for ever, of which class_loader, which loads
  // its plugins, would warn when the program ends.
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  static auto* const abandoned = new std::vector<rosbag::Bag*>;
  const std::lock_guard lock(current_mutex);
  abandoned->push_back(bag_.release());
}

void Bag::add(Job job) {
  {
    const std::lock_guard lock(mutex_);
    if (!recording_) return;
    if (jobs_.size() < kMostWaiting) {
      jobs_.push_back(std::move(job));
    } else {
      give_up("the disk does not keep up");
    }
  }
  more_.notify_one();
}

void Bag::run() {
  std::deque<Job> jobs;
  bool last = false;
  try {
    while (!last) {
      {
        std::unique_lock lock(mutex_);
        more_.wait(lock, [this] { return !jobs_.empty() || finishing_; });
        last = finishing_;
        jobs.swap(jobs_);
      }
      for (Job& job : jobs) job(*bag_);
      jobs.clear();
    }
    bag_->close();
  } catch (const std::exception& exception) {
    abandon_file();
    const std::lock_guard lock(mutex_);
    give_up(exception.what());
  }
}

void Bag::give_up(const char* reason) {
  if (recording_) std::fprintf(stderr, "palpate: %s: recording ends here: %s\n", file_.c_str(), reason);
  recording_ = false;
  jobs_.clear();
}

template <class Message>
void Bag::write(const std::string& topic, const ros::Time& time, const boost::shared_ptr<const Message>& message,
                const boost::shared_ptr<ros::M_string>& header) {
  add([=](rosbag::Bag& bag) { bag.write(topic, time, message, header); });
}

template <class Message>
void Bag::write_own(const std::string& topic, const Message& message, bool latched) {
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["topic"] = topic;
  (*header)["type"] = ros::message_traits::datatype(message);
  (*header)["md5sum"] = ros::message_traits::md5sum(message);
  (*header)["message_definition"] = ros::message_traits::definition(message);
  (*header)["callerid"] = ros::this_node::getName();
  (*header)["latching"] = latched ? "1" : "0";
  write<Message>(topic, ros::Time::now(), boost::make_shared<const Message>(message), header);
}

#define PALPATE_RECORDED(Message)                                                                         \
  template void Bag::write(const std::string&, const ros::Time&, const boost::shared_ptr<const Message>&, \
                           const boost::shared_ptr<ros::M_string>&);
PALPATE_RECORDED(baxter_core_msgs::EndpointState)
PALPATE_RECORDED(baxter_core_msgs::AssemblyState)
PALPATE_RECORDED(baxter_core_msgs::CollisionDetectionState)
PALPATE_RECORDED(baxter_core_msgs::CollisionAvoidanceState)
PALPATE_RECORDED(baxter_core_msgs::EndEffectorProperties)
PALPATE_RECORDED(baxter_core_msgs::JointCommand)
PALPATE_RECORDED(sensor_msgs::JointState)
PALPATE_RECORDED(std_msgs::Float64)
#undef PALPATE_RECORDED
template void Bag::write_own(const std::string&, const baxter_core_msgs::JointCommand&, bool);
template void Bag::write_own(const std::string&, const sensor_msgs::PointCloud2&, bool);
template void Bag::write_own(const std::string&, const visualization_msgs::MarkerArray&, bool);

std::shared_ptr<Bag> current_bag() {
  const std::lock_guard lock(current_mutex);
  return current.lock();
}

void set_current_bag(const std::shared_ptr<Bag>& bag) {
  const std::lock_guard lock(current_mutex);
  current = bag;
}

}  // namespace palpate::baxter
