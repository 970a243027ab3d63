// SPDX-License-Identifier: MIT
// Backend that returns recorded taps: those of a former run, or of any table with the same columns. A dense scan of a
// real object can serve as a benchmark of strategies.
#include "answers/tap_result_checks.hpp"
#include "reading/read_file.hpp"

#include <palpate/backend.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <vector>

namespace palpate::backends {

struct ReplayOptions : Options {
  std::string record;
  double tolerance = 1e-4;
  bool scene_is_truth = false;

  void list(Fields& fields) override {
    fields.text(record, Field("record",
                              "run directory, or CSV file with the columns x, y, outcome, height (m) and optionally "
                              "tap, force, robot_seconds; for lines of any direction also with z, direction.x, "
                              "direction.y, direction.z, length and along (m)")
                            .needed());
    fields.real(tolerance,
                Field("tolerance",
                      "maximum distance between the positions of a requested and a recorded tap; for lines of any "
                      "direction between their starts and between their ends")
                    .in(Unit::metre)
                    .at_least(0));
    fields.flag(
        scene_is_truth,
        Field(
            "scene_is_truth",
            "whether the taps were recorded in the scene of the config. If true, errors are computed from this scene"));
  }
};

namespace {

struct ReplayTap {
  int number = 0;
  TapLine line;
  TapResult result;
};

Outcome outcome_of(const std::string& name, const std::string& where) {
  // kNames is in the order of Outcome.
  constexpr const char* kNames[] = {"contact", "no_contact", "unreachable", "timeout", "aborted", "unknown"};
  const auto* const found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) throw Error(where, "unknown outcome '" + name + "'");
  return static_cast<Outcome>(found - std::begin(kNames));
}

/// Removes the apostrophe that palpate writes before text that a spreadsheet would evaluate.
std::string unguarded(const std::string& cell) {
  const std::size_t begin = cell.find_first_not_of("' \t\r\n");
  const bool guarded =
      begin != std::string::npos && cell.front() == '\'' && std::strchr("=+-@", cell[begin]) != nullptr;
  return guarded ? cell.substr(1) : cell;
}

/// Rows of a CSV file, read by column name. The columns of a contact (x, y, outcome, height) must exist.
class Table {
 public:
  explicit Table(const std::string& file) : file_(file) {
    FileReading reading = read_bounded(file, kMostLogBytes, FileOrigin::user);
    const char* const hint = "backend.record names a run directory or a CSV file";
    if (!reading) throw Error(file, words_of(reading, kMostLogBytes).reason, hint);
    drop_byte_order_mark(reading.text);
    reading.text.erase(reading.text.find_last_not_of(" \t\r\n") + 1);  // blank lines at the end
    in_.str(reading.text);
    if (!read_row()) throw Error(file, "cannot be read", hint);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (!columns_.emplace(cells_[i], i).second)
        throw Error(file, "has two columns '" + cells_[i] + "'", "remove or rename one of them");
    }
    for (const char* needed : {"x", "y", "outcome", "height"}) {
      if (columns_.count(needed) == 0) throw Error(file, std::string("has no column '") + needed + "'");
    }
  }

  bool has(const std::string& column) const { return columns_.count(column) != 0; }

  bool next() {
    if (!read_row()) return false;
    if (cells_.size() != columns_.size()) throw Error(where(), "has a different number of cells than the header");
    return true;
  }

  std::string where() const { return file_ + ":" + std::to_string(line_); }

  std::string text(const std::string& column) const {
    const auto found = columns_.find(column);
    return found == columns_.end() ? std::string() : unguarded(cells_[found->second]);
  }

  /// Returns the number in a cell, or `absent` if the column does not exist or the cell is empty.
  double number(const std::string& column, double absent) const {
    const std::string cell = text(column);
    if (cell.empty()) return absent;
    const char* const end = cell.data() + cell.size();
    double value = 0.0;
    const char* begin = std::find_if(cell.data(), end, [](char c) { return c == '\0' || !std::strchr(" \t\r\n", c); });
    if (end - begin > 1 && begin[0] == '+' && begin[1] != '-') ++begin;  // from_chars() accepts no plus sign
    const auto read = std::from_chars(begin, end, value);                // independent of the locale
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
      throw Error(where(), column + ": '" + cell + "' is not a number", "write it without a unit, such as 0.012");
    return value;
  }

  /// Returns a number of at least 0 without decimals.
  int count(const std::string& column) const {
    const double value = number(column, 0.0);
    if (value < 0.0 || value > std::numeric_limits<int>::max() || value != std::floor(value))
      throw Error(where(), column + ": '" + text(column) + "' is not a whole number of at least 0");
    return static_cast<int>(value);
  }

 private:
  /// Reads one row; returns false at the end of the file. A quoted cell may contain commas, line ends and doubled
  /// quotes.
  bool read_row() {
    if (in_.peek() == std::istringstream::traits_type::eof()) return false;
    line_ = next_line_;
    cells_.assign(1, {});
    bool quoted = false;
    for (char c; in_.get(c);) {
      next_line_ += c == '\n' ? 1 : 0;
      if (c == '"' && !(quoted && in_.peek() == '"')) {
        quoted = !quoted;
      } else if (quoted) {
        if (c == '"') in_.get();
        cells_.back() += c;
      } else if (c == '\n') {
        break;
      } else if (c == ',') {
        cells_.emplace_back();
      } else if (c != '\r') {
        cells_.back() += c;
      }
    }
    return true;
  }

  std::string file_;
  std::istringstream in_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string> cells_;
  int line_ = 1;       ///< first line of the row
  int next_line_ = 1;  ///< first line of the next row
};

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Returns the line of a row, which is from above if the table has no column `length`. A missing number is NaN.
TapLine read_line(const Table& table) {
  const auto number = [&](const char* column) { return table.number(column, kMissing); };
  if (!table.has("length")) return line_from_above({number("x"), number("y")});
  return {{number("x"), number("y"), number("z")},
          {number("direction.x"), number("direction.y"), number("direction.z")},
          number("length")};
}

/// Returns the larger distance between the starts and between the ends of two lines. If both are from above, returns
/// the distance between their positions. If only one is from above, returns infinity.
double distance_between(const TapLine& one, const TapLine& other) {
  if (one.from_above != other.from_above) return std::numeric_limits<double>::infinity();
  const double starts = math::hypot(one.start.x() - other.start.x(), one.start.y() - other.start.y());
  if (one.from_above) return starts;
  return std::max((one.start - other.start).norm(), (one.at(one.length) - other.at(other.length)).norm());
}

/// Reads how far the tool moved along a line that is not from above.
void read_along(const Table& table, ReplayTap& tap) {
  const double along = table.number("along", kMissing);
  if (!std::isfinite(tap.line.at(tap.line.length).sum())) throw Error(table.where(), "lacks z, direction or length");
  if (!std::isnan(along)) tap.result.distance = along;
  if (!tap.result.is_contact()) return;
  if (!tap.result.distance) throw Error(table.where(), "lacks along");
  tap.result.contact->head<2>() = tap.line.at(along).head<2>();
}

std::vector<ReplayTap> read_record(const std::string& path) {
  const std::string file = std::filesystem::is_directory(path) ? path + "/taps.csv" : path;
  Table table(file);
  std::vector<ReplayTap> taps;
  while (table.next()) {
    ReplayTap one{table.count("tap"), read_line(table), {}};
    const TapLine& line = one.line;
    const Outcome outcome = outcome_of(table.text("outcome"), table.where());
    const double seconds = table.number("robot_seconds", 0.0);
    const bool is_free_line = !line.from_above && outcome == Outcome::no_contact;
    if (outcome == Outcome::contact) {
      one.result = contact_on(line, table.number("height", kMissing), 0.0, seconds);
    } else {
      one.result = tap_without_contact(outcome, seconds, is_free_line ? "" : "recorded without a reason");
    }
    one.result.force = table.number("force", 0.0);
    const double numbers = line.start.x() + line.start.y() + one.result.height();
    if (std::isnan(numbers)) throw Error(table.where(), "lacks x, y or height");
    if (!line.from_above) read_along(table, one);
    if (const auto fault = find_fault(one.result, line, kAnyArm))
      throw Error(table.where(), fault->reason, fault->remedy);
    taps.push_back(std::move(one));
  }
  return taps;
}

}  // namespace

class Replay final : public Backend {
 public:
  using Options = ReplayOptions;

  Replay(const Options& options, const Context&) : options_(options), taps_(read_record(options.record)) {}

  /// Returns the tap with the same number if it is within the tolerance, else the nearest tap within the tolerance.
  TapResult tap(const TapRequest& request) override {
    const ReplayTap* best = nullptr;
    double least = options_.tolerance;
    for (const ReplayTap& one : taps_) {
      const double distance = distance_between(one.line, request.line);
      if (distance > options_.tolerance) continue;
      if (one.number == request.number) return one.result;
      if (best == nullptr || distance < least) {
        best = &one;
        least = distance;
      }
    }
    if (best == nullptr) return tap_without_contact(Outcome::unreachable, 0.0, "no tap was recorded at this place");
    return best->result;
  }

  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return options_.scene_is_truth; }
  bool taps_any_line() const override { return !taps_.empty() && !taps_.front().line.from_above; }

 private:
  ReplayOptions options_;
  std::vector<ReplayTap> taps_;
};

PALPATE_PLUGIN(Backend, Replay, "replay", "recorded taps, from a run or a table")

}  // namespace palpate::backends
