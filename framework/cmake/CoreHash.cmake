# SPDX-License-Identifier: MIT
# Writes a source file with kCoreHash to OUTPUT: a hash over the files of FILES (objects and archives, separated by ';')
# and over FLAGS, the compiler's and linker's flags.
set(all "${FLAGS}")
foreach(file ${FILES})
  file(SHA256 ${file} hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 hash "${all}")
# Writes only a changed file, so that programs are not linked again without need.
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "namespace palpate {
extern const char* const kCoreHash;
const char* const kCoreHash = \"${hash}\";
}  // namespace palpate
")
