// SPDX-License-Identifier: MIT
#include "record/summary.hpp"

#include "record/number.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/resource.h>

namespace palpate {
namespace {

double thread_cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using Column = std::pair<const char*, const Eigen::VectorXd*>;

/// A number as text, kept until there is another: the truth is the same all over the desk.
class NumberText {
 public:
  /// Writes a number and returns its end; behind that, up to kLongestNumber from `to` on, is anything.
  char* write(char* to, double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    if (length_ == 0 || bits != bits_) {
      length_ = write_shortest(text_.data(), value) - text_.data();
      bits_ = bits;
    }
    std::memcpy(to, text_.data(), text_.size());
    return to + length_;
  }

 private:
  std::uint64_t bits_ = 0;  ///< of the number, of which 0 and -0 are written each its own way
  std::array<char, kLongestNumber> text_{};
  std::ptrdiff_t length_ = 0;
};

/// x, y and one column a map; a null map leaves its cells empty. Thousands of numbers: once for a coordinate, and for a
/// map that is there twice. In pieces, since a page of fresh memory costs more than what is written into it.
void grid_csv(const Candidates& candidates, const std::vector<Column>& columns, const TextOut& out) {
  std::string head = "x,y";
  for (const Column& column : columns) head.append(",").append(column.first);
  out(head += '\n');
  constexpr std::ptrdiff_t kPiece = 1 << 15;
  std::vector<char> piece(kPiece + (columns.size() + 2) * (kLongestNumber + 1));
  char* end = piece.data();
  const auto hand_over = [&] {
    out({piece.data(), static_cast<std::size_t>(end - piece.data())});
    end = piece.data();
  };
  std::vector<NumberText> xs(static_cast<std::size_t>(candidates.columns));
  NumberText y;
  std::vector<NumberText> texts(columns.size());
  std::vector<NumberText*> text_of;  // each column's, of columns with the same map the first one's
  for (const Column& column : columns) {
    const auto first = std::find_if(columns.begin(), columns.end(),
                                    [&](const Column& other) { return other.second == column.second; });
    text_of.push_back(&texts[static_cast<std::size_t>(first - columns.begin())]);
  }
  for (int row = 0, cell = 0; row < candidates.rows; ++row) {
    for (NumberText& x : xs) {
      end = x.write(end, candidates.points(cell, 0));
      *end++ = ',';
      end = y.write(end, candidates.points(cell, 1));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        *end++ = ',';
        if (columns[i].second != nullptr) end = text_of[i]->write(end, (*columns[i].second)(cell));
      }
      *end++ = '\n';
      if (end - piece.data() > kPiece) hand_over();
      ++cell;
    }
  }
  hand_over();
}

void surface_csv(FromAbove& experiment, const TextOut& out) {
  experiment.ask(Quantity::height | Quantity::probability);
  const TapBelief& belief = experiment.belief();
  const Eigen::VectorXd deviation = belief.height_variance().cwiseSqrt();
  const Eigen::VectorXd gated = belief.two_part() ? reconstruction(belief) : Eigen::VectorXd();
  const Truth* truth = experiment.truth();
  grid_csv(experiment.candidates(),
           {{"height_mean", &belief.height_mean()},
            {"height_standard_deviation", &deviation},
            {"object_probability", &belief.probability()},
            {"reconstructed_height", belief.two_part() ? &gated : &belief.height_mean()},
            {"true_height", truth != nullptr ? &truth->height : nullptr}},
           out);
}

}  // namespace

Stopwatch::Stopwatch() : wall_(std::chrono::steady_clock::now()), cpu_(thread_cpu_seconds()) {}
double Stopwatch::wall_seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
}
double Stopwatch::cpu_seconds() const { return thread_cpu_seconds() - cpu_; }

std::int64_t peak_rss_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

std::pair<std::string, Text> surface_file(Experiment& experiment) {
  if (auto* const any_side = dynamic_cast<FromAnySide*>(&experiment))
    return {"surface.ply", [any_side](const TextOut& out) { out(any_side->surface_ply()); }};
  return {"surface.csv", [&above = from_above_of(experiment, "")](const TextOut& out) { surface_csv(above, out); }};
}

std::string whole_of(const Text& text) {
  std::string out;
  text([&](std::string_view piece) { out += piece; });
  return out;
}

std::string maps_csv(const FromAbove& experiment) {
  const TapBelief& belief = experiment.belief();
  const Quantities known = belief.recorded();
  std::vector<Column> columns;
  if (known.has(Quantity::height)) {
    columns.insert(columns.end(),
                   {{"height_mean", &belief.height_mean()}, {"height_variance", &belief.height_variance()}});
  }
  if (known.has(Quantity::uncertainty)) columns.emplace_back("u", &belief.uncertainty());
  if (known.has(Quantity::weight)) columns.emplace_back("w", &belief.weight());
  if (known.has(Quantity::probability) && !belief.footprint_is_weight()) {
    columns.emplace_back("p", &belief.probability());
  }
  std::string out;
  if (!columns.empty()) grid_csv(experiment.candidates(), columns, [&](std::string_view piece) { out += piece; });
  return out;
}

}  // namespace palpate
