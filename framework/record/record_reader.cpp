// SPDX-License-Identifier: MIT
#include "record/record_reader.hpp"

#include "config/catch_error.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Names of the values of LineKind.
constexpr std::array<std::string_view, 9> kKinds{"manifest", "attempt", "setup", "intent", "tap",
                                                 "timing",   "objects", "note",  "end"};
/// Names of the values of Ending::EndKind.
constexpr std::array<const char*, 3> kEndKinds{"done", "failed", "interrupted"};

constexpr const char* kNoEnding =
    "has no 'end' with done, failed or interrupted, or names a file that is not in its folder";
constexpr const char* kPutBack = "put the file back as it was, or start again with 'palpate run --force'";

bool holds_lists(LineKind kind) {
  return kind == LineKind::manifest || kind == LineKind::setup || kind == LineKind::objects || kind == LineKind::other;
}

std::optional<std::int64_t> count_in(const Row& row, std::string_view name) {
  const Scalar* const value = row.find(name);
  const auto* const number = value != nullptr ? std::get_if<std::int64_t>(value) : nullptr;
  return number != nullptr ? std::optional(*number) : std::nullopt;
}

std::optional<Ending::EndKind> how_of(const Row& end) {
  const auto found = std::find(kEndKinds.begin(), kEndKinds.end(), end.text("end"));
  if (found == kEndKinds.end()) return std::nullopt;
  return static_cast<Ending::EndKind>(found - kEndKinds.begin());
}

/// Returns whether a name is a file name without a folder, so that a manipulated record cannot refer to files outside
/// its own folder.
bool is_plain_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

/// Returns the ending in a line. Returns nullopt if the line has no valid `end` or refers to a file in another folder.
std::optional<Ending> ending_of(Row line) {
  constexpr std::string_view kSummary = "summary.";
  constexpr std::string_view kFiles = "files.";
  constexpr std::string_view kBytes = ".bytes";
  const std::optional<Ending::EndKind> how = how_of(line);
  if (!how) return std::nullopt;
  Ending out;
  out.how = *how;
  out.reason = line.text("reason");
  out.summary.fields.reserve(line.fields.size());
  for (auto& [name, value] : line.fields) {
    if (name.compare(0, kSummary.size(), kSummary) == 0) {
      out.summary.fields.emplace_back(name.substr(kSummary.size()), std::move(value));
    } else if (name.compare(0, kFiles.size(), kFiles) == 0) {
      const std::size_t dot = name.rfind('.');
      const std::string file = name.substr(kFiles.size(), dot - std::min(dot, kFiles.size()));
      if (!is_plain_name(file)) return std::nullopt;
      if (name.compare(dot, kBytes.size(), kBytes) == 0) out.files.push_back({file, 0, {}});
      if (out.files.empty() || out.files.back().name != file) continue;
      if (const auto* bytes = std::get_if<std::int64_t>(&value))
        out.files.back().bytes = static_cast<std::uintmax_t>(*bytes);
      if (const auto* hash = std::get_if<std::string>(&value)) out.files.back().hash = *hash;
    }
  }
  return out;
}

/// Calls `use` with each line that has a line end.
template <class Use>
void for_lines(std::string_view text, const Use& use) {
  for (std::size_t begin = 0, end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
    use(text.substr(begin, end - begin));
}

/// Adds the content of a line to `out`.
void add_line(RecordLine line, RunRecord& out) {
  out.end.reset();
  switch (line.kind) {
    case LineKind::manifest:
      out.manifest = std::move(line.tree);
      break;
    case LineKind::attempt:
      out.attempts.push_back(std::move(line.row));
      break;
    case LineKind::setup:
      out.setup = std::move(line.tree);
      break;
    case LineKind::intent:
      out.intent = std::move(line.row);
      break;
    case LineKind::tap:
      out.intent.reset();
      out.taps.push_back(std::move(line.row));
      break;
    case LineKind::timing:
      out.timings.push_back(times_of(line.row));
      break;
    case LineKind::objects:
      out.objects = rows_of(*line.tree.find("objects"));
      break;
    case LineKind::note:
      out.notes.push_back(std::move(line.row));
      break;
    case LineKind::end:
      if (!out.attempts.empty()) out.attempts.back().add("end", line.row.text("end"));
      out.end = std::move(line.end);
      break;
    case LineKind::other:
      break;
  }
}

}  // namespace

const char* ending_name(Ending::EndKind how) { return kEndKinds[static_cast<std::size_t>(how)]; }

TapTimes times_of(const Row& row) {
  TapTimes out;
  out.tap = static_cast<int>(count_in(row, "timing").value_or(0));
  for (std::size_t i = 0; i < kPhases; ++i) out.seconds[i] = row.number(kPhaseNames[i]).value_or(0.0);
  out.expected_rmse = row.number(kExpectedError);
  return out;
}

LineKind kind_of_line(std::string_view line) {
  const std::size_t open = line.find('"');
  if (open == std::string_view::npos || line.substr(0, open).find_first_not_of(" \t{") != std::string_view::npos)
    return LineKind::other;
  const std::string_view name = line.substr(open + 1, line.find('"', open + 1) - open - 1);
  return static_cast<LineKind>(std::find(kKinds.begin(), kKinds.end(), name) - kKinds.begin());
}

void RecordReader::refuse(const std::string& reason) const { throw Error(lines_.place(), reason, kPutBack); }

RecordLine RecordReader::read(std::string_view line) {
  RecordLine out{kind_of_line(line), {}, {}, {}};
  if (!holds_lists(out.kind)) {
    out.row = lines_.read(std::string(line));
    if (out.kind == LineKind::end) out.end = ending_of(out.row);
  } else {
    lines_.skip();
    if (line.size() > kMostManifestBytes) refuse("is too long: a line has at most 64 MiB");
    const std::string text(line);
    // The location in the parser's message is replaced, because the parser counts lines within this line only.
    const auto trouble = catch_error([&] { out.tree = parse_json(text, file()); });
    if (trouble)
      throw Error(lines_.place(), trouble->where() == file().string() ? trouble->reason() : "is not a JSON object",
                  trouble->where() == file().string() ? kPutBack : "the file is damaged");
  }
  check(out);
  return out;
}

void RecordReader::check(const RecordLine& line) {
  if (end_ == Ending::EndKind::done) refuse("follows the end of a finished run");
  if (!begun_ && line.kind != LineKind::manifest) refuse("is not the manifest, which must be the first line");
  if (begun_ && line.kind == LineKind::manifest) refuse("is a second manifest");
  if (end_ && line.kind != LineKind::attempt) refuse("follows the end of an attempt but does not start a new one");
  if (line.kind == LineKind::other) return;
  end_.reset();
  switch (line.kind) {
    case LineKind::manifest:
      begun_ = true;
      check_version(line.tree);
      break;
    case LineKind::attempt:
      check_attempt(line.row);
      break;
    case LineKind::setup:
      check_setup(line.tree);
      break;
    case LineKind::intent:
    case LineKind::tap:
      check_tap(line.row, line.kind == LineKind::intent);
      break;
    case LineKind::timing:
      check_timing(line.row);
      break;
    case LineKind::end:
      check_end(line);
      break;
    case LineKind::objects:
      if (line.tree.find("objects")->kind != Tree::Kind::list) refuse("has no list 'objects'");
      break;
    case LineKind::note:
    case LineKind::other:
      break;
  }
  last_ = line.kind;
}

void RecordReader::check_version(const Tree& manifest) const {
  const std::string& text = manifest.find("manifest")->text;
  int version = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), version);
  if (wrong != std::errc() || end != text.data() + text.size() || version < 1) refuse("has no version 'manifest'");
  if (version <= kRecordVersion) return;
  throw Error(lines_.place(), "has a later version than this palpate can read",
              "use a palpate at least as new as the one that wrote it");
}

void RecordReader::check_attempt(const Row& row) {
  const auto number = count_in(row, "attempt");
  if (number != attempts_ + 1)
    refuse(fmt::format("has attempt {} instead of attempt {}: a line is missing", row.cell("attempt"), attempts_ + 1));
  if (count_in(row, "after_tap") != taps_)
    refuse(fmt::format("starts after tap {}, but the taps before it are {}: a line is missing", row.cell("after_tap"),
                       taps_));
  ++attempts_;
  set_up_ = false;
}

void RecordReader::check_setup(const Tree& line) {
  if (last_ != LineKind::attempt || line.find("setup")->text != std::to_string(attempts_))
    refuse("does not follow its attempt: a line is missing");
  const Tree* const announces = line.find("announces");
  announces_ = announces != nullptr && announces->text == "true";
  set_up_ = true;
}

void RecordReader::check_tap(const Row& row, bool announces) {
  const char* const key = announces ? "intent" : "tap";
  const auto tap = count_in(row, key);
  const std::int64_t next = taps_ + 1;
  if (!tap) refuse(fmt::format("has no number '{}'", key));
  if (*tap != next)
    refuse(*tap > next ? fmt::format("has tap {} instead of tap {}: a line is missing", *tap, next)
           : announces ? fmt::format("announces tap {}, which is recorded already", *tap)
                       : fmt::format("has tap {} a second time instead of tap {}", *tap, next));
  if (!set_up_) refuse(fmt::format("has tap {} before its attempt was set up: a line is missing", *tap));
  if (announces && announced_) refuse(fmt::format("announces tap {} a second time", *tap));
  if (!announces && announces_ && !announced_)
    refuse(fmt::format("has tap {}, which was not announced: a line is missing", *tap));
  announced_ = announces;
  taps_ += announces ? 0 : 1;
}

void RecordReader::check_timing(const Row& row) const {
  if (last_ != LineKind::tap || count_in(row, "timing") != taps_)
    refuse(fmt::format("has the times of tap {}, but does not follow that tap", row.cell("timing")));
  for (const char* phase : kPhaseNames)
    if (row.find(phase) != nullptr && !row.number(phase)) refuse(fmt::format("has no number '{}'", phase));
}

void RecordReader::check_end(const RecordLine& line) {
  if (!line.end) refuse(kNoEnding);
  end_ = line.end->how;
  if (end_ != Ending::EndKind::done || line.row.number("summary.taps") == static_cast<double>(taps_)) return;
  refuse(fmt::format("ends a run of {} taps, but the taps before it are {}: a line is missing",
                     line.row.cell("summary.taps"), taps_));
}

std::string RunRecord::build() const {
  const Tree* const build = manifest ? manifest->find("build") : nullptr;
  if (build != nullptr) return build->text;
  return attempts.empty() ? "" : attempts.front().text("build");
}

RunRecord read_run_record(const fs::path& directory) {
  RunRecord out;
  out.file = directory / kRecordFile;
  RecordReader reader(out.file);
  for_lines(read_if_there(out.file).value_or(""), [&](std::string_view text) { add_line(reader.read(text), out); });
  return out;
}

std::optional<Tree> read_manifest(const fs::path& directory) {
  const fs::path file = directory / kRecordFile;
  const std::optional<std::string> first = first_line_if_there(file);
  if (!first) return std::nullopt;
  return RecordReader(file).read(*first).tree;
}

RecordEnd read_record_end(const fs::path& directory) {
  const fs::path file = directory / kRecordFile;
  const std::optional<LastLine> last = last_line_if_there(file);
  if (!last || last->whole == 0) return {};
  if (kind_of_line(last->text) != LineKind::end) return {true, std::nullopt};
  std::string reason = "is too long: a line has at most 1 MiB";
  std::optional<Row> row;
  if (last->text.size() <= kMostLineBytes) row = parse_json_row(last->text, &reason);
  if (row) reason = kNoEnding;
  std::optional<Ending> end = row ? ending_of(std::move(*row)) : std::nullopt;
  if (!end) throw Error(file.string(), "its last line " + reason, kPutBack);
  return {true, std::move(end)};
}

int attempts_in_row(const fs::path& directory) {
  std::string text;
  // If the record cannot be read, the number of attempts is 0, because RecordWriter reports the error later. A failure
  // of the file system is reported here.
  const auto trouble = catch_error([&] { text = read_if_there(directory / kRecordFile).value_or(""); });
  if (trouble && trouble->kind() == Error::Kind::run) throw *trouble;
  int out = 0;
  bool ended = false;
  for_lines(text, [&](std::string_view line) {
    const LineKind kind = kind_of_line(line);
    if (kind == LineKind::attempt) out = std::exchange(ended, false) ? 1 : out + 1;
    if (kind == LineKind::end) ended = true;
  });
  return out;
}

std::vector<Row> timing_rows(const std::vector<TapTimes>& timings) {
  std::vector<Row> out;
  for (const TapTimes& one : timings) out.push_back(timing_list().row(one));
  return out;
}

}  // namespace palpate
