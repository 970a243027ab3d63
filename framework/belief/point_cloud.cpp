// SPDX-License-Identifier: MIT
#include "belief/point_cloud.hpp"

#include "reading/ply.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <sstream>
#include <string_view>
#include <vector>

namespace palpate {
namespace {

enum class Format { ascii, little, big };

/// Description of the vertices in the header. plain_ply() has removed all other elements.
struct PlyHeader {
  Format format = Format::ascii;
  long points = -1;
  std::vector<const BinaryNumberType*> properties;  ///< types of a vertex's properties
  std::array<int, 3> axes{-1, -1, -1};              ///< indices of x, y and z among the properties
  std::size_t length = 0;                           ///< bytes of the header, its last line end included
};

class PointCloudReader {
 public:
  PointCloudReader(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  PointCloud read() {
    const PlyHeader header = read_header();
    const std::string_view body = std::string_view(bytes_).substr(header.length);
    return header.format == Format::ascii ? read_ascii(header, body) : read_binary(header, body);
  }

 private:
  [[noreturn]] void reject(const std::string& reason) const { throw Error(file_, reason, "export it again as PLY"); }

  PlyHeader read_header() {
    PlyHeader out;
    std::size_t at = 0;
    bool of_vertices = false;
    const auto next = [&] {
      const std::size_t end = bytes_.find('\n', at);
      if (end == std::string::npos) reject("is not a PLY file or is cut short: the line 'end_header' is missing");
      std::string line = bytes_.substr(at, end - at);
      at = end + 1;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      return line;
    };
    if (next() != "ply") reject("is not a PLY file: it does not begin with the line 'ply'");
    for (std::string line = next(); line != "end_header"; line = next()) {
      std::istringstream words(line);
      std::string word, one, two;
      words >> word >> one >> two;
      if (word == "format") {
        out.format = parse_format(one);
      } else if (word == "element") {
        if (one != "vertex" && out.points < 0) reject("does not begin with its vertices");
        of_vertices = one == "vertex";
        if (of_vertices) out.points = parse_count(two);
      } else if (word == "property" && of_vertices) {
        add_property(out, one, two);
      }
    }
    out.length = at;
    if (out.points < 0) reject("has no vertices");
    for (const int axis : out.axes) {
      if (axis < 0) reject("has vertices without x, y and z");
    }
    return out;
  }

  Format parse_format(const std::string& name) const {
    if (name == "ascii") return Format::ascii;
    if (name == "binary_little_endian") return Format::little;
    if (name == "binary_big_endian") return Format::big;
    reject("has the format '" + name + "', which PLY does not define");
  }

  long parse_count(const std::string& word) const {
    long out = -1;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), out);
    if (read.ec != std::errc() || read.ptr != word.data() + word.size() || out < 0)
      reject("does not give its number of vertices");
    if (out > kMostPoints)
      throw Error(file_, fmt::format("has {} points, at most {} are read", out, kMostPoints),
                  "reduce the number of points");
    return out;
  }

  void add_property(PlyHeader& header, const std::string& type, const std::string& name) const {
    const BinaryNumberType* scalar = ply_scalar(type);
    if (scalar == nullptr) reject("has vertices with a property of type '" + type + "'");
    for (std::size_t k = 0; k < 3; ++k) {
      if (name == std::array{"x", "y", "z"}[k]) header.axes[k] = static_cast<int>(header.properties.size());
    }
    header.properties.push_back(scalar);
  }

  [[noreturn]] void reject_short(long points) const {
    reject(fmt::format("is cut short: its header announces {} vertices", points));
  }

  PointCloud read_ascii(const PlyHeader& header, std::string_view body) const {
    std::vector<double> numbers(header.properties.size());
    std::vector<Eigen::Vector3d> out;
    const char* at = body.data();
    const char* const end = at + body.size();
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    for (long i = 0; i < header.points; ++i) {
      for (double& number : numbers) {
        at = std::find_if_not(at, end, is_space);
        if (at == end) reject_short(header.points);
        const auto read = std::from_chars(at, end, number);
        if (read.ec == std::errc::invalid_argument || (read.ptr != end && !is_space(*read.ptr)))
          reject(fmt::format("has a value that is not a number in vertex {}", i + 1));
        if (read.ec == std::errc::result_out_of_range) number = std::numeric_limits<double>::infinity();
        at = read.ptr;
      }
      add(header, numbers, out);
    }
    return cloud_of(out);
  }

  PointCloud read_binary(const PlyHeader& header, std::string_view body) const {
    std::size_t row = 0;
    for (const BinaryNumberType* scalar : header.properties) row += scalar->size;
    if (body.size() / row < static_cast<std::size_t>(header.points)) reject_short(header.points);
    std::vector<double> numbers(header.properties.size());
    std::vector<Eigen::Vector3d> out;
    const char* at = body.data();
    for (long i = 0; i < header.points; ++i) {
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        const BinaryNumberType& scalar = *header.properties[k];
        std::array<char, 8> bytes{};
        std::copy_n(at, scalar.size, bytes.begin());
        if (header.format == Format::big) std::reverse(bytes.begin(), bytes.begin() + static_cast<long>(scalar.size));
        numbers[k] = scalar.read(bytes.data());
        at += scalar.size;
      }
      add(header, numbers, out);
    }
    return cloud_of(out);
  }

  static void add(const PlyHeader& header, const std::vector<double>& numbers, std::vector<Eigen::Vector3d>& out) {
    Eigen::Vector3d point;
    for (std::size_t k = 0; k < 3; ++k)
      point(static_cast<Eigen::Index>(k)) = numbers[static_cast<std::size_t>(header.axes[k])];
    if (point.allFinite()) out.push_back(point);
  }

  PointCloud cloud_of(const std::vector<Eigen::Vector3d>& points) const {
    if (points.empty()) reject("has no finite point");
    PointCloud out(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = points[i];
    return out;
  }

  const std::string& bytes_;
  const std::string& file_;
};

}  // namespace

PointCloud read_points(const std::string& bytes, const std::string& file) {
  return PointCloudReader(plain_ply(bytes, {"vertex"}), file).read();
}

}  // namespace palpate
