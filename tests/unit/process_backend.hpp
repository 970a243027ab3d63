// SPDX-License-Identifier: MIT
// What the tests of the backend `process` share: Python programs, started as a run starts them.
#pragma once

#include "support/programs.hpp"
#include "support/requests.hpp"
#include "support/testing.hpp"

#include <palpate/backend.hpp>

#include <atomic>

namespace palpate::test {

class ProcessBackend : public InFolder {
 protected:
  ProcessBackend() { fs::create_directory(folder_.path() / "record"); }

  /// The words that start a Python program with this body.
  std::string command(const std::string& body, const std::string& name = "program.py") {
    return "python3 -SE '" + folder_.write(name, python(body)).string() + "'";
  }

  /// With nothing but what `more` says beside the command.
  std::shared_ptr<Backend> plain(const std::string& command, const std::string& more = "") {
    return context_.create<Backend>(
        choose(shared_host(), "backend", "process", "{command: " + yaml_quoted(command) + more + "}"));
  }

  /// One that starts its program again whenever it ended.
  std::shared_ptr<Backend> start(const std::string& command, const std::string& more = "") {
    return plain(command, ", restart: true" + more);
  }

  std::shared_ptr<Backend> open(const std::string& body, const std::string& more = "") {
    return start(command(body), more);
  }

  std::string refusal(const std::string& command) {
    return error_of([&] { start(command)->tap(request(1)); });
  }

  static TapRequest request(int number) { return request_at({0.1, 0.2}, number); }

  static TapResult tap(Backend& backend, int number) { return backend.tap(request(number)); }

  static void expect_contact(const TapResult& contact) {
    EXPECT_EQ(contact.outcome, Outcome::contact);
    EXPECT_EQ(contact.height(), 0.07);
    EXPECT_EQ(contact.seconds, 5.5);
    EXPECT_EQ(contact.reason, "");
    EXPECT_FALSE(contact.ends_run);
  }

  static void expect_failure(const TapResult& contact, Outcome outcome, const std::string& reason) {
    EXPECT_EQ(contact.outcome, outcome);
    EXPECT_EQ(contact.reason, reason);
    EXPECT_FALSE(contact.contact);
    EXPECT_GE(contact.seconds, 0.0);
  }

  /// A program that answers every tap but the second, for which it does `odd`; the others it answers in one piece.
  TapResult second_tap(const std::string& odd, bool kept, const std::string& more = "") {
    const auto backend =
        open("for ask in asks():\n    if ask['tap'] != 2: contact(ask)\n    else:\n        " + odd + "\n", more);
    const TapResult first = tap(*backend, 1);
    expect_contact(first);
    TapResult second = tap(*backend, 2);
    const TapResult third = tap(*backend, 3);
    expect_contact(third);
    EXPECT_EQ(first.force == third.force, kept) << "whether the same process goes on";
    EXPECT_EQ(running(pid_in(first.force)), kept);
    return second;
  }

  std::string diary() const { return text_of(folder_.path() / "record" / "process.stderr.txt"); }

  std::atomic<bool> interrupted_{false};
  Context context_{shared_host(), wave_scene(), 1, &interrupted_, (folder_.path() / "record").string()};
};

}  // namespace palpate::test
