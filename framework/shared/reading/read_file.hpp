// SPDX-License-Identifier: MIT
// Reads all files that come from outside of the program: records, configs, meshes, point clouds, tables and files of
// /proc. The functions open regular files only, read at most a given number of bytes, and do not follow links in a
// record.
//
// Framework and shipped plugins read files and list folders only with these functions; tests/habits.sh checks this
// rule.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpate {

/// Limits of file sizes in bytes. Each limit is several times the largest size that palpate writes or documents.
constexpr std::uintmax_t kMostConfigBytes = std::uintmax_t{1} << 20;     ///< a config or a file of a group
constexpr std::uintmax_t kMostManifestBytes = std::uintmax_t{64} << 20;  ///< a line of a record that contains lists
constexpr std::uintmax_t kMostLogBytes = std::uintmax_t{512} << 20;      ///< all lines of a record or of a sweep
constexpr std::uintmax_t kMostLineBytes = std::uintmax_t{1} << 20;       ///< a line of a record; usually 2 kB
constexpr std::uintmax_t kMostViewBytes = std::uintmax_t{64} << 20;
constexpr std::uintmax_t kMostMeshBytes = 500'000'000;
constexpr std::uintmax_t kMostLibraryBytes = std::uintmax_t{1} << 30;
constexpr std::uintmax_t kMostSystemBytes = std::uintmax_t{16} << 20;  ///< a file in /proc

/// Source of a file's name.
enum class FileOrigin {
  user,  ///< the name is from a command line, a config of the user, or the installation: links are followed
  /// the file is in a record, possibly of another user: no links are followed, not even a link to the folder of a job
  record
};

/// Result of reading a file.
struct FileReading {
  enum class Kind {
    whole,
    absent,       ///< no such file
    not_regular,  ///< a folder, pipe, socket or device
    link,         ///< a link in a record
    too_large,
    failed  ///< the file system returned the error `reason`
  };

  Kind kind = Kind::absent;
  std::string text;          ///< content of the file, if `kind` is `whole`
  std::error_code reason{};  ///< error of the file system, if `kind` is `absent` or `failed`
  std::uintmax_t begin = 0;  ///< position in the file at which `text` begins, bytes

  explicit operator bool() const { return kind == Kind::whole; }
};

/// Reads a whole file, which must have at most `most_bytes`. Never blocks on a pipe and opens no device. Throws only
/// std::bad_alloc.
FileReading read_bounded(const std::filesystem::path& file, std::uintmax_t most_bytes, FileOrigin origin);

/// Read the first, or the last, `bytes` of a file of at most kMostLogBytes. A file with fewer bytes is read as a whole.
/// In all other respects, these functions behave like read_bounded().
FileReading read_begin_bounded(const std::filesystem::path& file, std::uintmax_t bytes, FileOrigin origin);
FileReading read_end_bounded(const std::filesystem::path& file, std::uintmax_t bytes, FileOrigin origin);

/// Removes the byte order mark at the beginning of a UTF-8 text.
void drop_byte_order_mark(std::string& text);

/// Parts of an Error about a file that was not read.
struct ReadingFault {
  std::string reason;
  std::string remedy;
};
/// Returns reason and remedy for a reading whose kind is not `whole`. `most_bytes` is the limit with which the file was
/// read.
ReadingFault words_of(const FileReading& reading, std::uintmax_t most_bytes);

/// Returns the paths in a folder, sorted, without "." and "..". Returns an empty list and sets `trouble` if the folder
/// cannot be listed.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder, std::error_code& trouble);
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

/// Returns `text` with \xNN or \uNNNN in place of control characters (C0, DEL, C1), marks that change the direction of
/// writing, and bytes that are not UTF-8. So a text from another user cannot move the cursor of a terminal or hide
/// text. Line ends and tabs are kept.
std::string printable(std::string_view text);

/// Returns `text` as one line, cut between characters after about `most` bytes. Blanks replace line ends, tabs and the
/// characters that printable() would replace.
std::string one_line(std::string_view text, std::size_t most = std::string::npos);

/// Returns the length of the UTF-8 sequence at the beginning of `text`; 0 if it is invalid (RFC 3629). `text` is not
/// empty.
std::size_t utf8_length(std::string_view text);

}  // namespace palpate
