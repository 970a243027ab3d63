// SPDX-License-Identifier: MIT
// `palpate watch` as a program that asks it sees it; what a browser makes of its pages is looked at in tests/report.
#include "support/programs.hpp"
#include "system/shell.hpp"
#include "system/watching.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <fstream>

namespace palpate {
namespace {

using nlohmann::json;
using test::Address;
using test::Answer;
using test::eventually;

class WatchedRun : public Shell {
 protected:
  /// `palpate watch` with `words`, and the address that it prints.
  Address watch(const Words& words) {
    server_ = begin(Words{"watch"} + words);
    EXPECT_TRUE(eventually([&] { return server_->out().find('\n') != std::string::npos || !server_->running(); }));
    return Address(server_->out());
  }

  /// A run of 17 taps of which the first `taps` are recorded, as if it were at the next one.
  fs::path under_way(std::size_t taps, const Words& more = {}) {
    const fs::path directory = ran(more);
    fs::remove(directory / "summary.json");
    lines_ = lines_of(part_of(directory, "tap"));
    begun_ = test::record_until(text_of(directory / "record.jsonl"), 0);
    write(directory / "record.jsonl", begun_);
    record(directory, 0, taps);
    return directory;
  }
  /// Appends recorded taps from one number up to another.
  void record(const fs::path& directory, std::size_t from, std::size_t to) const {
    for (std::size_t i = from; i < to; ++i) append(directory, lines_.at(i) + "\n");
  }
  static void append(const fs::path& directory, const std::string& text) {
    std::ofstream(directory / "record.jsonl", std::ios::app | std::ios::binary) << text << std::flush;
  }

  /// What a page lacks that is at `at`; it waits for it.
  static json news(const Address& address, const std::string& at, const std::string& place = "") {
    Answer answer;
    EXPECT_TRUE(eventually([&] { return (answer = address.get(place + "news?at=" + at)).status != 204; }));
    EXPECT_EQ(answer.status, 200);
    return answer.status == 200 ? json::parse(answer.body) : json();
  }
  json data(const Address& address, const std::string& place = "") const { return unpacked(address.get(place).body); }
  /// The same once it begins with so many moments: on a busy machine a page is not kept waiting for all of them.
  json data(const Address& address, std::size_t moments, const std::string& place = "") const {
    json out;
    EXPECT_TRUE(eventually([&] {
      out = data(address, place);
      return out.contains("moments") && out.at("moments").size() >= moments;
    }));
    EXPECT_EQ(out.at("moments").size(), moments);
    return out;
  }
  /// The data of a page.
  json unpacked(const std::string& page) const {
    const fs::path file = write("page.html", page);
    const Ended ended = test::run_program(
        {"python3", "-c",
         "import base64, re, sys, zlib\n"
         "packed = re.search(r'id=\"data\">([^<]*)<', open(sys.argv[1], encoding='utf-8').read()).group(1)\n"
         "sys.stdout.write(zlib.decompress(base64.b64decode(packed)).decode())",
         file.string()},
        here());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return json::parse(ended.out);
  }
  Ended end() const {
    server_->signal(SIGTERM);
    return server_->wait();
  }

  std::unique_ptr<test::Child> server_;
  std::vector<std::string> lines_;
  std::string begun_;  ///< what is recorded before the first tap
};

TEST_F(WatchedRun, HasAnAddressThatNobodyCanGuessOnThisMachineAlone) {
  const fs::path directory = ran("taps=3");
  const Address one = watch({directory});
  EXPECT_THAT(server_->out(), testing::MatchesRegex("http://127\\.0\\.0\\.1:[0-9]+/[0-9a-f]{32}/\n"));
  EXPECT_EQ(one.listening(), std::vector<std::string>{"0100007F"}) << "127.0.0.1 as the kernel writes it";
  EXPECT_EQ(server_->err(), "");
  EXPECT_EQ(end().status, 0);
  const Address other = watch({directory, "--bind", "0.0.0.0"});
  EXPECT_NE(other.token(), one.token());
  EXPECT_EQ(other.listening(), std::vector<std::string>{"00000000"});
  EXPECT_THAT(server_->err(), HasSubstr("anyone who can reach 0.0.0.0 and has this address can see the run"));
}

TEST_F(WatchedRun, IsShownToWhoHasTheAddressAndNothingElseIsToAnybody) {
  const fs::path directory = ran("taps=3");
  const Address address = watch({directory});
  const std::string root = "/" + address.token() + "/";
  std::string other = root;
  other[1] = other[1] == '0' ? '1' : '0';
  const auto host = [](const std::string& name) { return "Host: " + name + "\r\n"; };
  const std::string own = host("127.0.0.1:" + std::to_string(address.port()));
  const auto status = [&](const std::string& request) {
    const Answer answer = address.ask(request);
    EXPECT_EQ(answer.status == 200, !answer.body.empty()) << request;
    EXPECT_THAT(answer.head, HasSubstr("Cache-Control: no-store")) << request;
    EXPECT_THAT(answer.head, HasSubstr("X-Content-Type-Options: nosniff")) << request;
    EXPECT_THAT(answer.head, HasSubstr("Referrer-Policy: no-referrer")) << request;
    EXPECT_THAT(answer.head, HasSubstr("frame-ancestors 'none'")) << request;
    return answer.status;
  };
  const auto get = [&](const std::string& target, const std::string& names) {
    return status("GET " + target + " HTTP/1.1\r\n" + names + "\r\n");
  };
  EXPECT_EQ(get(root, own), 200);
  EXPECT_EQ(get(root, host("localhost:8000")), 200) << "a tunnel has a port of its own";
  EXPECT_EQ(get(root, host("[::1]:8000")), 200);
  const Words strangers{"/",
                        "//",
                        other,
                        other + "news?at=1.0.0",
                        "/" + address.token().substr(1) + "/",
                        "/x" + root,
                        "/" + address.token() + "0/",
                        "/favicon.ico"};
  for (const std::string& target : strangers) {
    EXPECT_EQ(get(target, own), 403) << target;
  }
  for (const char* name :
       {"evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost.evil.example", "8.8.8.8", ""}) {
    EXPECT_EQ(get(root, host(name)), 403) << name;
  }
  EXPECT_EQ(get(root, ""), 403) << "without a host";
  EXPECT_EQ(get(root, own + own), 403) << "with two";
  for (const char* rest : {"config.yaml", "record.jsonl", "report.html", "../", "..%2f", "%2e%2e/",
                           "../../../etc/passwd", "jobs/", "jobs/../", ".", "news/", "/etc/passwd"}) {
    EXPECT_EQ(get(root + rest, own), 404) << rest;
  }
  EXPECT_EQ(get("/" + address.token(), own), 404);
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "CONNECT", "BREW"})
    EXPECT_EQ(status(method + (" " + root) + " HTTP/1.1\r\n" + own + "\r\n"), 405) << method;
  EXPECT_EQ(status("POST " + root + " HTTP/1.1\r\n" + own + "Content-Length: 5\r\n\r\nhello"), 405);
  // What is no request has no answer, and others are served on.
  for (const std::string& noise : {std::string("nonsense\r\n\r\n"), "GET / HTTP/1.1\r\nX: " + std::string(99999, 'x')})
    EXPECT_EQ(address.ask(noise).body, "");
  EXPECT_EQ(get(root, own), 200);
}

TEST_F(WatchedRun, HasThePageOfItsReportWhichMayAskItsOwnServerAlone) {
  const fs::path directory = ran("taps=6");
  const Address address = watch({directory});
  data(address, 7);
  const std::string page = address.get("").body;
  EXPECT_THAT(page, HasSubstr("; connect-src 'self'\""));
  ASSERT_EQ(palpate({"report", directory}).status, 0);
  const std::string report = text_of(directory / "report.html");
  EXPECT_THAT(report, Not(HasSubstr("connect-src")));
  const auto script = [](const std::string& text) { return text.substr(text.rfind("<script>")); };
  EXPECT_TRUE(script(page) == script(report)) << "there is one page, not two";
  json shown = unpacked(page);
  EXPECT_EQ(shown.at("moments").size(), 7U);
  shown.erase("live");
  EXPECT_EQ(shown, unpacked(report));
}

TEST_F(WatchedRun, TellsOfATapWhenItsLineIsWholeWhatTheReportWouldHave) {
  const fs::path directory = under_way(5);
  const Address address = watch({directory});
  const json begun = data(address, 6);
  const std::string at = begun.at("live");
  append(directory, lines_.at(5).substr(0, 40));
  EXPECT_EQ(address.get("news?at=" + at + "&now").status, 204) << "half a line is no tap";
  append(directory, lines_.at(5).substr(40) + "\n");
  const json sixth = news(address, at);
  EXPECT_EQ(sixth.at("moments").size(), 1U);
  EXPECT_EQ(sixth.at("taps").size(), 1U);
  EXPECT_EQ(sixth.at("shown"), json({6}));
  record(directory, 6, 9);
  json rest = news(address, sixth.at("at"));
  json moments = begun.at("moments");
  moments.push_back(sixth.at("moments").at(0));
  for (;;) {
    for (const json& one : rest.at("moments")) moments.push_back(one);
    if (moments.size() == 10) break;
    rest = news(address, rest.at("at"));
  }
  const json whole = data(address, 10);  // which is computed alike, and compared with the report elsewhere
  EXPECT_EQ(moments, whole.at("moments"));
  EXPECT_EQ(rest.at("curves"), whole.at("curves"));
  EXPECT_EQ(rest.at("warnings"), whole.at("warnings"));
}

TEST_F(WatchedRun, BeginsBeforeThereIsATapAndSaysWhatItWaitsFor) {
  const fs::path directory = under_way(0);
  fs::remove(directory / "record.jsonl");
  const Address address = watch({directory});
  const json begun = data(address);
  EXPECT_THAT(begun.at("waiting").get<std::string>(), HasSubstr("No tap is recorded yet"));
  EXPECT_EQ(begun.at("name"), "object_i");
  append(directory, begun_);
  record(directory, 0, 1);
  EXPECT_EQ(news(address, begun.at("live")).at("anew"), true);
  data(address, 2);
}

TEST_F(WatchedRun, GoesOnWhereItWasKilledAndCarriedOn) {
  const fs::path directory = under_way(5);
  append(directory, "{\"tap\": 6, \"half a li");
  const Address address = watch({directory});
  json at = data(address, 6);
  std::size_t moments = 6;
  at["at"] = at.at("live");
  ASSERT_EQ(resume(directory).status, 0);
  while (moments < 18 || at.at("state") != "done") {
    at = news(address, at.at("at"));
    ASSERT_FALSE(at.contains("anew"));
    moments += at.at("moments").size();
  }
  EXPECT_EQ(moments, 18U);
  EXPECT_EQ(at.at("summary").at("stop_reason"), "tap budget");
}

TEST_F(WatchedRun, SaysWhatIsWrongWithARecordAndGoesOnOnceItIsPutRight) {
  const fs::path directory = under_way(5);
  const Address address = watch({directory});
  const std::string at = data(address, 6).at("live");
  const std::string good = text_of(directory / "record.jsonl");
  append(directory, "no JSON\n");
  const json trouble = news(address, at);
  EXPECT_THAT(trouble.at("trouble").get<std::string>(), HasSubstr("record.jsonl:9: is not a JSON object"));
  write(directory / "record.jsonl", good);
  EXPECT_EQ(news(address, trouble.at("at")).at("anew"), true);
  data(address, 6);
}

TEST_F(WatchedRun, TellsAPageAtAPlaceThatIsNoneToBeginAnew) {
  const fs::path directory = under_way(5);
  const Address address = watch({directory});
  const std::string now = data(address, 6).at("live");
  EXPECT_EQ(now.substr(0, 4), "1.6.");
  for (const char* at : {"1.-99999999.1", "1.-1.1", "-1.1.1", "1.+1.1", "1.1", "1.1.1.", "1..1", "", "99999999999.1.1"})
    EXPECT_EQ(news(address, at).at("anew"), true) << at;
  EXPECT_EQ(news(address, "1.5.0").at("moments").size(), 1U) << "it is there still";
}

TEST_F(WatchedRun, IsShownToWhoHasTheAddressHoweverManyConnectionsWithoutItAreOpen) {
  const Address address = watch({ran("taps=3")});
  std::vector<std::unique_ptr<test::Connection>> open;
  for (int i = 0; i < 100; ++i)
    open.push_back(std::make_unique<test::Connection>(address.port(), i % 2 == 0 ? "" : "GET /0123 HTTP/1.1\r\nHo"));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(address.get("").status, 200);
  std::vector<std::unique_ptr<test::Connection>> waiting;
  for (int i = 0; i < 20; ++i)
    waiting.push_back(address.begin("news?at=" + data(address).at("live").get<std::string>()));
  for (int i = 0; i < 100; ++i) open.push_back(std::make_unique<test::Connection>(address.port(), ""));
  EXPECT_EQ(address.get("").status, 200);
  EXPECT_EQ(open.front()->rest(), "") << "the oldest were closed";
}

TEST_F(WatchedRun, EndsAtOnceWhileAPageWaits) {
  const fs::path directory = under_way(5);
  const Address address = watch({directory});
  const std::string at = data(address, 6).at("live");
  for (const int signal : {SIGTERM, SIGINT}) {
    const Address one = signal == SIGTERM ? address : watch({directory});
    const std::string where = signal == SIGTERM ? at : data(one, 6).at("live").get<std::string>();
    const auto waiting = one.begin("news?at=" + where);
    one.get("");  // so that the question before it was taken in
    server_->signal(signal);
    const Ended ended = server_->wait();
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.err, "");
    EXPECT_EQ(waiting->rest(), "") << "nothing is said, and the connection is closed";
  }
}

TEST_F(WatchedRun, TakesThePortThatIsAskedForAndSaysWhereItCannot) {
  const fs::path directory = ran("taps=3");
  const Address first = watch({directory});
  const std::string port = std::to_string(first.port());
  EXPECT_THAT(refused({"watch", directory, "--port", port}, 1),
              HasSubstr("port " + port + ": cannot be opened for listening"));
  EXPECT_EQ(end().status, 0);
  EXPECT_EQ(watch({directory, "--port", port}).port(), first.port());
  EXPECT_THAT(refused({"watch", directory, "--bind", "here"}), HasSubstr("--bind: 'here' is not an address"));
  EXPECT_THAT(refused({"watch", "nowhere"}), HasSubstr("nowhere"));
}

TEST_F(WatchedRun, OfASweepFillsUpAndHasAPageForEachJobAndForNothingElse) {
  const fs::path directory = swept("seed=range(0,3) taps=4");
  std::vector<std::string> records;
  for (int job = 0; job < 3; ++job) {
    records.push_back(text_of(job_of(directory, job) / "record.jsonl"));
    if (job > 0) test::forget_end(job_of(directory, job));
  }
  const Address address = watch({directory});
  json begun = data(address);
  const auto states = [](const json& sweep) {
    std::vector<std::string> out;
    for (const json& job : sweep.at("jobs")) out.push_back(job.at("state"));
    return out;
  };
  EXPECT_THAT(states(begun), ElementsAre("done", "unfinished", "unfinished"));
  write(job_of(directory, 1) / "record.jsonl", records[1]);
  const json then = news(address, begun.at("live"));
  EXPECT_THAT(states(then.at("sweep")), ElementsAre("done", "done", "unfinished"));
  const std::string id = begun.at("jobs").at(1).at("id");
  const json job = data(address, 5, "jobs/" + id + "/");
  EXPECT_EQ(job.at("id"), id);
  EXPECT_EQ(address.get("jobs/" + id + "/news?at=" + job.at("live").get<std::string>() + "&now").status, 204);
  const Words nowhere{"jobs/000000000000/",
                      "jobs/../",
                      "jobs/" + id,
                      "jobs/" + id + "/record.jsonl",
                      "jobs/" + id + "/../../config.yaml",
                      "jobs//",
                      "jobs/" + id + "/jobs/" + id + "/"};
  for (const std::string& place : nowhere) {
    EXPECT_EQ(address.get(place).status, 404) << place;
  }
}

TEST_F(WatchedRun, OfACommandWithWatchIsServedByAProcessThatOutlivesIt) {
  const Ended ended = run("--watch taps=4");
  ASSERT_EQ(ended.status, 0) << ended.err;
  ASSERT_THAT(ended.err, StartsWith("watch: http://127.0.0.1:"));
  const test::Watchers left(here());  // ends them
  ASSERT_EQ(left.count(), 1U);
  const Address address(ended.err.substr(7));
  EXPECT_TRUE(eventually([&] { return data(address).at("state") == "done"; }));
  data(address, 5);
  EXPECT_THAT(ended.out, Not(HasSubstr("http"))) << "stdout is as ever";
}

TEST_F(WatchedRun, OfAResumedRunAndASweepIsServedAsWell) {
  const fs::path directory = ran("taps=6");
  break_off(directory);
  const Ended resumed = resume(directory, "--watch");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  const Ended swept = sweep("seed=1,2 taps=3 --quiet --watch --runs sweeps");
  ASSERT_EQ(swept.status, 0) << swept.err;
  const test::Watchers left(here());
  EXPECT_EQ(left.count(), 2U);
  EXPECT_TRUE(eventually([&] { return data(Address(resumed.err.substr(7))).at("state") == "done"; }));
  EXPECT_EQ(data(Address(swept.err.substr(swept.err.find("watch: ") + 7))).at("jobs").size(), 2U);
}

TEST_F(WatchedRun, IsTheSameRunTapByTapAsOneThatNobodyWatches) {
  const fs::path alone = ran("--runs alone");
  ASSERT_EQ(run("--quiet --watch --runs watched").status, 0);
  const fs::path watched = WatchedRun::directory("watched");
  const test::Watchers left(here());
  EXPECT_EQ(left.count(), 1U);
  EXPECT_TRUE(part_of(alone, "tap") == part_of(watched, "tap"));
}

}  // namespace
}  // namespace palpate
