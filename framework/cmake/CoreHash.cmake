# SPDX-License-Identifier: MIT
# Writes the source of kCoreHash into OUTPUT: a hash over the files of FILES (';' between them), objects and archives, and
# over FLAGS, with which they were compiled and are linked.
set(all "${FLAGS}")
foreach(file ${FILES})
  file(SHA256 ${file} hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 hash "${all}")
# Only if it changed, so that programs are linked again only then.
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "namespace palpate {
extern const char* const kCoreHash;
const char* const kCoreHash = \"${hash}\";
}  // namespace palpate
")
