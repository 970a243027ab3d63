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

  /// Reads the file, whose content the checksum stands for: throws what read_file() does.
  void list(Fields& fields) override;
};

/// Lists `checksum`, that of the content of `file`, which the field `file` named: so that the id of a run follows it. A
/// file that cannot be read, or is another than a record says, is refused at its field.
void list_checksum(const std::string& file, std::string& checksum, Fields& fields);

/// The whole file. Throws Error, its `where` the file: missing, not readable, no regular file, empty, or larger than
/// 500 MB.
std::string read_file(const std::string& file);

}  // namespace palpate::shapes
