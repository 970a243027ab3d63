// SPDX-License-Identifier: MIT
#include "options.hpp"

#include "file.hpp"

namespace palpate::shapes {

void MeshOptions::list(Fields& fields) {
  fields.text(file, Field("file", "STL, OBJ or PLY; a relative path starts in the current folder").needed());
  fields.real(unit,
              Field("unit", "length of one unit of the file, for example 1 mm").in(Unit::metre).above(0).needed());
  fields.choice(up, Field("up", "axis of the file that points up; the length lies along its x"),
                {{"z", "as in most STL files", {}}, {"y", "as in most OBJ files", {}}});
  fields.choice(holes, Field("holes", "in the surface, edges of one triangle only"),
                {{"refuse", "with their number and the first", {}}, {"allow", "lines pass through them", {}}});
  // So that the id of a run follows the content of the file, and a run is not carried on with another.
  const std::string found = file.empty() ? std::string() : checksum_of(read_file(file));
  checksum = found;
  fields.text(checksum, Field("checksum", "of the file's content; if absent, that of the file as it is"));
  fields.require(checksum == found, "checksum", "is not that of " + file + ", which has " + found);
}

}  // namespace palpate::shapes
