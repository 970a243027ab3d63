// SPDX-License-Identifier: MIT
#include "process/diary.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::process {
namespace {

constexpr const char* kNote = "\n[here %15lld bytes are left out]\n";

std::string note_of(long long bytes) {
  std::array<char, 64> line{};
  std::snprintf(line.data(), line.size(), kNote, bytes);
  return line.data();
}

const auto kNoteLength = static_cast<off_t>(note_of(0).size());

}  // namespace

Diary::Diary(const std::string& file)
    : file_(open_recorded(file.empty() ? "/dev/null" : file, O_RDWR | O_APPEND)), kept_(!file.empty()) {
  if (!kept_) return;
  begin_ = size();
  const std::string note = read(kFirst, kFirst + kNoteLength);
  long long before = 0;
  if (std::sscanf(note.c_str(), kNote, &before) == 1 && note == note_of(before)) left_out_ = before;
}

void Diary::trim() {
  const off_t end = kept_ ? size() : 0;
  const off_t noted = kFirst + (left_out_ > 0 ? kNoteLength : 0);
  if (end <= noted + 2 * kLast) return;
  const std::string last = read(end - kLast, end);
  left_out_ += end - kLast - noted;
  // What the program writes now is lost between the two, or comes to stand before the note: no more than that.
  left_out_ += std::max<off_t>(0, size() - end);
  if (::ftruncate(file_.number(), kFirst) != 0) return;
  write_all(file_, note_of(left_out_) + last);  // a full disk costs words of a program, no tap
  begin_ = std::min(begin_, kFirst);
}

std::string Diary::last_words() const {
  if (!kept_) return {};
  constexpr off_t kEnough = 1024;
  const off_t end = size();
  std::string text = read(std::max(begin_, end - kEnough), end);
  text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.find_last_of('\n') + 1);
}

off_t Diary::size() const { return ::lseek(file_.number(), 0, SEEK_END); }

std::string Diary::read(off_t begin, off_t end) const {
  std::string out(static_cast<std::size_t>(std::max<off_t>(0, end - begin)), '\0');
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = ::pread(file_.number(), out.data() + done, out.size() - done, begin + static_cast<off_t>(done));
    if (got == 0 || (got < 0 && errno != EINTR)) break;
    done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  }
  out.resize(done);
  return out;
}

}  // namespace palpate::process
