// SPDX-License-Identifier: MIT
#include "cli/step.hpp"

#include "cli/display.hpp"
#include "cli/output.hpp"
#include "config/display_units.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace palpate::cli {
namespace {

/// Longest delay between a signal and the reaction to it. If another thread handles the signal, poll() does not return
/// early.
constexpr int kPollMilliseconds = 100;

std::string who_chose(const TapRecord& tap) {
  if (tap.request.source == Source::fallback) return "a fallback: " + tap.why;
  return tap.request.source == Source::initial ? "one of the initial taps" : "chosen by the acquisition";
}

}  // namespace

std::unique_ptr<TapConfirmation> TapConfirmation::when(bool wanted, const ExperimentOptions& options,
                                                       const std::atomic<bool>* stopped) {
  if (!wanted) return nullptr;
  if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDERR_FILENO) == 0)
    throw Error("command line", "--step: needs a terminal to show each tap and to wait for Enter",
                "connect stdin and stderr to a terminal");
  return std::unique_ptr<TapConfirmation>(new TapConfirmation(options, stopped));
}

TapConfirmation::TapConfirmation(const ExperimentOptions& options, const std::atomic<bool>* stopped)
    : budget_(options.taps), two_part_(belief_option(options, "surface") == "two_part"), interrupted_(stopped) {}

bool TapConfirmation::permits(const TapRecord& tap, const Experiment& experiment) {
  const Preview preview = experiment.preview(tap);
  const DisplayScale places = usual_scale(Unit::metre, LengthKind::place);
  std::string text =
      fmt::format("tap {} of {} at ({}, {}) {}, {}", tap.number(), budget_, places.number(tap.target().x),
                  places.number(tap.target().y), places.unit, who_chose(tap));
  if (const std::optional<Prediction>& expected = preview.expected)
    text += fmt::format("; expected height{} {} +- {} {}", two_part_ ? " of an object there" : "",
                        places.number(expected->height), places.number(expected->standard_deviation), places.unit);
  for (const std::string& line : preview.motion) text += "\n      " + line;
  flush_output();
  ::tcflush(STDIN_FILENO, TCIFLUSH);
  print_message(text + "\n");
  for (;;) {
    print_message("      Enter taps, q ends: ");
    const std::optional<std::string> answer = read_line();
    if (!answer) print_message("\n");
    if (!answer || *answer == "q") return false;
    if (answer->empty()) return true;
  }
}

/// Returns the next line of stdin without its line end. Returns nullopt after the end of the input and after an
/// interrupt.
std::optional<std::string> TapConfirmation::read_line() const {
  std::string line;
  while (line.empty() || line.back() != '\n') {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&input, 1, kPollMilliseconds);
    if (interrupted_ != nullptr && interrupted_->load()) return std::nullopt;
    if (ready <= 0) continue;
    char piece[256];
    const ssize_t size = ::read(STDIN_FILENO, piece, sizeof piece);  // A terminal returns at most one line per call.
    if (size <= 0) return std::nullopt;
    line.append(piece, static_cast<std::size_t>(size));
  }
  line.pop_back();
  return line;
}

}  // namespace palpate::cli
