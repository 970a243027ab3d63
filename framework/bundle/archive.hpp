// SPDX-License-Identifier: MIT
// The archive of a bundle: regular files in the POSIX format ustar, compressed by gzip. tar can unpack it.
//
// Equal files give equal bytes of the uncompressed archive: the files are sorted by name, and have the mode 0644, the
// owner 0 and the time 0. The reader accepts only headers that the writer would have written, so an archive of another
// user contains no links, devices, other modes or strange names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace palpate {

/// Files by their names. A name is a path of at most 200 bytes and 12 levels. Each level has letters, digits, '.', '_',
/// '~' and '-' only, and is neither "." nor "..". No two names are equal except for capital letters, and no name is
/// also the folder of another name.
using ArchivedFiles = std::map<std::string, std::string>;

/// Default of the largest sum of the sizes of the files of an archive that is read, bytes.
inline constexpr std::uintmax_t kMostArchivedBytes = std::uintmax_t{1} << 30;

/// Returns the SHA-256 hash of `bytes` (FIPS 180-4) as 64 hex digits.
std::string sha256_of(std::string_view bytes);

/// Throws Error, with the place `file`, for a name that ArchivedFiles does not allow by itself.
void check_archived_name(const std::string& name, const std::string& file);

/// Writes `files`, below the folder `folder`, to the archive `file`. Throws Error.
void write_archive(const std::filesystem::path& file, const std::string& folder, const ArchivedFiles& files);

/// Passes the files of an archive to `use`, one after the other, without their common folder. Throws Error, with the
/// place `file`, at the first part that write_archive() would not have written. Also throws if the files have more than
/// `most_bytes`, or one of them more than an eighth of it, or are more than 100000 per GiB of it, or if the archive is
/// compressed by far more than records can be.
void read_archive(const std::filesystem::path& file, std::uintmax_t most_bytes,
                  const std::function<void(const std::string& name, const std::string& content)>& use);

}  // namespace palpate
