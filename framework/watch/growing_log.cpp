// SPDX-License-Identifier: MIT
#include "watch/growing_log.hpp"

#include "config/catch_error.hpp"
#include "record/files.hpp"

#include <utility>

#include <sys/stat.h>

namespace palpate {

std::vector<RecordLine> GrowingLog::read(bool& anew) {
  struct stat now {};
  const bool there = ::stat(file().c_str(), &now) == 0;
  const Stamp stamp = there ? Stamp{now.st_ino, now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec} : Stamp{};
  if (stamp == stamp_) return {};
  stamp_ = stamp;
  std::string text = there ? read_file(file()) : "";
  text.resize(text.rfind('\n') + 1);
  anew = text.compare(0, known_.size(), known_) != 0;
  if (anew || known_.empty()) reader_ = RecordReader(file());
  std::vector<RecordLine> lines;
  for (std::size_t begin = anew ? 0 : known_.size(), end = 0; begin < text.size(); begin = end + 1) {
    end = text.find('\n', begin);
    const auto trouble =
        catch_error([&] { lines.push_back(reader_.read(std::string_view(text).substr(begin, end - begin))); });
    if (trouble) {
      known_.clear();
      throw *trouble;
    }
  }
  known_ = std::move(text);
  return lines;
}

}  // namespace palpate
