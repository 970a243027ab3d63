// SPDX-License-Identifier: MIT
#include "watch/growing_log.hpp"

#include "config/trouble.hpp"
#include "record/files.hpp"
#include "record/tap_row.hpp"

#include <utility>

#include <sys/stat.h>

namespace palpate {

std::vector<Row> GrowingLog::read(bool& anew) {
  struct stat now {};
  const bool there = ::stat(file().c_str(), &now) == 0;
  const Stamp stamp = there ? Stamp{now.st_ino, now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec} : Stamp{};
  if (stamp == stamp_) return {};
  stamp_ = stamp;
  std::string text = there ? read_file(file()) : "";
  text.resize(text.rfind('\n') + 1);
  anew = text.compare(0, known_.size(), known_) != 0;
  if (anew || known_.empty()) lines_ = TapLines(file());
  std::vector<Row> rows;
  for (std::size_t begin = anew ? 0 : known_.size(), end = 0; begin < text.size(); begin = end + 1) {
    end = text.find('\n', begin);
    std::optional<Row> row;
    const auto trouble = trouble_in([&] { row = lines_.read(std::string_view(text).substr(begin, end - begin)); });
    if (trouble) {
      known_.clear();
      throw *trouble;
    }
    if (row && !is_intent(*row)) rows.push_back(std::move(*row));
  }
  known_ = std::move(text);
  return rows;
}

}  // namespace palpate
