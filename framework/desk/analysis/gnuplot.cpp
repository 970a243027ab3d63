// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"

#include "children/child_process.hpp"
#include "record/files.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <sstream>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// gnuplot points at the place with lines of blanks and a caret; its words come behind them.
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

std::string picture_header(int width, int height, const fs::path& file, const std::string& output) {
  constexpr double kPointsPerInch = 72.0;
  const std::string extension = file.extension().string();
  const std::string terminal =
      extension == ".pdf"
          ? fmt::format("pdfcairo noenhanced fontscale 0.8 size {:.3f}in,{:.3f}in font 'DejaVu Sans,12'",
                        width / kPointsPerInch, height / kPointsPerInch)
      : extension == ".svg"
          ? fmt::format("svg noenhanced size {},{} font 'DejaVu Sans,12' background rgb 'white'", width, height)
          : fmt::format("pngcairo noenhanced size {},{} font 'DejaVu Sans,12'", width, height);
  return fmt::format("set terminal {}\nset output {}\n", terminal, gnuplot_text(output));
}

std::string draw_picture(const std::string& script, int width, int height, const fs::path& file) {
  TemporaryFile picture(file);
  Program program{{"gnuplot", "--default-settings"}};  // a user's own settings would give another picture
  program.own_group = false;                           // whoever presses Ctrl-C wants no picture either
  const std::string output = fs::absolute(picture.path()).string();
  const std::unique_ptr<ChildProcess> gnuplot =
      ChildProcess::start(program, picture_header(width, height, file, output) + script);
  if (!gnuplot && errno == ENOENT) return "gnuplot is not installed, the package gnuplot-nox has it";
  if (!gnuplot) return fmt::format("gnuplot cannot be started: {}", std::strerror(errno));
  gnuplot->wait();
  const bool ended_well = gnuplot->status() == 0;
  if (!ended_well || fs::is_empty(picture.path()))
    return fmt::format("gnuplot {}: {}", ended_well ? "drew nothing" : "failed", first_words(gnuplot->said()));
  picture.publish();
  return {};
}

}  // namespace palpate
