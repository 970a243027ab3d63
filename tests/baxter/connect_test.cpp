// SPDX-License-Identifier: MIT
// Connection to a Baxter over a real ROS network: missing parts are reported in one line within five seconds, and
// nothing remains afterwards.
#include "baxter/ros/connect.hpp"

#include "child_run.hpp"
#include "command_lines.hpp"
#include "robot_lab.hpp"
#include "support/ports.hpp"
#include "support/programs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>

namespace palpate::test {
namespace {

using baxter::connect;
using baxter::ConnectionOptions;
using baxter::Joints;
using baxter::Robot;
using baxter::Snapshot;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

constexpr double kPromised = 5.0;  // s
const std::vector<std::string> kNoRos = {"ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "ROS_IPV6"};

std::vector<std::string> with(std::vector<std::string> environment, const std::vector<std::string>& more) {
  environment.insert(environment.end(), more.begin(), more.end());
  return environment;
}

/// Returns the error of connect(), and checks that it comes in time.
std::string refusal(const std::vector<std::string>& environment, const ConnectionOptions& options = {}) {
  const ChildResult result = run_in_child(environment, [&] {
    connect(options);
    return std::string("connected");
  });
  EXPECT_LE(result.seconds, kPromised) << result.printed;
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.printed.find('\n'), std::string::npos) << result.printed;
  return result.printed;
}

std::string refusal_of(const std::string& master, const std::vector<std::string>& more = {"ROS_IP=127.0.0.1"}) {
  return refusal(with(with(kNoRos, {"ROS_MASTER_URI=" + master}), more));
}

/// A TCP port of this machine with a listener that is not a ROS master.
class Stranger {
 public:
  /// `guests`: number of open connections, so that further packets are dropped.
  explicit Stranger(int backlog, int guests = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), address_(address_of(free_port())) {
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_) != 0 ||
        listen(socket_, backlog) != 0) {
      throw std::runtime_error("no port");
    }
    for (int i = 0; i < guests; ++i) {
      guests_.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
      ::connect(guests_.back(), reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
    }
  }
  ~Stranger() {
    close(socket_);
    for (const int guest : guests_) close(guest);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  std::string uri() const { return "http://127.0.0.1:" + std::to_string(ntohs(address_.sin_port)); }

 private:
  int socket_;
  sockaddr_in address_;
  std::vector<int> guests_;
};

/// Sends a signal to one process. Numbers below 1 would address many processes.
void send(int signal, int pid) {
  if (pid > 1) kill(pid, signal);
}

/// Returns the command line of a robot in real time.
std::vector<std::string> in_real_time(const std::vector<std::string>& more = {}) {
  return with({object_i(), "backend=fake_baxter", "scene=object_i_arm"}, more);
}

TEST(Connect, WithoutAnEnvironmentOfRosItSaysWhatToSet) {
  EXPECT_EQ(refusal(kNoRos),
            "ROS_MASTER_URI: is not set, set it to the robot's master, http://<the robot's name>.local:11311");
  for (const std::string uri : {"localhost:11311", "http://localhost", "http://:11311", "http://localhost:99999",
                                "https://localhost:11311", "http://localhost:11311/x"}) {
    EXPECT_EQ(refusal_of(uri),
              "ROS_MASTER_URI=" + uri + ": is not of the form http://host:port, as in http://011305P0001.local:11311");
  }
}

TEST(Connect, AnAddressThatIsNotThisMachinesIsNamedBeforeAnythingIsAsked) {
  const std::string master = "http://127.0.0.1:1";
  for (const std::string ip : {"192.0.2.1", "the_desk", "0.0.0.0"}) {
    EXPECT_EQ(refusal_of(master, {"ROS_IP=" + ip}),
              "ROS_IP=" + ip +
                  ": is not an address of this machine, so the robot cannot reach it, set it to the address of the "
                  "interface on the robot's network (ip -brief address)");
  }
  EXPECT_EQ(refusal_of(master, {"ROS_IP=127.0.0.1", "ROS_HOSTNAME=localhost"}),
            "ROS_IP=127.0.0.1: is set together with ROS_HOSTNAME=localhost, unset one of them");
  EXPECT_THAT(refusal_of(master, {"ROS_HOSTNAME=no.such.host.invalid"}),
              MatchesRegex("ROS_HOSTNAME=no.such.host.invalid: does not resolve \\(.*\\), set ROS_IP to this machine's "
                           "address instead"));
}

TEST(Connect, WhereNoMasterIsItSaysHowItLookedForOne) {
  EXPECT_EQ(refusal_of("http://127.0.0.1:1"),
            "ROS_MASTER_URI=http://127.0.0.1:1: the master is not at 127.0.0.1:1 (Connection refused), start the "
            "robot, or correct the variable");
  EXPECT_THAT(
      refusal_of("http://011305P0001.invalid:11311"),
      MatchesRegex("ROS_MASTER_URI=http://011305P0001.invalid:11311: the master is on the host 011305P0001.invalid, "
                   "which does not resolve here \\(.*\\), check the cable to the robot; names in .local need mDNS "
                   "\\(libnss-mdns\\) or a line in /etc/hosts"));
}

TEST(Connect, AMasterThatDoesNotAnswerIsNotWaitedFor) {
  const Stranger taciturn(5);
  const Stranger swallows(0, 4);
  for (const Stranger* stranger : {&taciturn, &swallows}) {
    EXPECT_THAT(
        refusal_of(stranger->uri()),
        EndsWith(" does not answer in time, check that the robot is on and that no firewall blocks the connection"));
  }
}

TEST(Connect, AMasterThatNestsItsAnswerWithoutEndIsNoMaster) {
  const TemporaryFolder folder;
  const std::filesystem::path script =
      folder.write("master.py",
                   "import socket\n"
                   "server = socket.create_server(('127.0.0.1', 0))\n"
                   "print(server.getsockname()[1], flush=True)\n"
                   "while True:\n"
                   "    guest = server.accept()[0]\n"
                   "    guest.recv(65536)\n"
                   "    body = b'<params>' + 180000 * b'<value><array><data>'\n"
                   "    guest.sendall(b'HTTP/1.1 200 OK\\r\\nContent-length: %d\\r\\n\\r\\n' % len(body) + body)\n"
                   "    guest.close()\n");
  const Child master({"python3", "-SE", script.string()}, folder.path());
  ASSERT_TRUE(eventually([&] { return master.out().find('\n') != std::string::npos; }));
  const std::string port = master.out().substr(0, master.out().find('\n'));
  EXPECT_THAT(refusal_of("http://127.0.0.1:" + port), HasSubstr("the program that answers there is not ROS"));
}

TEST(Connect, ANetworkWithoutARobotIsToldByWhatNobodyPublishes) {
  const RobotLab lab;
  EXPECT_THAT(refusal(lab.environment()),
              EndsWith(": no node publishes /robot/joint_states, /robot/limb/left/endpoint_state and /robot/state, "
                       "check that it is the master of a Baxter"));
  EXPECT_THAT(lab.nodes(), ElementsAre());
}

TEST(Connect, ANodeThatDiedWithoutTakingLeaveIsNamed) {
  RobotLab lab(in_real_time());
  lab.robot().signal(SIGKILL);
  lab.robot().wait();
  EXPECT_THAT(refusal(lab.environment()),
              AllOf(StartsWith("/robot/"),
                    HasSubstr("(Connection refused), restart it, or remove its remains with rosnode cleanup")));
}

TEST(Connect, ANodeOnAHostThatDoesNotResolveIsNamedWithThatHost) {
  RobotLab lab;
  const Child robot(with({fake_baxter_file().string()}, in_real_time()), lab.folder(),
                    with(lab.environment(), {"ROS_IP", "ROS_HOSTNAME=baxter.invalid"}));
  ASSERT_TRUE(eventually([&] { return !lab.nodes().empty(); }));
  EXPECT_THAT(
      refusal(lab.environment()),
      AllOf(HasSubstr("its publisher /realtime_loop is on the host baxter.invalid, which does not resolve here ("),
            EndsWith(
                "), check the cable to the robot; names in .local need mDNS (libnss-mdns) or a line in /etc/hosts")));
}

TEST(Connect, TheRobotsInverseKinematicsIsMissedOnlyByThoseWhoWishForIt) {
  const RobotLab lab(in_real_time({"--fault", "ik_absent"}));
  EXPECT_EQ(refusal(lab.environment(), {true, false}), "connected");
  EXPECT_THAT(refusal(lab.environment(), {true, true}), HasSubstr("IKService: no node offers this service"));
}

TEST(Connect, TwiceInOneProcessOrEndedInTheMiddleItLeavesNoThreadAndNoNodeAndNotAWord) {
  const RobotLab lab(in_real_time());
  const std::vector<std::string> before = lab.nodes();
  const ChildResult twice = run_in_child(lab.environment(), [] {
    const std::string first = connect({})->read().malformed;
    const long of_roscpp = threads();
    auto robot = connect({});
    const long connected = threads();
    robot.reset();
    return first + std::to_string(connected - of_roscpp) + " " + std::to_string(threads() - of_roscpp);
  });
  EXPECT_EQ(twice.printed, "1 0");
  EXPECT_EQ(twice.status, 0);
  EXPECT_EQ(lab.nodes(), before);
  const ChildResult ended = run_in_child(lab.environment(), []() -> std::string {
    const auto robot = connect({});
    std::exit(3);
  });
  EXPECT_EQ(ended.printed, "");
  EXPECT_EQ(ended.status, 3);
  EXPECT_EQ(lab.nodes(), before);
}

TEST(Connect, AMasterThatGoesAwayIsNeitherMissedNorWaitedFor) {
  for (const int ending : {SIGKILL, SIGSTOP}) {
    RobotLab lab;
    lab.start_robot(in_real_time());
    const ChildResult result = run_in_child(lab.environment(), [&] {
      const auto robot = connect({});
      send(ending, lab.master_pid());
      const double begin = robot->read().now;
      robot->wait_until(begin + 0.5);
      return robot->read().endpoint->received > begin + 0.2 ? "goes on" : "silence";
    });
    send(SIGCONT, lab.master_pid());
    EXPECT_EQ(result.printed, "goes on");
    EXPECT_EQ(result.status, 0);
    EXPECT_LE(result.seconds, kPromised);
  }
}

TEST(Connect, AClockThatStandsStillEndsAWait) {
  RobotLab lab(in_real_time({"--rate", "5"}));
  const ChildResult result = run_in_child(lab.environment(), [&] {
    const auto robot = connect({});
    const double now = robot->read().now;
    std::string said = robot->wait_until(now + 0.1) ? "goes, " : "stands still, ";
    send(SIGSTOP, lab.robot().pid());
    said += robot->wait_until(now + 1000.0) ? "goes" : "stands still";
    send(SIGCONT, lab.robot().pid());
    return said;
  });
  EXPECT_EQ(result.printed, "goes, stands still");
}

TEST(Connect, TheRobotsInverseKinematicsFindsTheJointsOfWhereTheArmIsAndIsGivenASecond) {
  const auto solved = [](const std::vector<std::string>& fault) {
    const RobotLab lab(in_real_time(fault));
    const ChildResult result = run_in_child(lab.environment(), [] {
      const auto robot = connect({true, true});
      const Snapshot snapshot = robot->read();
      std::optional<Joints> found;
      try {
        found = robot->solve(snapshot.endpoint->pose, snapshot.joints->position);
      } catch (const Error& error) {
        return std::string(error.what());
      }
      if (!found) return std::string();
      const double gap = (*found - snapshot.joints->position).cwiseAbs().maxCoeff();
      return std::string(gap < 0.05 ? "near" : "far");
    });
    EXPECT_LE(result.seconds, kPromised);
    return result.printed;
  };
  EXPECT_EQ(solved({}), "near");
  EXPECT_EQ(solved({"--fault", "ik_slow=60"}),
            "/ExternalTools/left/PositionKinematicsNode/IKService: no answer in time");
}

TEST(Connect, ABagThatCannotBeWrittenIsAnErrorAtOnce) {
  RobotLab lab(in_real_time());
  const auto record = [&](const std::string& file) {
    return run_in_child(lab.environment(), [&] {
      const auto robot = connect({});
      robot->record(file);
      robot->wait_until(robot->read().now + 0.3);
      return std::string("recorded");
    });
  };
  EXPECT_THAT(record("/nonexistent/a.bag").printed,
              AllOf(StartsWith("/nonexistent/a.bag: cannot be recorded to: "), EndsWith(", or set bag: false")));
  EXPECT_THAT(record("/dev/full").printed, StartsWith("/dev/full: cannot be recorded to: "));
  const std::filesystem::path file = lab.folder() / "a.bag";
  EXPECT_EQ(record(file).printed, "recorded");
  EXPECT_THAT(text_of(file), AllOf(StartsWith("#ROSBAG V2.0\n"), HasSubstr("/robot/limb/left/endpoint_state"),
                                   HasSubstr("356d9dd237ce73b2667da9235f541933")));
}

// roscpp's connection thread crashes if it receives a header or a closed connection for an object that is being
// destroyed (ros_comm, issues 1939 and 2032).
TEST(AConnection, IsGivenUpAgainAndAgainWithoutEndingTheProgram) {
  RobotLab lab(in_real_time());
  const char* times = std::getenv("PALPATE_CONNECTIONS");
  const int count = times != nullptr ? std::atoi(times) : 20;
  const ChildResult result = run_in_child(with(kNoRos, lab.environment()), [&] {
    int made = 0;
    for (; made < count; ++made) connect({});
    return std::to_string(made);
  });
  EXPECT_EQ(result.status, 0) << result.printed;
  EXPECT_EQ(result.printed, std::to_string(count));
}

}  // namespace
}  // namespace palpate::test
