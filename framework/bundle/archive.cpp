// SPDX-License-Identifier: MIT
#include "bundle/archive.hpp"

#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <locale>
#include <memory>
#include <optional>

#include <nettle/sha2.h>
#include <zlib.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBlock = 512;        ///< size of a header; contents are padded to a multiple of it
constexpr std::size_t kShortName = 100;    ///< longer names are split at a '/' into `prefix` and `name`
constexpr std::size_t kLongestName = 200;  ///< without the folder of the bundle
constexpr std::size_t kLongestPrefix = 155;
constexpr std::ptrdiff_t kMostLevels = 12;
constexpr std::size_t kMostFiles = 100'000;  ///< per GiB of the limit; a sweep of 4000 runs has 8000
constexpr std::size_t kFoldersPerFile = 2;
constexpr std::uintmax_t kFilesPerLimit =
    8;  ///< a file has at most this part of the limit, because it is kept in memory
/// Records are compressed about 14 : 1. A larger ratio than this, after the first bytes, is no archive of records.
constexpr std::uintmax_t kMostRatio = 60;
constexpr std::uintmax_t kFreeBytes = std::uintmax_t{16} << 20;

Error refused(const std::string& file, const std::string& reason, const std::string& remedy = {}) {
  return {file, reason, remedy.empty() ? "make it again with 'palpate bundle', or ask its author for it" : remedy};
}

/// Returns the ustar header of a regular file. Throws Error for a name that has no place in it.
std::string header_of(const std::string& path, std::uintmax_t size, const std::string& file) {
  std::string name = path;
  std::string prefix;
  if (path.size() > kShortName) {
    const std::size_t cut = path.find('/', path.size() - kShortName - 1);
    if (cut > kLongestPrefix)  // also without a '/'
      throw refused(file, "the name '" + path + "' is too long");
    prefix = path.substr(0, cut);
    name = path.substr(cut + 1);
  }
  std::string out(kBlock, '\0');
  const auto put = [&](std::size_t at, const std::string& text) { out.replace(at, text.size(), text); };
  put(0, name);
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, fmt::format("{:011o}", size));
  put(136, "00000000000");
  put(148, "        ");
  put(156, "0");
  put(257, "ustar");
  put(263, "00");
  put(329, "0000000");
  put(337, "0000000");
  put(345, prefix);
  unsigned sum = 0;
  for (const char c : out) sum += static_cast<unsigned char>(c);
  put(148, fmt::format("{:06o}", sum));
  out[154] = '\0';
  return out;
}

std::string padding_of(std::uintmax_t size) { return std::string((kBlock - size % kBlock) % kBlock, '\0'); }

struct CloseGzip {
  void operator()(gzFile file) const { gzclose(file); }
};
using GzipFile = std::unique_ptr<gzFile_s, CloseGzip>;

/// Reads a compressed file.
class GzipReader {
 public:
  explicit GzipReader(const fs::path& file) : name_(file.string()) {
    if (!fs::is_regular_file(file)) throw refused(name_, "is not a file", "name a bundle: NAME.palpate.tar.gz");
    in_.reset(gzopen(file.c_str(), "rb"));
    if (!in_ || gzdirect(in_.get()) != 0) throw refused(name_, "is not an archive of gzip, or cannot be read");
  }

  /// Returns up to `bytes` next bytes.
  std::string read_some(std::uintmax_t bytes) {
    std::string out;
    out.reserve(bytes);  // The number may come from the file; memory is used only as far as the bytes exist.
    std::array<char, 1 << 16> chunk;
    for (int got = 1; got > 0 && out.size() < bytes; out.append(chunk.data(), static_cast<std::size_t>(got))) {
      got = gzread(in_.get(), chunk.data(),
                   static_cast<unsigned>(std::min<std::uintmax_t>(bytes - out.size(), chunk.size())));
      if (got < 0) throw refused(name_, "is damaged");
      const auto unpacked = static_cast<std::uintmax_t>(gztell(in_.get()));
      if (unpacked > kFreeBytes && unpacked / kMostRatio > static_cast<std::uintmax_t>(gzoffset(in_.get())))
        throw refused(name_, fmt::format("is compressed by more than {} : 1, so it holds no records", kMostRatio));
    }
    int status = Z_OK;
    gzerror(in_.get(), &status);
    if (status == Z_BUF_ERROR) throw refused(name_, "ends too early");
    return out;
  }
  /// Returns the next `bytes` bytes. Throws Error if there are fewer.
  std::string read(std::uintmax_t bytes) {
    std::string out = read_some(bytes);
    if (out.size() < bytes) throw refused(name_, "ends too early");
    return out;
  }

 private:
  std::string name_;
  GzipFile in_;
};

/// Returns the text in a field of a header, which ends at its first zero.
std::string field_of(const std::string& header, std::size_t at, std::size_t length) {
  const std::string field = header.substr(at, length);
  return field.substr(0, field.find('\0'));
}

/// The names of the files and folders so far, to find those that some file system cannot have together.
class KnownNames {
 public:
  void add(const std::string& name, const std::string& file) {
    if (name <= last_) throw refused(file, fmt::format("its files are not sorted: '{}' follows '{}'", name, last_));
    last_ = name;
    for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1))
      add_part(name.substr(0, slash), true, file);
    add_part(name, false, file);
  }
  /// Returns the number of files and folders.
  std::size_t size() const { return parts_.size(); }

 private:
  struct Part {
    std::string spelling;
    bool is_folder;
  };
  void add_part(const std::string& name, bool is_folder, const std::string& file) {
    const auto [at, is_new] = parts_.emplace(boost::to_lower_copy(name, std::locale::classic()), Part{name, is_folder});
    const Part& known = at->second;
    if (!is_new && (known.spelling != name || !known.is_folder || !is_folder))
      throw refused(file, fmt::format("'{}' and '{}' exclude each other", known.spelling, name));
  }

  std::string last_;
  std::map<std::string, Part> parts_;
};

}  // namespace

std::string sha256_of(std::string_view bytes) {
  sha256_ctx context;
  sha256_init(&context);
  sha256_update(&context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest;
  sha256_digest(&context, digest.size(), digest.data());
  std::string out;
  for (const std::uint8_t byte : digest) out += fmt::format("{:02x}", byte);
  return out;
}

void check_archived_name(const std::string& name, const std::string& file) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._~-";
  const auto refuse = [&](const std::string& reason) {
    return refused(file, fmt::format("the name '{}' {}", name, reason));
  };
  if (name.size() > kLongestName) throw refuse(fmt::format("has more than {} bytes", kLongestName));
  if (std::count(name.begin(), name.end(), '/') >= kMostLevels) throw refuse("has too many levels");
  std::size_t begin = 0;
  while (begin <= name.size()) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view level = std::string_view(name).substr(begin, end - begin);
    if (level.empty() || level == "." || level == ".." || level.find_first_not_of(kPlain) != std::string_view::npos)
      throw refuse("has an empty or strange part");
    begin = end + 1;
  }
}

void write_archive(const fs::path& file, const std::string& folder, const ArchivedFiles& files) {
  KnownNames known;
  TemporaryFile temporary(file);
  GzipFile out(gzopen(temporary.path().c_str(), "wb9"));
  const auto write = [&](const std::string& bytes) {
    if (!out || gzfwrite(bytes.data(), 1, bytes.size(), out.get()) < bytes.size())
      throw Error(file.string(), "cannot be written", {}, Error::Kind::run);
  };
  for (const auto& [name, content] : files) {
    check_archived_name(name, file.string());
    known.add(name, file.string());
    write(header_of(fmt::format("{}/{}", folder, name), content.size(), file.string()));
    write(content);
    write(padding_of(content.size()));
  }
  write(std::string(2 * kBlock, '\0'));
  if (gzclose(out.release()) != Z_OK) throw Error(file.string(), "cannot be written", {}, Error::Kind::run);
  temporary.publish();
}

void read_archive(const fs::path& file, std::uintmax_t most_bytes,
                  const std::function<void(const std::string& name, const std::string& content)>& use) {
  const std::string place = file.string();
  GzipReader in(file);
  KnownNames known;
  std::optional<std::string> folder;
  std::uintmax_t bytes = 0;
  const std::size_t most_files = std::max<std::size_t>(1, most_bytes >> 30) * kMostFiles;
  for (std::size_t count = 1;; ++count) {
    const std::string header = in.read(kBlock);
    if (header == std::string(kBlock, '\0')) break;
    const std::string prefix = field_of(header, 345, kLongestPrefix);
    const std::string path = (prefix.empty() ? "" : prefix + "/") + field_of(header, 0, kShortName);
    const std::uintmax_t size = std::strtoull(field_of(header, 124, 12).c_str(), nullptr, 8);
    const std::size_t slash = path.find('/');
    if (slash == std::string::npos || header != header_of(path, size, place))
      throw refused(place, fmt::format("its entry {} is not a plain file as 'palpate bundle' writes it", count));
    const std::string name = path.substr(slash + 1);
    if (!folder) check_archived_name(folder.emplace(path.substr(0, slash)), place);
    if (path.compare(0, slash, *folder) != 0 || slash != folder->size())
      throw refused(place, "has files outside of its folder " + *folder);
    check_archived_name(name, place);
    known.add(name, place);
    bytes += size;
    if (count > most_files || known.size() > (1 + kFoldersPerFile) * most_files)
      throw refused(place, fmt::format("has more than {} files, or too many folders", most_files),
                    "if you trust its author, allow more with --max-size");
    if (size > most_bytes / kFilesPerLimit)
      throw refused(place, fmt::format("'{}' has more than {} bytes", name, most_bytes / kFilesPerLimit),
                    "if you trust its author, allow more with --max-size");
    if (bytes > most_bytes)
      throw refused(place, fmt::format("unpacks to more than {} bytes", most_bytes),
                    "if you trust its author, allow more with --max-size");
    const std::string content = in.read(size);
    if (in.read(padding_of(size).size()) != padding_of(size)) throw refused(place, "has data between its files");
    use(name, content);
  }
  if (in.read(kBlock) != std::string(kBlock, '\0') || !in.read_some(1).empty())
    throw refused(place, "has data behind its last file");
}

}  // namespace palpate
