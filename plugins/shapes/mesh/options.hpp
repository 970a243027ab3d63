// SPDX-License-Identifier: MIT
// Options of shapes from a file, and reading of the file.
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

/// Lists `checksum` of the content of `file`, so that the id of a run depends on it. `file` must be listed before. If
/// the config has no checksum, it is computed; an unreadable file is then an error at the field `file`. If the config
/// has one, the file is needed only when the shape is created, so records are read without it.
void list_checksum(const std::string& file, std::string& checksum, Fields& fields);

/// Returns the content of the file. Throws Error with place "file" if it is missing, unreadable, not a regular file,
/// empty, or larger than 500 MB. Throws Error with place "checksum" if the content has another checksum.
std::string read_file(const std::string& file, const std::string& checksum);

}  // namespace palpate::shapes
