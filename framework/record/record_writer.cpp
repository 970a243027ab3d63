// SPDX-License-Identifier: MIT
#include "record/record_writer.hpp"

#include "record/json.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

namespace palpate {

std::string now_text() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now())); }

RecordWriter::RecordWriter(const std::filesystem::path& directory)
    : directory_(directory), lock_(make_folder(directory) / kRecordFile) {}

const RunRecord& RecordWriter::before() {
  if (!before_) {
    before_ = read_run_record(directory_);
    begun_ = before_->manifest.has_value();
    ended_ = before_->end.has_value();
    attempts_ = static_cast<std::int64_t>(before_->attempts.size());
  }
  return *before_;
}

AppendFile& RecordWriter::log() {
  if (log_) return *log_;
  const std::optional<LastLine> last = last_line_if_there(directory_ / kRecordFile);
  AppendFile file = lock_.append_file();
  if (last && last->whole < last->bytes) {
    file.cut(last->whole);
    cut_ = last->bytes - last->whole;
  }
  return log_.emplace(std::move(file));
}

void RecordWriter::append(const std::string& lines, bool sync) {
  check_held();
  log().append(lines, sync);
}

void RecordWriter::clear() {
  check_held();
  log().cut(0);
  RunRecord nothing;
  nothing.file = directory_ / kRecordFile;
  before_ = std::move(nothing);
  begun_ = ended_ = false;
  attempts_ = 0;
}

void RecordWriter::add_manifest(const Tree& manifest, bool sync) {
  before();  // reads the record before its first line is written
  append(to_json_line(manifest) + "\n", sync);
  begun_ = true;
}

void RecordWriter::add_attempt(const Row& attempt) {
  const auto taps = static_cast<std::int64_t>(before().taps.size());
  check_held();
  log();  // deletes an incomplete last line
  Row row;
  row.add("attempt", attempts_ + 1);
  row.add("at", now_text());
  row.add("after_tap", taps);
  row.fields.insert(row.fields.end(), attempt.fields.begin(), attempt.fields.end());
  if (cut_ > 0) row.add("cut", static_cast<std::int64_t>(cut_));
  append(to_json_line(row) + "\n", false);
  ++attempts_;
  ended_ = false;
}

void RecordWriter::add_setup(bool announces, const Tree& models, bool sync) {
  Tree line = Tree::map({{"setup", Tree::scalar(std::to_string(attempts_))},
                         {"announces", Tree::scalar(announces ? "true" : "false")},
                         {"models", models}});
  append(to_json_line(line) + "\n", sync);
}

void RecordWriter::add_tap(const Row& tap, bool sync) { append(to_json_line(tap) + "\n", sync); }

void RecordWriter::add_timing(const TapTimes& times) {
  Tree line = Tree::map({{"timing", Tree::scalar(std::to_string(times.tap))}});
  for (std::size_t i = 0; i < kPhases; ++i)
    line.at(kPhaseNames[i]) = Tree::scalar(fmt::format("{:.9f}", times.seconds[i]));
  if (times.expected_rmse && std::isfinite(*times.expected_rmse))
    line.at("expected_rmse_m") = Tree::scalar(csv_cell(*times.expected_rmse));
  append(to_json_line(line) + "\n", false);
}

void RecordWriter::add_objects(const std::vector<Row>& objects, bool sync) {
  if (!objects.empty()) append(to_json_line(Row{{{"objects", list_of(objects)}}}) + "\n", sync);
}

void RecordWriter::add_note(const std::string& kind, const Row& note, bool sync) {
  Row row;
  row.add("note", kind);
  row.fields.insert(row.fields.end(), note.fields.begin(), note.fields.end());
  append(to_json_line(row) + "\n", sync);
}

void RecordWriter::add_end(const Ending& ending, bool sync) {
  Row row;
  row.add("end", std::string(ending_name(ending.how)));
  row.add("attempt", attempts_);
  row.add("at", now_text());
  row.add("reason", ending.reason);
  for (const auto& [name, value] : ending.summary.fields) row.add("summary." + name, value);
  Tree files = Tree::map();
  for (const Ending::ListedFile& one : ending.files)
    files.at(one.name) =
        Tree::map({{"bytes", Tree::scalar(std::to_string(one.bytes))}, {"hash", Tree::quote(one.hash)}});
  row.add("files", JsonList{to_json_line(files)});
  check_held();
  log().flush();
  append(to_json_line(row) + "\n", sync);
  ended_ = true;
  log().flush();
}

void RecordWriter::sync_name() const { sync_names(directory_); }

}  // namespace palpate
