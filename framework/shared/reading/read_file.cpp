// SPDX-License-Identifier: MIT
#include "reading/read_file.hpp"

#include <boost/locale/utf.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

FileReading failed(int reason) {
  // Only these errors mean that there is no such file. All other errors, for example missing permissions, are failures.
  const bool absent = reason == ENOENT || reason == ENOTDIR || reason == ENAMETOOLONG;
  return {absent ? FileReading::Kind::absent : FileReading::Kind::failed, {}, {reason, std::generic_category()}};
}

bool is_link(const fs::path& path) {
  struct stat what {};
  return ::lstat(path.c_str(), &what) == 0 && S_ISLNK(what.st_mode);
}

/// Returns whether jobs/ or jobs/<id>/ is a link in the path jobs/<id>/NAME of a job's file. All files of a sweep must
/// be within its own folder.
bool job_is_linked(const fs::path& file) {
  constexpr std::size_t kIdLength = 12;
  const fs::path job = file.parent_path();
  const std::string id = job.filename().string();
  if (id.size() != kIdLength || id.find_first_not_of("0123456789abcdef") != std::string::npos) return false;
  const fs::path jobs = job.parent_path();
  return jobs.filename() == "jobs" && (is_link(job) || is_link(jobs));
}

/// Reads up to `most_bytes`. `size` is only a hint, because files grow, and files of /proc have size 0.
FileReading read_descriptor(int number, std::uintmax_t size, std::uintmax_t most_bytes) {
  FileReading out{FileReading::Kind::whole, {}};
  if (size > most_bytes) return {FileReading::Kind::too_large, {}};
  std::string& text = out.text;
  text.resize(size + 1);  // one byte more, so that `text` need not grow before a read() finds the end of the file
  for (std::size_t read = 0;;) {
    const ssize_t more = ::read(number, text.data() + read, text.size() - read);
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) return failed(errno);
    read += static_cast<std::size_t>(more);
    if (read > most_bytes) return {FileReading::Kind::too_large, {}};
    if (more == 0) return text.resize(read), out;
    if (read == text.size()) text.resize(2 * text.size() + 4096);
  }
}

/// Reads the bytes from `begin` to `end`, or to the end of the file.
FileReading read_part(int number, std::uintmax_t begin, std::uintmax_t end) {
  if (end > kMostLogBytes) return {FileReading::Kind::too_large, {}};
  FileReading out{FileReading::Kind::whole, {}};
  out.begin = begin;
  out.text.resize(end - begin);
  for (std::size_t read = 0; read < out.text.size();) {
    const ssize_t more =
        ::pread(number, out.text.data() + read, out.text.size() - read, static_cast<off_t>(begin + read));
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) return failed(errno);
    if (more == 0) out.text.resize(read);
    read += static_cast<std::size_t>(more);
  }
  return out;
}

/// Opens a regular file and returns use(descriptor, size).
template <class Use>
FileReading with_file(const fs::path& file, FileOrigin origin, const Use& use) {
  const bool inner = origin == FileOrigin::record;
  struct stat seen {};
  // The type is checked before open(), because opening a device may have an effect.
  if ((inner ? ::lstat(file.c_str(), &seen) : ::stat(file.c_str(), &seen)) != 0) return failed(errno);
  if (S_ISLNK(seen.st_mode) || (inner && job_is_linked(file))) return {FileReading::Kind::link, {}};
  if (!S_ISREG(seen.st_mode)) return {FileReading::Kind::not_regular, {}};
  const int number = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | (inner ? O_NOFOLLOW : 0));
  if (number < 0) return failed(errno);
  struct stat opened {};
  FileReading out = ::fstat(number, &opened) != 0 ? failed(errno)
                    : !S_ISREG(opened.st_mode)    ? FileReading{FileReading::Kind::not_regular, {}}
                                                  : use(number, static_cast<std::uintmax_t>(opened.st_size));
  ::close(number);
  return out;
}

/// Returns the first code point of `text` and its length in bytes (RFC 3629); length 0 if it is not UTF-8.
std::pair<std::uint32_t, std::size_t> first_code_point(std::string_view text) {
  const char* end = text.data();
  const std::uint32_t point = boost::locale::utf::utf_traits<char>::decode(end, text.data() + text.size());
  if (!boost::locale::utf::is_valid_codepoint(point)) return {0, 0};
  return {point, static_cast<std::size_t>(end - text.data())};
}

/// Returns whether a code point is a control character: C0, DEL or C1.
bool is_control(std::uint32_t point) { return point < 0x20 || (point >= 0x7f && point < 0xa0); }

/// Returns whether a code point has the Unicode property Bidi_Control, or is a line or paragraph separator.
bool changes_layout(std::uint32_t point) {
  return point == 0x61c || point == 0x200e || point == 0x200f || (point >= 0x2028 && point <= 0x202e) ||
         (point >= 0x2066 && point <= 0x2069);
}

}  // namespace

FileReading read_bounded(const fs::path& file, std::uintmax_t most_bytes, FileOrigin origin) {
  return with_file(file, origin,
                   [&](int number, std::uintmax_t size) { return read_descriptor(number, size, most_bytes); });
}

FileReading read_begin_bounded(const fs::path& file, std::uintmax_t bytes, FileOrigin origin) {
  return with_file(file, origin, [&](int number, std::uintmax_t size) {
    if (size > kMostLogBytes) return FileReading{FileReading::Kind::too_large, {}};
    return read_part(number, 0, std::min(size, bytes));
  });
}

FileReading read_end_bounded(const fs::path& file, std::uintmax_t bytes, FileOrigin origin) {
  return with_file(file, origin, [&](int number, std::uintmax_t size) {
    return read_part(number, size - std::min(size, bytes), size);
  });
}

void drop_byte_order_mark(std::string& text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.compare(0, kMark.size(), kMark) == 0) text.erase(0, kMark.size());
}

ReadingFault words_of(const FileReading& reading, std::uintmax_t most_bytes) {
  switch (reading.kind) {
    case FileReading::Kind::not_regular:
      return {"is not a regular file", "put a file in its place, or remove it"};
    case FileReading::Kind::link:
      return {"is a symbolic link, and links in a record are not followed", "remove it"};
    case FileReading::Kind::too_large: {
      const std::uintmax_t mebibyte = std::uintmax_t{1} << 20;
      const std::string most = most_bytes < mebibyte ? std::to_string(most_bytes) + " bytes"
                                                     : std::to_string(most_bytes / mebibyte) + " MiB";
      return {"is too large for its purpose: at most " + most + " are read",
              "the file is damaged: put it back as it was"};
    }
    case FileReading::Kind::whole:
    case FileReading::Kind::absent:
    case FileReading::Kind::failed:
      break;
  }
  return {reading.reason ? "cannot be read: " + reading.reason.message() : "cannot be read", {}};
}

std::vector<fs::path> list_folder(const fs::path& folder, std::error_code& trouble) {
  std::vector<fs::path> out;
  fs::directory_iterator one(folder, trouble);
  for (; !trouble && one != fs::directory_iterator(); one.increment(trouble)) out.push_back(one->path());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<fs::path> list_folder(const fs::path& folder) {
  std::error_code none;
  return list_folder(folder, none);
}

std::string one_line(std::string_view text, std::size_t most) {
  std::string out;
  while (!text.empty()) {
    if (out.size() >= most) return out + "...";
    const auto [point, length] = first_code_point(text);
    const std::size_t bytes = std::max<std::size_t>(length, 1);
    out += length == 0 || is_control(point) || changes_layout(point) ? " " : text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

std::size_t utf8_length(std::string_view text) { return first_code_point(text).second; }

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  std::array<char, 16> escape{};
  for (std::size_t at = 0; at < text.size();) {
    const auto [point, length] = first_code_point(text.substr(at));
    if (length == 0 || (is_control(point) && point != '\n' && point != '\t')) {
      const unsigned number = length == 0 ? static_cast<unsigned char>(text[at]) : point;
      std::snprintf(escape.data(), escape.size(), "\\x%02x", number);
      out += escape.data();
    } else if (changes_layout(point)) {
      std::snprintf(escape.data(), escape.size(), "\\u%04x", point);
      out += escape.data();
    } else {
      out += text.substr(at, length);
    }
    at += std::max<std::size_t>(length, 1);
  }
  return out;
}

}  // namespace palpate
