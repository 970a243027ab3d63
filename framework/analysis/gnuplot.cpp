// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"

#include "children/child_process.hpp"
#include "record/files.hpp"

#include <cerrno>
#include <cstring>
#include <memory>
#include <sstream>

extern "C" const char palpate_asset_figures[];

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kPointsPerInch = 72.0;
constexpr double kSvgDpi = 96.0;

/// Returns the first line with words. gnuplot's messages begin with lines that only mark a position in the script by a
/// caret.
std::string first_words(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line) && line.find_first_not_of(" \t^") == std::string::npos) {
  }
  return line;
}

}  // namespace

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "'";
}

std::string_view template_text(std::string_view name) {
  const std::string_view all = palpate_asset_figures;
  const std::string title = fmt::format("\n#: {}\n", name);
  const std::size_t begin = all.find(title) + title.size();
  return all.substr(begin, all.find("\n#: ", begin) + 1 - begin);
}

std::string picture_header(int width, int height, const fs::path& file, const std::string& output, PictureUnit unit) {
  const std::string extension = file.extension().string();
  const bool is_print = unit == PictureUnit::point;
  std::string terminal;
  double mark = 0.4;
  if (extension == ".pdf") {
    // A point of gnuplot's fonts is 4/3 points of a PDF; a line is half a point wide.
    terminal = fmt::format("pdfcairo noenhanced fontscale {} size {:.3f}in,{:.3f}in",
                           is_print ? "0.75 linewidth 2" : "0.8", width / kPointsPerInch, height / kPointsPerInch);
  } else {
    const bool is_svg = extension == ".svg";
    const double pixels = !is_print ? 1.0 : (is_svg ? kSvgDpi : kPrintDpi) / kPointsPerInch;
    terminal =
        fmt::format("{} noenhanced size {:.0f},{:.0f}", is_svg ? "svg" : "pngcairo", width * pixels, height * pixels);
    // A point of gnuplot's fonts is one pixel of an SVG and 4/3 pixels of a PNG; a line is one pixel wide.
    if (is_print)
      terminal += fmt::format(" fontscale {:.4g} linewidth {:.4g}", is_svg ? pixels : 0.75 * pixels, pixels);
    mark = is_svg ? 0.65 : 0.95;  // The marks are as large as in a PDF.
  }
  terminal += fmt::format(" font 'DejaVu Sans,{}'", is_print ? 8 : 12);
  if (extension == ".svg") terminal += " background rgb 'white'";
  return fmt::format("set terminal {}\nset output {}\n{}", terminal, gnuplot_text(output),
                     is_print ? fmt::format("mark_size = {}\n", mark) : "");
}

std::string draw_picture(const std::string& script, int width, int height, const fs::path& file, PictureUnit unit) {
  TemporaryFile picture(file);
  ProgramCall program{{"gnuplot", "--default-settings"}};  // gnuplot must ignore the settings of the user.
  program.own_group = false;                               // Ctrl-C must end gnuplot, too.
  const std::string output = fs::absolute(picture.path()).string();
  const std::unique_ptr<ChildProcess> gnuplot =
      ChildProcess::start(program, picture_header(width, height, file, output, unit) + script);
  if (!gnuplot && errno == ENOENT) return "gnuplot is not installed, install the package gnuplot-nox";
  if (!gnuplot) return fmt::format("gnuplot cannot be started: {}", std::strerror(errno));
  gnuplot->wait();
  const bool ended_well = gnuplot->status() == 0;
  if (!ended_well || fs::is_empty(picture.path()))
    return fmt::format("gnuplot {}: {}", ended_well ? "drew nothing" : "failed", first_words(gnuplot->said()));
  picture.publish();
  return {};
}

}  // namespace palpate
