// SPDX-License-Identifier: MIT
// A program at a terminal of its own, with the test as the person before it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

class Terminal {
 public:
  static constexpr char kControlC = '\x03';
  static constexpr char kControlD = '\x04';

  /// Starts a program with the terminal as its stdin, stdout and stderr; words, folder and environment are those of
  /// test::Child. It is killed when the test ends, however that ends.
  Terminal(const std::vector<std::string>& words, const std::filesystem::path& folder,
           const std::vector<std::string>& environment = {});
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Reads until the screen has shown `text` `times` times, for ten minutes at most, which only what hangs takes;
  /// whether it has.
  bool shows(const std::string& text, int times = 1);
  void type(const std::string& keys) const;
  void signal(int number) const;
  /// Closes the window: the program loses its terminal, and is told so.
  void close();
  /// Waits for the program's end, reading on; its exit status, 128 + signal if a signal ended it. Once only.
  int wait();

  /// All that has been shown, line ends as the terminal has them: "\r\n". What is typed is echoed.
  const std::string& screen() const { return screen_; }

 private:
  bool read_on(int milliseconds);

  int pid_ = -1;
  int master_ = -1;
  std::string screen_;
};

}  // namespace palpate::test
