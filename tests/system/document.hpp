// SPDX-License-Identifier: MIT
// A page of the documents: its commands, and what it says that they print and draw.
//
//   ```sh                              commands, one per line; tests run them in the top folder of palpate
//   ```sh long                         commands that take many minutes: only PALPATE_LONG=1 runs them
//   <!-- printed -->                   before a block or a table: the last command prints these lines, in this order;
//                                      it may print others between them
//   <!-- printed, within 5 % -->       numbers may differ by that share, and by one in their last digit
//   <!-- printed, not ns, seconds -->  of a table: the columns whose names begin so are not compared: a clock makes
//   them
//   <!-- printed: 1.4 +- 0.5 mm -->    a text of the prose: the last command prints it, and the page has it
//   <!-- drawn FILE, seal HEX -->      before a picture: it is a copy of the FILE that the last command left. The seal
//   is
//                                      a hash of the picture and of the last lines above that are compared: neither
//                                      changes without the other.
//
// Words and numbers are compared letter by letter, blanks and ** apart; a time of day is like any other.
// With PALPATE_KEEP=1 the page gets the numbers, pictures and seals that come out now.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// What a line or a table is compared with, and how strictly.
struct Tolerance {
  double share = 0.0;                 ///< by which numbers may differ, of the larger one
  std::vector<std::string> measured;  ///< beginnings of the names of columns that are not compared
};

class Document {
 public:
  struct Part {
    enum class Kind { command, printed, said, drawn };
    Kind kind = Kind::command;
    std::size_t line = 0;   ///< in the page, from 0: of the command, of the marker
    std::size_t begin = 0;  ///< of `printed`: the lines that are compared
    std::size_t end = 0;
    std::string text;      ///< the command, what is said, the file that is drawn
    bool is_long = false;  ///< of a command: it takes many minutes
    std::string seal;      ///< of `drawn`
    Tolerance tolerance;
  };

  /// Reads a page. Throws std::runtime_error, with the line, for a marker that nothing follows or nobody understands.
  explicit Document(const std::filesystem::path& file);

  const std::vector<Part>& parts() const { return parts_; }

  /// Returns what of `part`, which is no command, is not so: "" if all is. `printed`: the stdout of the last command;
  /// `folder`: where it ran. With `keep` the page is changed in memory as far as that mends it.
  std::string difference(std::size_t part, const std::string& printed, const std::filesystem::path& folder,
                         bool keep = false);

  /// Writes the page where it was read.
  void write() const;

 private:
  void mark(std::size_t line, const std::string& marker);
  std::string text_differs(const Part& part, const std::string& printed) const;
  std::string lines_differ(const Part& part, const std::string& printed, bool keep);
  std::string picture_differs(std::size_t part, const std::filesystem::path& folder, bool keep);
  /// The page without its markers.
  std::string prose() const;

  std::filesystem::path file_;
  std::vector<std::string> lines_;
  std::vector<Part> parts_;
};

/// Whether a line of a page is what a command printed: words and blanks apart, numbers within `share`.
bool same_line(const std::string& shown, const std::string& printed, double share);

}  // namespace palpate::test
