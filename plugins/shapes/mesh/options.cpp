// SPDX-License-Identifier: MIT
#include "options.hpp"

#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <filesystem>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::shapes {
namespace {

namespace fs = std::filesystem;

/// Returns 128 bits of XXH3 as 32 hex digits.
std::string checksum_of(const std::string& bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

/// Returns the path of a file. Shipped configs name meshes as configs/... . Without a checkout, these files are next to
/// the installed configs. The path is then relative to this library: <prefix>/lib/palpate/shape/mesh.so.
fs::path place_of(const std::string& file) {
  std::error_code none;
  Dl_info self{};
  if (file.rfind("configs/", 0) != 0 || fs::status(file, none).type() != fs::file_type::not_found) return file;
  if (::dladdr(reinterpret_cast<const void*>(&place_of), &self) == 0 || self.dli_fname == nullptr) return file;
  const fs::path prefix = fs::weakly_canonical(self.dli_fname, none) / ".." / ".." / ".." / "..";
  const fs::path installed = prefix.lexically_normal() / "share" / "palpate" / file;
  return fs::is_regular_file(installed, none) ? installed : fs::path(file);
}

/// Throws Error with the file as its place.
std::string bytes_of(const std::string& file) {
  FileReading reading = read_bounded(place_of(file), kMostMeshBytes, FileOrigin::user);
  if (reading.kind == FileReading::Kind::absent) {
    std::string hint;
    if (fs::path(file).is_relative())
      hint = "a relative path starts in the current folder, " + fs::current_path().string();
    throw Error(file, "no such file", hint);
  }
  if (reading.kind == FileReading::Kind::not_regular) throw Error(file, "not a regular file", "name a file");
  if (reading.kind == FileReading::Kind::too_large) throw Error(file, "is larger than 500 MB", "reduce its content");
  if (!reading) throw Error(file, words_of(reading, kMostMeshBytes).reason);
  if (reading.text.empty()) throw Error(file, "is empty", "export it again");
  return std::move(reading.text);
}

}  // namespace

std::string read_file(const std::string& file, const std::string& checksum) {
  std::string bytes;
  try {
    bytes = bytes_of(file);
  } catch (const Error& trouble) {  // The place of the error is the file, and the field is added here.
    throw Error("file", trouble.what(), {}, trouble.kind());
  }
  const std::string found = checksum_of(bytes);
  if (checksum.empty() || found == checksum) return bytes;
  throw Error("checksum", "does not match " + file + ", whose checksum is " + found);
}

void list_checksum(const std::string& file, std::string& checksum, Fields& fields) {
  // With the checksum, the id of a run depends on the content of the file, and a run cannot be resumed with another
  // file.
  std::string trouble;
  try {
    if (!file.empty()) checksum = checksum_of(bytes_of(file));
  } catch (const Error& error) {
    trouble = error.what();
  }
  fields.text(checksum, Field("checksum", "checksum of the file content; not given: computed from the file"));
  // A record has the checksum, so it is readable without the file.
  fields.require(trouble.empty() || !checksum.empty(), "file", trouble);
}

void MeshOptions::list(Fields& fields) {
  fields.text(
      file,
      Field("file", "STL, OBJ or PLY file. A relative path starts in the working folder or in the folder of the config")
          .needed()
          .names_file()
          .not_identifying());
  fields.real(unit,
              Field("unit", "length of one unit of the file, for example 1 mm").in(Unit::metre).above(0).needed());
  fields.choice(
      up, Field("up", "axis of the file that points upwards. The x axis of the file becomes the object's own x axis"),
      {{"z", "z axis, as in most STL files", {}}, {"y", "y axis, as in most OBJ files", {}}});
  fields.choice(holes,
                Field("holes", "treatment of holes in the surface. An edge of a hole belongs to one triangle only"),
                {{"refuse", "holes are an error. The message gives the number of such edges and the first edge", {}},
                 {"allow", "holes are accepted, and taps pass through the holes", {}}});
  list_checksum(file, checksum, fields);
}

}  // namespace palpate::shapes
