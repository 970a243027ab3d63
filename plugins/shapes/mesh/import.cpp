// SPDX-License-Identifier: MIT
#include "triangles.hpp"

#include "children/child_process.hpp"
#include "reading/ply.hpp"
#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::shapes {
namespace {

constexpr const char* kExportAgain = "export it again";

[[noreturn]] void refuse_number(const std::string& file, std::size_t triangles) {
  throw Error(
      file, "has " + std::to_string(triangles) + " triangles, at most " + std::to_string(kMostTriangles) + " are read",
      "reduce their number");
}

/// File system for assimp that contains no other files. Materials of an OBJ, for example, are not found.
class NoOtherFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

/// Returns "stl", "obj" or "ply", depending on the extension.
std::string format_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* known : {"stl", "obj", "ply"}) {
    if (ending == std::string(".") + known) return known;
  }
  throw Error(file, ending.empty() ? "has no file extension" : "the format '" + ending + "' is not supported",
              "export it as .stl, .obj or .ply");
}

/// Checks that an STL is complete, by the length of a binary file or the last word of a text file. assimp reads
/// incomplete files without an error. Removes bytes after the end of a binary STL. Converts an STL in text form to
/// lower case, as assimp expects it.
void make_stl_plain(std::string& bytes, const std::string& file) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  if (bytes.size() >= kHeader && bytes.size() >= kHeader + kTriangle * count) {
    if (count > kMostTriangles) refuse_number(file, count);
    return bytes.resize(kHeader + kTriangle * count);
  }
  drop_byte_order_mark(bytes);
  std::transform(bytes.begin(), bytes.end(), bytes.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string_view text(bytes);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || text.substr(begin, 5) != "solid")
    throw Error(file, "is not an STL file, neither text nor binary, or is cut short", kExportAgain);
  if (text.rfind("endsolid") == std::string_view::npos)
    throw Error(file, "is cut short: the word 'endsolid' is missing", kExportAgain);
}

/// Returns the number of line ends in `text`. A line end is CR, LF or CRLF.
std::size_t line_ends(std::string_view text) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    out += text[i] == '\r' || (text[i] == '\n' && (i == 0 || text[i - 1] != '\r')) ? 1 : 0;
  return out;
}

/// Checks that a PLY has as many rows as its header states. For a wrong number, assimp repeats the last row or fails.
/// Like assimp, the function accepts CR, LF and CRLF as line ends.
void check_ply(const std::string& bytes, const std::string& file) {
  const std::string_view last = "end_header";
  std::size_t header = bytes.find(last, 1);
  while (header != std::string::npos && bytes[header - 1] != '\n' && bytes[header - 1] != '\r')
    header = bytes.find(last, header + 1);
  if (header == std::string::npos)
    throw Error(file, "is not a PLY file or is cut short: the line 'end_header' is missing", kExportAgain);
  std::string lines = bytes.substr(0, header);
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  std::istringstream in(lines);
  std::size_t rows = 0;
  bool text = false;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word, name, count;
    words >> word >> name >> count;
    if (word == "format") text = name == "ascii";
    if (word != "element") continue;
    // A valid count has at most nine digits, because the largest accepted file has fewer than 10^9 bytes.
    if (count.empty() || count.size() > 9 || count.find_first_not_of("0123456789") != std::string::npos)
      throw Error(file, "its header does not give the number of rows of '" + name + "'", kExportAgain);
    rows += std::stoul(count);
  }
  const std::string_view body = std::string_view(bytes).substr(header + last.size());
  // The last row may lack its line end, but the last line of the header has one. A binary row has at least one byte.
  const std::size_t there =
      text ? line_ends(body) - (body.empty() || (body.back() != '\n' && body.back() != '\r') ? 0 : 1) : body.size();
  if (there < rows) throw Error(file, "is cut short: its header announces more rows than there are", kExportAgain);
}

Soup triangles_by_assimp(const std::string& bytes, const std::string& file, const std::string& format) {
  Assimp::Importer importer;
  importer.SetIOHandler(new NoOtherFiles);  // The importer takes ownership of the object.
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, format.c_str());
  if (scene == nullptr) {
    std::string reason = importer.GetErrorString();
    reason.erase(reason.find_last_not_of(". \t\r\n") + 1);
    throw Error(file, "cannot be read as " + format + ": " + reason, kExportAgain);
  }
  Soup out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // Points and lines have no surface.
      if (out.size() == 3 * kMostTriangles) refuse_number(file, kMostTriangles + 1);
      for (unsigned i = 0; i < 3; ++i) {
        if (face.mIndices[i] >= mesh.mNumVertices)
          throw Error(file, "a triangle refers to a corner that does not exist", kExportAgain);
        const aiVector3D& corner = mesh.mVertices[face.mIndices[i]];
        out.push_back({corner.x, corner.y, corner.z});
      }
    }
  }
  if (out.empty()) throw Error(file, "has no triangles", "export it as a surface, not as points or lines");
  return out;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PALPATE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PALPATE_SANITIZED
#endif
#endif

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

/// Limits the memory of this process. The limit is much larger than the memory that assimp needs for any valid file of
/// `bytes` bytes. `out_of_memory` is called when the limit is reached.
void limit_memory([[maybe_unused]] std::size_t bytes, [[maybe_unused]] void (*out_of_memory)()) {
#ifndef PALPATE_SANITIZED  // A sanitizer reserves terabytes of addresses for its own memory.
  std::size_t pages = 0;
  std::istringstream(read_bounded("/proc/self/statm", kMostSystemBytes, FileOrigin::user).text) >> pages;
  limit(RLIMIT_AS, pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + 512'000'000 + 64 * bytes);
  std::set_new_handler(out_of_memory);
#endif
}

const ChildProcess::Say* say_in_child = nullptr;

/// Reads the mesh in the child process. Writes 'T' and the triangles after success, else 'E', the reason and a hint.
/// Returns the exit status.
int answer(const ChildProcess::Say& say, const std::string& bytes, const std::string& file, const std::string& format) {
  limit(RLIMIT_CORE, 0);
  // Valid meshes of 13 and 55 MB take 0.3 and 0.5 s. A broken file of only 102 bytes made assimp run endlessly.
  const rlim_t seconds = 1 + bytes.size() / 250'000;
  limit(RLIMIT_CPU, seconds);
  alarm(static_cast<unsigned>(12 * seconds));  // limit of the real time, for waits that use no CPU time
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);  // failed assertions of assimp would print a second line
  say_in_child = &say;
  limit_memory(bytes.size(), [] {
    (*say_in_child)("Eneeds more memory than any valid file of its size\nexport it again");
    _exit(0);
  });
  try {
    const Soup soup = triangles_by_assimp(bytes, file, format);
    say("T");
    say({reinterpret_cast<const char*>(soup.data()), soup.size() * sizeof soup.front()});
  } catch (const Error& error) {
    say("E" + error.reason() + '\n' + error.hint());
  }
  return 0;
}

}  // namespace

Soup import_triangles(std::string bytes, const std::string& file) {
  const std::string format = format_of(file);
  if (format == "stl") make_stl_plain(bytes, file);
  if (format == "ply") bytes = plain_ply(std::move(bytes), {"vertex", "face", "tristrips"});
  if (format == "ply") check_ply(bytes, file);
  if (format == "obj") drop_byte_order_mark(bytes);
  // On some broken files, assimp 5.2 crashes, aborts or runs endlessly. It therefore runs in a child process.
  const std::unique_ptr<ChildProcess> reader =
      ChildProcess::fork([&](const ChildProcess::Say& say) { return answer(say, bytes, file, format); });
  if (!reader)
    throw Error(file, std::string("cannot start a child process to read it: ") + std::strerror(errno), "",
                Error::Kind::run);
  reader->wait();  // the wait ends, because the child limits its own time
  const std::string& said = reader->said();
  const int status = reader->status();
  if (status != 0 || said.empty()) {
    const bool endless = WIFSIGNALED(status) &&
                         (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGKILL);
    throw Error(
        file,
        "cannot be read as " + format + ": assimp " + (endless ? "did not finish" : "crashed") + " while reading it",
        kExportAgain);
  }
  if (said[0] == 'E') {
    const std::size_t line = std::min(said.find('\n'), said.size() - 1);
    throw Error(file, said.substr(1, line - 1), said.substr(line + 1));
  }
  Soup out((said.size() - 1) / sizeof(Soup::value_type));
  std::memcpy(out.data(), said.data() + 1, out.size() * sizeof out.front());
  return out;
}

}  // namespace palpate::shapes
