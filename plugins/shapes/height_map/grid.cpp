// SPDX-License-Identifier: MIT
#include "grid.hpp"

#include "reading/binary_number.hpp"
#include "reading/npy.hpp"
#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#ifdef PALPATE_PNG
#include <png.h>
#endif

namespace palpate::shapes {
namespace {

constexpr const char* kExportAgain = "write it again";

[[noreturn]] void refuse_size(const std::string& file, std::uint64_t rows, std::uint64_t columns) {
  throw Error(file,
              fmt::format("has {} x {} values, but must have between 2 x 2 and {} in all", rows, columns, kMostNodes));
}

void check_size(const std::string& file, std::uint64_t rows, std::uint64_t columns) {
  const auto most = static_cast<std::uint64_t>(kMostNodes);
  if (rows < 2 || columns < 2 || rows > most || columns > most / rows) refuse_size(file, rows, columns);
}

/// Returns `text` without blanks at its beginning and end.
std::string_view stripped(std::string_view text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

Grid from_csv(std::string bytes, const std::string& file) {
  drop_byte_order_mark(bytes);
  std::string_view rest = stripped(bytes);
  std::vector<double> values;
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    ++rows;
    std::uint64_t cells = 0;
    for (std::size_t begin = 0; begin <= line.size(); ++cells) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      const std::string_view cell = stripped(line.substr(begin, end - begin));
      double value = 0.0;
      const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (read.ec != std::errc() || read.ptr != cell.data() + cell.size() || cell.empty())
        throw Error(fmt::format("{}:{}", file, rows), fmt::format("'{}' is not a number", cell.substr(0, 40)),
                    "write one row of numbers per line, separated by commas, without a header");
      values.push_back(value);
      begin = end + 1;
    }
    if (rows == 1) columns = cells;
    if (cells != columns)
      throw Error(fmt::format("{}:{}", file, rows), fmt::format("has {} values, the first row has {}", cells, columns));
    if (values.size() > static_cast<std::size_t>(kMostNodes)) refuse_size(file, rows, columns);
  }
  check_size(file, rows, columns);
  return Eigen::Map<Grid>(values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

/// Number types of NPY, without their byte order.
constexpr std::array<std::pair<const char*, BinaryNumberType>, 10> kScalars{{{"f4", binary_number<float>()},
                                                                             {"f8", binary_number<double>()},
                                                                             {"i1", binary_number<std::int8_t>()},
                                                                             {"u1", binary_number<std::uint8_t>()},
                                                                             {"i2", binary_number<std::int16_t>()},
                                                                             {"u2", binary_number<std::uint16_t>()},
                                                                             {"i4", binary_number<std::int32_t>()},
                                                                             {"u4", binary_number<std::uint32_t>()},
                                                                             {"i8", binary_number<std::int64_t>()},
                                                                             {"u8", binary_number<std::uint64_t>()}}};

/// Returns the number type with this name. Returns null if it is not supported.
const BinaryNumberType* scalar_named(const std::string& type) {
  if (type.empty() || std::string_view("<>|=").find(type.front()) == std::string_view::npos) return nullptr;
  const auto* const found = std::find_if(kScalars.begin(), kScalars.end(),
                                         [&](const auto& one) { return type.compare(1, type.npos, one.first) == 0; });
  if (found == kScalars.end() || (found->second.size > 1 && type.front() == '>')) return nullptr;
  return &found->second;
}

Grid from_npy(const std::string& bytes, const std::string& file) {
  const std::optional<NpyHeaderSpan> place = npy_header_place(bytes);
  if (!place || place->length > bytes.size() - place->begin)
    throw Error(file, "is not a NumPy array, or is cut short", kExportAgain);
  const std::size_t begin = place->begin + place->length;
  const NpyHeader header = read_npy_header(std::string_view(bytes).substr(place->begin, place->length));
  if (header.sizes.size() != 2) throw Error(file, "does not have two dimensions", "save an array of rows and columns");
  const bool by_columns = header.order == "True";
  const BinaryNumberType* const scalar = by_columns || header.order == "False" ? scalar_named(header.type) : nullptr;
  if (scalar == nullptr)
    throw Error(file, "has values of an unsupported type", "save it as float64: array.astype(float)");
  const std::uint64_t rows = header.sizes[0];
  const std::uint64_t columns = header.sizes[1];
  check_size(file, rows, columns);
  if ((bytes.size() - begin) / scalar->size < rows * columns) throw Error(file, "is cut short", kExportAgain);
  Grid out(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  const char* at = bytes.data() + begin;
  for (Eigen::Index i = 0; i < out.size(); ++i, at += scalar->size) {
    const Eigen::Index row = by_columns ? i % out.rows() : i / out.cols();
    out(row, by_columns ? i / out.rows() : i % out.cols()) = scalar->read(at);
  }
  return out;
}

#ifdef PALPATE_PNG

/// The bytes that libpng reads, and its error message.
struct PngInput {
  std::string_view rest;
  std::string reason;
};

void hand_out(png_structp png, png_bytep to, std::size_t size) {
  PngInput& source = *static_cast<PngInput*>(png_get_io_ptr(png));
  if (source.rest.size() < size) png_error(png, "is cut short");
  std::memcpy(to, source.rest.data(), size);
  source.rest.remove_prefix(size);
}

void note(png_structp png, png_const_charp reason) {
  static_cast<PngInput*>(png_get_error_ptr(png))->reason = reason;
  png_longjmp(png, 1);
}

/// Decodes into `out`. After an error, libpng leaves the function by longjmp, and the function returns false. No local
/// variable may therefore need a destructor.
bool decode(png_structp png, png_infop info, PngInput& source, Grid& out, std::vector<png_byte>& row, bool& is_grey,
            const std::string& file) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &source, hand_out);
  png_read_info(png, info);
  const int depth = png_get_bit_depth(png, info);
  is_grey = png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY && (depth == 8 || depth == 16) &&
            png_get_interlace_type(png, info) == PNG_INTERLACE_NONE;
  if (!is_grey) return false;
  check_size(file, png_get_image_height(png, info), png_get_image_width(png, info));
  out.resize(static_cast<Eigen::Index>(png_get_image_height(png, info)),
             static_cast<Eigen::Index>(png_get_image_width(png, info)));
  row.resize(png_get_rowbytes(png, info));
  for (Eigen::Index y = 0; y < out.rows(); ++y) {
    png_read_row(png, row.data(), nullptr);
    for (Eigen::Index x = 0; x < out.cols(); ++x) {
      const auto at = static_cast<std::size_t>(x);
      out(y, x) = depth == 8 ? row[at] : 256 * row[2 * at] + row[2 * at + 1];
    }
  }
  png_read_end(png, nullptr);
  return true;
}

Grid from_png(const std::string& bytes, const std::string& file) {
  PngInput source{bytes, "is not a PNG"};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, note, [](png_structp, png_const_charp) {});
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const struct Guard {
    png_structp* png;
    png_infop* info;
    ~Guard() { png_destroy_read_struct(png, info, nullptr); }
  } guard{&png, &info};
  if (info == nullptr) throw Error(file, "cannot be read: no memory for it", {}, Error::Kind::run);
  Grid out;
  std::vector<png_byte> row;
  bool is_grey = true;
  if (decode(png, info, source, out, row, is_grey, file)) return out;
  if (!is_grey)
    throw Error(file, "is not a grey image of 8 or 16 bits", "export it as a grey image of 16 bits, not interlaced");
  throw Error(file, "cannot be read as PNG: " + source.reason, kExportAgain);
}

#else

Grid from_png(const std::string&, const std::string& file) {
  throw Error(file, "is a PNG, which this build cannot read", "install libpng-dev and build again, or save it as .npy");
}

#endif

void check_values(const Grid& values, const std::string& file) {
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index column = 0; column < values.cols(); ++column) {
      const double value = values(row, column);
      if (value >= 0.0 && std::isfinite(value)) continue;
      throw Error(file, fmt::format("row {}, column {} is {}, but a height is at least 0", row + 1, column + 1, value),
                  "write 0 where the desk is");
    }
  }
  if (values.maxCoeff() <= 0.0) throw Error(file, "is 0 everywhere: there is no object");
}

}  // namespace

Grid read_grid(const std::string& bytes, const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".csv" && ending != ".npy" && ending != ".png")
    throw Error(file, "has no supported file extension", "save it as .csv, .npy or .png");
  Grid out = ending == ".csv"   ? from_csv(bytes, file)
             : ending == ".npy" ? from_npy(bytes, file)
                                : from_png(bytes, file);
  check_values(out, file);
  return out;
}

}  // namespace palpate::shapes
