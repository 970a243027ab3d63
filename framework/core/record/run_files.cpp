// SPDX-License-Identifier: MIT
#include "record/run_files.hpp"

#include "config/trouble.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "record/tap_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

// What a line of record.jsonl begins with.
constexpr std::string_view kAttemptLine = "{\"attempt\": ";
constexpr std::string_view kManifestLine = "{\"manifest\": ";
constexpr std::string_view kObjectLine = "{\"object\": ";
constexpr std::string_view kTapLine = "{\"tap\": ";
/// Behind the number of a tap, where its times are known.
constexpr std::string_view kSeconds = ", \"seconds\": ";

bool begins_with(std::string_view text, std::string_view part) { return text.substr(0, part.size()) == part; }

/// Calls `use` with each line that has its end, and where it begins.
template <class Use>
void for_lines(const std::string& text, const Use& use) {
  for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    use(std::string_view(text).substr(begin, end - begin), begin);
  }
}

/// Where the times lie in a line of a tap that has some: from their brace to behind the one that closes them.
std::optional<std::pair<std::size_t, std::size_t>> seconds_in(std::string_view line) {
  const std::size_t comma = line.find(',');
  if (comma == std::string_view::npos || !begins_with(line.substr(comma), kSeconds)) return std::nullopt;
  const std::size_t end = line.find('}', comma);
  if (end == std::string_view::npos) return std::nullopt;
  return std::pair(comma + kSeconds.size(), end + 1);
}

/// One line of timings.csv; none if it is damaged. One without numbers has `tap` 0.
std::optional<TapTimes> read_times(std::string_view line) {
  TapTimes out;
  const char* at = line.data();
  const char* const end = at + line.size();
  auto read = std::from_chars(at, end, out.tap);
  if (read.ec == std::errc() && std::string_view(read.ptr, static_cast<std::size_t>(end - read.ptr)) ==
                                    std::string_view(",,,,,,,,").substr(0, kPhases)) {
    return TapTimes{};
  }
  for (double& seconds : out.seconds) {
    if (read.ec != std::errc() || read.ptr == end || *read.ptr != ',') return {};
    read = std::from_chars(read.ptr + 1, end, seconds);
  }
  return read.ec == std::errc() && read.ptr == end ? std::optional(out) : std::nullopt;
}

/// The same of a line of record.jsonl.
std::optional<TapTimes> read_packed_times(std::string_view line) {
  TapTimes out;
  const auto seconds = seconds_in(line);
  if (!seconds) return out;
  const auto row = parse_json_row(std::string(line.substr(seconds->first, seconds->second - seconds->first)));
  if (!row || std::from_chars(line.data() + kTapLine.size(), line.data() + line.size(), out.tap).ec != std::errc())
    return {};
  for (std::size_t i = 0; i < kPhases; ++i) {
    const std::optional<double> one = row->number(kPhaseNames[i]);
    if (!one) return {};
    out.seconds[i] = *one;
  }
  return out;
}

/// Cuts off what a kill or a full disk left of a last line.
void cut_half_line(const fs::path& file) {
  const std::optional<std::string> text = read_if_there(file);
  if (text && !text->empty() && text->back() != '\n') cut_file(file, text->rfind('\n') + 1);
}

}  // namespace

RunFiles::RunFiles(const fs::path& directory, bool packed) : directory_(directory.native() + "/"), packed_(packed) {}

RunFiles::RunFiles(const fs::path& directory) : RunFiles(directory, false) {
  packed_ = size_if_there((directory_ + kPacked).c_str()).has_value();
}

bool RunFiles::will_be_packed(const fs::path& directory) {
  if (is_there(directory / kPacked)) return true;
  const fs::path jobs = (fs::absolute(directory) / "").lexically_normal().parent_path().parent_path();
  if (jobs.filename() != "jobs" || !is_sweep(jobs.parent_path())) return false;
  // Unless an older palpate has begun it.
  constexpr std::array<const char*, 4> kLoose{kLock, kAttempts, kManifest, kTaps};
  return std::none_of(kLoose.begin(), kLoose.end(), [&](const char* one) { return is_there(directory / one); });
}

fs::path taps_file_to_come(const fs::path& directory) {
  return RunFiles(directory, RunFiles::will_be_packed(directory)).taps_file();
}

bool RunFiles::begun() const {
  // The one that is packed is there when somebody has asked for the lock.
  const std::optional<std::uintmax_t> bytes = size_if_there((directory_ + (packed_ ? kPacked : kTaps)).c_str());
  return bytes && (!packed_ || *bytes > 0);
}

namespace {

/// The row of a tap as JSON, without its times; none in a line of another part.
std::optional<std::string> tap_in_line(std::string_view line) {
  if (begins_with(line, kAttemptLine) || begins_with(line, kManifestLine) || begins_with(line, kObjectLine)) return {};
  std::string out(line);
  if (const auto seconds = seconds_in(line)) {
    const std::size_t begin = seconds->first - kSeconds.size();
    out.erase(begin, seconds->second - begin);
  }
  return out;
}

}  // namespace

std::optional<Row> TapLines::read(std::string_view line) {
  const std::optional<std::string> tap = tap_in_line(line);
  if (!tap) return lines_.skip(), std::nullopt;
  Row row = lines_.read(*tap);
  check_order(row);
  return row;
}

void TapLines::check_order(const Row& row) {
  const Scalar* number = row.find("tap");
  const auto* tap = number != nullptr ? std::get_if<std::int64_t>(number) : nullptr;
  const bool announces = is_intent(row);
  const std::int64_t next = taps_ + 1;
  if (tap != nullptr && *tap == next && !(announces && announced_)) {
    announced_ = announces;
    taps_ += announces ? 0 : 1;
    return;
  }
  const std::string found = tap == nullptr ? "has no number 'tap'"
                            : *tap == next ? fmt::format("announces tap {} a second time", *tap)
                            : *tap > next
                                ? fmt::format("has tap {} where tap {} belongs: a line is missing", *tap, next)
                            : announces ? fmt::format("announces tap {}, which is recorded already", *tap)
                                        : fmt::format("has tap {} a second time, where tap {} belongs", *tap, next);
  throw Error(lines_.place(), found, "put the file back as it was, or begin anew with 'palpate run --force'");
}

std::vector<Row> RunFiles::taps() const {
  std::vector<Row> out;
  TapLines lines(taps_file());
  for_lines(read_file(taps_file()), [&](std::string_view line, std::size_t) {
    if (std::optional<Row> row = lines.read(line)) out.push_back(std::move(*row));
  });
  return out;
}

Timings RunFiles::timings() const {
  constexpr std::size_t kShown = 80;
  Timings out;
  const fs::path from = file(kTimings);
  if (!is_there(from)) return out;
  bool header = !packed_;
  for_lines(read_file(from), [&](std::string_view line, std::size_t) {
    if (std::exchange(header, false) || out.trouble) return;
    if (packed_ && !begins_with(line, kTapLine)) return;
    const std::optional<TapTimes> times = packed_ ? read_packed_times(line) : read_times(line);
    if (!times) {
      out.trouble =
          Error(from.string(), "has the line '" + std::string(line.substr(0, kShown)) + "'", "the file is damaged");
    } else if (times->tap != 0) {
      out.taps.push_back(*times);
    }
  });
  return out;
}

std::optional<Tree> RunFiles::manifest() const {
  const fs::path from = file(kManifest);
  if (!packed_) return is_there(from) ? std::optional(read_json(from)) : std::nullopt;
  const std::string text = read_if_there(from).value_or("");
  std::optional<std::pair<std::size_t, std::size_t>> last;
  for_lines(text, [&](std::string_view line, std::size_t begin) {
    if (begins_with(line, kManifestLine)) last.emplace(begin, begin + line.size());
  });
  if (!last) return std::nullopt;
  Tree line = parse_json(text, last->first, last->second, from);
  return std::move(line.at("manifest"));
}

int RunFiles::attempts() const {
  int out = 0;
  // Asking how often is no time to fail, unless the file system does: who adds an attempt tells what is wrong.
  std::string text;
  const auto trouble = trouble_in([&] { text = read_if_there(file(kAttempts)).value_or(""); });
  if (trouble && trouble->kind() == Error::Kind::run) throw *trouble;
  for_lines(text, [&](std::string_view line, std::size_t) {
    if (packed_ && !begins_with(line, kAttemptLine)) return;
    const std::optional<Row> row = parse_json_row(std::string(line));
    out += row && row->find("end") != nullptr ? 0 : 1;
  });
  return out;
}

HeldFiles::HeldFiles(const fs::path& directory)
    : RunFiles(make_folder(directory), will_be_packed(directory)), directory_(directory), lock_(lock_file()) {}

AppendFile& HeldFiles::log() {
  if (!log_) {
    cut_half_line(taps_file());
    log_.emplace(taps_file());
  }
  return *log_;
}

void HeldFiles::open() {
  log();
  if (packed() || timings_) return;
  const fs::path file = directory_ / kTimings;
  cut_half_line(file);
  std::error_code none;
  const bool fresh = !is_there(file) || fs::file_size(file, none) == 0;
  timings_.emplace(file);
  if (!fresh) return;
  std::string header;
  for (const RecordField& field : timing_list().fields()) header += (header.empty() ? "" : ",") + field.name;
  timings_->append(header + "\n", false);
}

void HeldFiles::mend(const std::vector<Row>& taps) {
  open();
  if (packed()) return;
  const std::string text = read_file(directory_ / kTimings);
  // The last line, or the header, which has no number.
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  int timed = 0;
  std::from_chars(text.data() + last, text.data() + text.size(), timed);
  if (timed == 0 && last != 0) return;  // damaged: what follows would be no better
  std::string missing;
  for (const Row& tap : taps) {
    const int number = static_cast<int>(tap.number("tap").value_or(0.0));
    if (number > timed) missing += std::to_string(number) + std::string(kPhases, ',') + "\n";
  }
  if (!missing.empty()) timings_->append(missing, false);
}

void HeldFiles::check_in_place() const {
  if (log_ && log_->is_in_place()) return check_held();
  throw Error(directory_.string(), "was moved or removed while a run was writing there",
              "where it was moved to, 'palpate resume' carries on", Error::Kind::run);
}

void HeldFiles::add_tap(const Row& tap, const TapTimes* times, bool sync) {
  check_held();
  std::string line = to_json_line(tap) + "\n";
  if (packed() && times != nullptr) {
    std::string seconds(kSeconds);
    for (std::size_t i = 0; i < kPhases; ++i) {
      seconds += fmt::format("{}\"{}\": {:.9f}", i == 0 ? "{" : ", ", kPhaseNames[i], times->seconds[i]);
    }
    line.insert(line.find(','), seconds + "}");
  }
  log().append(line, sync);
  if (packed() || times == nullptr) return;
  std::string row = std::to_string(times->tap);
  for (const double seconds : times->seconds) row += fmt::format(",{:.9f}", seconds);
  timings_->append(row + "\n", false);
}

void HeldFiles::set_manifest(const Tree& manifest, bool sync) {
  check_held();
  if (!packed()) return write_file(directory_ / kManifest, to_json(manifest), sync);
  log().append(std::string(kManifestLine) + to_json_line(manifest) + "}\n", sync);
}

void HeldFiles::set_objects(const std::vector<Row>& objects, bool sync) {
  if (objects.empty()) return;
  check_held();
  if (!packed()) return write_file(directory_ / kObjects, to_csv(objects), sync);
  std::string lines;
  for (const Row& object : objects) lines += to_json_line(object) + "\n";
  log().append(lines, sync);
}

void HeldFiles::flush() const {
  for (const std::optional<AppendFile>* file : {&log_, &timings_, &attempts_}) {
    if (*file) (*file)->flush();
  }
}

void HeldFiles::add_attempt(const Row& attempt) {
  check_held();
  if (packed()) return log().append(to_json_line(attempt) + "\n", false);
  if (!attempts_) {
    const fs::path file = directory_ / kAttempts;
    // Of the first attempt, too, there may be half a line.
    if (is_there(file)) cut_file(file, read_json_lines(file).bytes);
    attempts_.emplace(file);
  }
  attempts_->append(to_json_line(attempt) + "\n", false);
}

}  // namespace palpate
