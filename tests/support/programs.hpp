// SPDX-License-Identifier: MIT
// Programs for the backend `process`, written by the tests that start them.
#pragma once

#include "support/support.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

namespace palpate::test {

/// `body` as a Python program, for which `asks()` yields what it is asked, and `contact(ask)` answers with a height of
/// 7 cm, 5.5 s, and a millionth of its own process id for the force; `tell(ask, ...)` with any fields.
inline std::string python(const std::string& body) {
  return R"(import json, os, sys, time

def asks():
    for line in sys.stdin:
        yield json.loads(line)

def tell(ask, **fields):
    print(json.dumps({"tap": ask["tap"], **fields}), flush=True)

def contact(ask, **fields):
    tell(ask, outcome="contact", height=0.07, force=os.getpid() / 1e6, seconds=5.5, **fields)

)" + body;
}

/// The process id in the force of such a contact.
inline long pid_in(double force) { return std::lround(1e6 * force); }

/// `text` as a YAML value.
inline std::string yaml_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// Looks again and again until `holds`, for five minutes, which only what hangs takes; what it says then. It sleeps
/// between the looks: what another process does or leaves behind, its end above all, is announced to nobody here.
template <class Condition>
bool eventually(const Condition& holds) {
  for (int i = 0; i < 150000 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return holds();
}

/// Whether a process is there and is no zombie that nobody reaps.
inline bool running(long pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(in, text);
  const auto name_end = text.find_last_of(')');
  return name_end != std::string::npos && text.size() > name_end + 2 && text[name_end + 2] != 'Z';
}

}  // namespace palpate::test
