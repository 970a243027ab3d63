// SPDX-License-Identifier: MIT
#include "import.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace palpate::shapes {
namespace {

constexpr const char* kExportAgain = "export it again";

[[noreturn]] void refuse_number(const std::string& file, std::size_t triangles) {
  throw Error(
      file, "has " + std::to_string(triangles) + " triangles, at most " + std::to_string(kMostTriangles) + " are read",
      "reduce their number");
}

/// What a file names beside itself is not there.
class NoOtherFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

/// "stl", "obj" or "ply".
std::string format_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* known : {"stl", "obj", "ply"}) {
    if (ending == std::string(".") + known) return known;
  }
  throw Error(file, ending.empty() ? "has no ending that tells its format" : "the format '" + ending + "' is not read",
              "export it as .stl, .obj or .ply");
}

/// An STL tells by its length, or by its last word, whether it is complete; assimp reads what is there.
void check_stl(const std::string& bytes, const std::string& file) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  if (bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * count) {
    if (count > kMostTriangles) refuse_number(file, count);
    return;
  }
  const std::string_view text(bytes);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || text.substr(begin, 5) != "solid") {
    throw Error(file, "is no STL, neither text nor binary, or cut short", kExportAgain);
  }
  if (text.rfind("endsolid") == std::string_view::npos) {
    throw Error(file, "is cut short: the word 'endsolid' is missing", kExportAgain);
  }
}

}  // namespace

Soup import_triangles(const std::string& bytes, const std::string& file) {
  const std::string format = format_of(file);
  if (format == "stl") check_stl(bytes, file);
  Assimp::Importer importer;
  importer.SetIOHandler(new NoOtherFiles);  // which the importer deletes
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, format.c_str());
  if (scene == nullptr) {
    throw Error(file, "cannot be read as " + format + ": " + importer.GetErrorString(), kExportAgain);
  }
  Soup out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // a point or a line has no surface
      if (out.size() == 3 * kMostTriangles) refuse_number(file, kMostTriangles + 1);
      for (unsigned i = 0; i < 3; ++i) {
        if (face.mIndices[i] >= mesh.mNumVertices)
          throw Error(file, "a triangle has a corner that is not there", kExportAgain);
        const aiVector3D& corner = mesh.mVertices[face.mIndices[i]];
        out.push_back({corner.x, corner.y, corner.z});
      }
    }
  }
  if (out.empty()) throw Error(file, "has no triangles", "export it as a surface, not as points or lines");
  return out;
}

}  // namespace palpate::shapes
