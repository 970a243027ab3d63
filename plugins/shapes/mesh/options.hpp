// SPDX-License-Identifier: MIT
// Options of shapes that are read from a file, and functions that read the file.
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

/// Lists the option `checksum` of the content of `file`. The id of a run therefore depends on this content. `file` must
/// be listed before. If the config has no checksum, the checksum is computed. An unreadable file then causes an error
/// at the field `file`. If the config has a checksum, the file is read only when the shape is created. Records are
/// therefore readable without the file.
void list_checksum(const std::string& file, std::string& checksum, Fields& fields);

/// Returns the content of the file. Throws Error with place "file" if the file is missing, unreadable, not regular,
/// empty, or larger than 500 MB. Throws Error with place "checksum" if the content has a different checksum.
std::string read_file(const std::string& file, const std::string& checksum);

}  // namespace palpate::shapes
