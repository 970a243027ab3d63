// SPDX-License-Identifier: MIT
#include "analysis/gnuplot.hpp"

#include "record/files.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string first_line(std::FILE* file) {
  std::rewind(file);
  std::string line;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    // gnuplot points at the place with lines of blanks and a caret; its words come behind them.
    if (c != '\n') {
      line += static_cast<char>(c);
    } else if (line.find_first_not_of(" \t^") != std::string::npos) {
      break;
    } else {
      line.clear();
    }
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

std::string png_header(int width, int height, const std::string& output) {
  return fmt::format("set terminal pngcairo noenhanced size {},{} font 'DejaVu Sans,12'\nset output {}\n", width,
                     height, gnuplot_text(output));
}

std::string draw_png(const std::string& script, int width, int height, const fs::path& file) {
  const File input(std::tmpfile());
  const File trouble(std::tmpfile());
  if (!input || !trouble) return fmt::format("no temporary file could be made: {}", std::strerror(errno));
  Neighbour picture(file);
  const std::string all = png_header(width, height, fs::absolute(picture.path()).string()) + script;
  if (std::fwrite(all.data(), 1, all.size(), input.get()) != all.size() || std::fflush(input.get()) != 0)
    return fmt::format("its script could not be written: {}", std::strerror(errno));
  ::lseek(::fileno(input.get()), 0, SEEK_SET);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(input.get()), STDIN_FILENO);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(trouble.get()), STDERR_FILENO);
  std::string program = "gnuplot";
  std::string defaults = "--default-settings";  // a user's own settings would give another picture
  char* const words[] = {program.data(), defaults.data(), nullptr};
  pid_t child = -1;
  const int refused = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, words, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (refused == ENOENT) return "gnuplot is not installed, the package gnuplot-nox has it";
  if (refused != 0) return fmt::format("gnuplot cannot be started: {}", std::strerror(refused));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool ended_well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (!ended_well || fs::is_empty(picture.path()))
    return fmt::format("gnuplot {}: {}", ended_well ? "drew nothing" : "failed", first_line(trouble.get()));
  picture.rename();
  return {};
}

}  // namespace palpate
