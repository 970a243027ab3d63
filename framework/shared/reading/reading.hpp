// SPDX-License-Identifier: MIT
// The one reader of files that come from elsewhere: records, configs, meshes, views, tables and what the system tells
// of its processes. It opens regular files only, reads no more than a limit, and follows no link in a record.
//
// Framework and shipped plugins both use it. Nothing else in them opens a file for reading or lists a folder
// (tests/habits.sh).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpate {

/// Limits in bytes: for each kind of content a multiple of the largest that palpate writes or documents.
constexpr std::uintmax_t kMostConfigBytes = std::uintmax_t{1} << 20;     ///< of a config or a file of a group
constexpr std::uintmax_t kMostManifestBytes = std::uintmax_t{64} << 20;  ///< of a line of a record that holds lists
constexpr std::uintmax_t kMostLogBytes = std::uintmax_t{512} << 20;      ///< of all lines of a record or of a sweep
constexpr std::uintmax_t kMostLineBytes = std::uintmax_t{1} << 20;       ///< of one of them; it has about 2 kB
constexpr std::uintmax_t kMostViewBytes = std::uintmax_t{64} << 20;
constexpr std::uintmax_t kMostMeshBytes = 500'000'000;
constexpr std::uintmax_t kMostLibraryBytes = std::uintmax_t{1} << 30;
constexpr std::uintmax_t kMostSystemBytes = std::uintmax_t{16} << 20;  ///< of a file in /proc

/// Who chose where a file lies.
enum class Origin {
  user,   ///< A command line, a config of the user or the installation: links are followed.
  record  ///< A name in a record, which a stranger may have sent: neither it nor the folder of a job is a link.
};

/// Result of reading a file.
struct Reading {
  enum class Kind {
    whole,
    absent,       ///< nothing is there, or nothing for this user
    not_regular,  ///< a folder, pipe, socket or device
    link,         ///< a link in a record
    too_large,
    failed  ///< the file system refused; `reason` says why
  };

  Kind kind = Kind::absent;
  std::string text;          ///< the content of a whole one
  std::error_code reason{};  ///< of one that is absent or failed
  std::uintmax_t begin = 0;  ///< where in the file the text begins

  explicit operator bool() const { return kind == Kind::whole; }
};

/// Reads a file of at most `most_bytes`. It returns at once whatever is in the place of the file: no pipe is waited
/// for and no device is opened. Throws nothing but std::bad_alloc.
Reading read_bounded(const std::filesystem::path& file, std::uintmax_t most_bytes, Origin origin);

/// Reads the first, or the last, `bytes` of a file of at most kMostLogBytes, all of a shorter one; else as
/// read_bounded().
Reading read_begin_bounded(const std::filesystem::path& file, std::uintmax_t bytes, Origin origin);
Reading read_end_bounded(const std::filesystem::path& file, std::uintmax_t bytes, Origin origin);

/// Takes the mark away with which some programs begin a text in UTF-8.
void drop_byte_order_mark(std::string& text);

/// Returns what an Error says of a reading that is not whole: its reason and its remedy. `most_bytes` is the limit that
/// was given.
struct ReadingWords {
  std::string reason;
  std::string remedy;
};
ReadingWords words_of(const Reading& reading, std::uintmax_t most_bytes);

/// Returns the paths in a folder, sorted, without "." and ".."; none where it cannot be listed, with `trouble`.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder, std::error_code& trouble);
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

/// Returns `text` with each control character (C0, DEL, C1), each sign that turns the direction of writing and each
/// byte that is not UTF-8 as \xNN or \uNNNN, so that no text of a stranger moves the cursor of a terminal or hides what
/// is there. Line ends and tabs stay.
std::string printable(std::string_view text);

/// Returns `text` as one line, cut between characters after about `most` bytes: what printable() would replace, line
/// ends and tabs become blanks.
std::string one_line(std::string_view text, std::size_t most = std::string::npos);

/// The length of the UTF-8 sequence that `text` begins with; 0 if it is not valid (RFC 3629). `text` is not empty.
std::size_t utf8_length(std::string_view text);

}  // namespace palpate
