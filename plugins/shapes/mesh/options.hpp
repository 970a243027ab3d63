// SPDX-License-Identifier: MIT
// What a config says of an object that comes from a file, and the bytes of that.
#pragma once

#include <palpate/options.hpp>

#include <string>

namespace palpate::shapes {

struct MeshOptions : Options {
  enum class Up { z, y };
  enum class Holes { refuse, allow };
  std::string file;
  double unit = 0.001;
  Up up = Up::z;
  Holes holes = Holes::refuse;
  std::string checksum;

  void list(Fields& fields) override;
};

/// Lists `checksum`, that of the content of `file`, which the field `file` named: so that the id of a run follows it.
/// Where a config has none, that of the file as it is; a file that cannot be read is then refused at the field `file`.
/// Where it has one, the file is needed only when the shape is built: records are read without it.
void list_checksum(const std::string& file, std::string& checksum, Fields& fields);

/// Returns the whole file. Throws Error, its `where` "file": missing, not readable, no regular file, empty, or larger
/// than 500 MB; or "checksum": the content has another than `checksum`.
std::string read_file(const std::string& file, const std::string& checksum);

}  // namespace palpate::shapes
