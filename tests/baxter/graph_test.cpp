// SPDX-License-Identifier: MIT
// Parsing of a ROS master's answers, which may come from any program, without a network.
#include "baxter/ros/graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate::baxter {
namespace {

using ::testing::ElementsAre;

std::string value(const std::string& inside) { return "<value>" + inside + "</value>"; }
std::string array(const std::string& inside) { return value("<array><data>" + inside + "</data></array>"); }
std::string text(const std::string& words) { return value("<string>" + words + "</string>"); }

std::string answer(const std::string& third) {
  return "<?xml version='1.0'?>\n<methodResponse>\n<params>\n<param>\n" +
         array(value("<int>1</int>") + text("") + third) + "\n</param>\n</params>\n</methodResponse>\n";
}

bool is_refused(const std::string& xml) {
  try {
    read_graph(xml);
  } catch (const NetworkError& trouble) {
    EXPECT_EQ(trouble.why, NetworkError::FailureCause::nonsense);
    return true;
  }
  return false;
}

TEST(AnswerOfAMaster, IsTheNetwork) {
  const std::string topic = array(text("/robot/state") + array(text("/realtime_loop") + text("/other")));
  const Graph graph = read_graph(answer(array(array(topic) + array("") + array(""))));
  EXPECT_THAT(Graph::of(graph.publishers, "/robot/state"), ElementsAre("/realtime_loop", "/other"));
  EXPECT_TRUE(graph.subscribers.empty());
}

TEST(AnswerOfAMaster, ThatIsAnotherThingIsRefused) {
  for (const std::string& xml :
       {std::string(), std::string("<value>"), std::string("<methodResponse><fault></fault></methodResponse>"),
        answer(text("no list")), answer(array(text("a") + text("b") + text("c"))), answer("").substr(0, 100)}) {
    EXPECT_TRUE(is_refused(xml)) << xml;
  }
}

TEST(AnswerOfAMaster, ThatIsNestedTooDeeplyIsRefusedBeforeItIsRead) {
  const std::string begin = "<value><array><data>";
  std::string open, closed;
  for (int i = 0; i < 180'000; ++i) open += begin;
  EXPECT_TRUE(is_refused(open));
  for (int i = 0; i < 30; ++i) closed = array(closed);
  EXPECT_TRUE(is_refused(answer(array(closed + array("") + array("")))));
}

TEST(AnswerOfAMaster, WhoseNamesHideHowDeepItIsIsRefused) {
  // The library takes the next name anywhere as the member's: each of these would nest it one level deeper.
  const std::string hollow = value("<struct><member></member></struct>") + "<name>a</name>";
  const std::string closing = value("<struct><member><name></value></name></member></struct>");
  std::string flat;
  for (int i = 0; i < 100'000; ++i) flat += hollow;
  EXPECT_TRUE(is_refused(answer(array(flat))));
  EXPECT_TRUE(is_refused(answer(array(closing))));
}

}  // namespace
}  // namespace palpate::baxter
