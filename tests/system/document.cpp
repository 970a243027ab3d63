// SPDX-License-Identifier: MIT
#include "system/document.hpp"

#include "config/hash.hpp"
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include <glob.h>

namespace palpate::test {

namespace fs = std::filesystem;

namespace {

/// A line without marks of bold type, blanks folded into one, times of day alike, and each number replaced by '#'.
struct Split {
  std::string words;
  std::vector<std::string> numbers;
};

Split split(const std::string& line) {
  static const std::regex bold(R"(\*\*)");
  static const std::regex time(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)");
  static const std::regex dashes(R"(-{3,}:?)");
  static const std::regex number(R"(\b[0-9a-f]{12}\b|[-+]?\d+(\.\d+)?(e[-+]?\d+)?)");
  std::istringstream blanks(
      std::regex_replace(std::regex_replace(std::regex_replace(line, bold, ""), time, "TIME"), dashes, "---"));
  std::string folded;
  for (std::string word; blanks >> word;) folded += (folded.empty() ? "" : " ") + word;
  Split out;
  auto from = folded.cbegin();
  for (std::sregex_iterator at(folded.begin(), folded.end(), number), end; at != end; ++at) {
    out.words.append(from, (*at)[0].first);
    const bool is_id = at->length() == 12 && at->str().find_first_of(".+-") == std::string::npos;
    if (is_id) out.words += at->str();
    if (!is_id) {
      out.words += '#';
      out.numbers.push_back(at->str());
    }
    from = (*at)[0].second;
  }
  out.words.append(from, folded.cend());
  return out;
}

std::string without_ids(const std::string& words) {
  static const std::regex id(R"(\b[0-9a-f]{12}\b)");
  return std::regex_replace(words, id, "ID");
}

/// One in the last digit of a number as it is written.
double last_digit(const std::string& number) {
  const auto exponent = number.find('e');
  const auto point = number.find('.');
  const std::string mantissa = number.substr(0, exponent);
  const auto digits = point == std::string::npos ? 0 : static_cast<int>(mantissa.size() - point - 1);
  const int power = exponent == std::string::npos ? 0 : std::stoi(number.substr(exponent + 1));
  return std::pow(10.0, power - digits);
}

bool same_number(const std::string& shown, const std::string& printed, double share) {
  if (shown == printed || share == 0.0) return shown == printed;
  const double a = std::stod(shown);
  const double b = std::stod(printed);
  const double room = share * std::max(std::abs(a), std::abs(b)) + std::max(last_digit(shown), last_digit(printed));
  return std::abs(a - b) <= room * (1.0 + 1e-9);
}

bool same(const Split& shown, const Split& printed, double share) {
  if (shown.words != printed.words) return false;
  for (std::size_t i = 0; i < shown.numbers.size(); ++i)
    if (!same_number(shown.numbers[i], printed.numbers[i], share)) return false;
  return true;
}

/// So many words of a text from the first-th on, with single blanks.
std::string words_of(const std::string& text, std::size_t first, std::size_t count = std::string::npos) {
  std::istringstream words(text);
  std::string out;
  std::size_t at = 0;
  for (std::string word; words >> word; ++at)
    if (at >= first && at - first < count) out += (out.empty() ? "" : " ") + word;
  return out;
}

/// The first file of such a name, which may have * in it; "" if there is none.
fs::path found(const fs::path& pattern) {
  glob_t files{};
  const bool any = ::glob(pattern.c_str(), 0, nullptr, &files) == 0;
  fs::path out = any ? files.gl_pathv[0] : "";
  ::globfree(&files);
  return out;
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> out;
  std::istringstream cells(row);
  for (std::string cell; std::getline(cells, cell, '|');) out.push_back(cell);
  return out;
}

/// A row of a Markdown table with `blank` in the place of these cells.
std::string without(const std::string& row, const std::vector<std::size_t>& columns) {
  if (columns.empty() || row.rfind('|', 0) != 0) return row;
  std::vector<std::string> cells = cells_of(row);
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool left_out = std::find(columns.begin(), columns.end(), i) != columns.end();
    out += (i > 0 ? "|" : "") + (left_out ? " " : cells[i]);
  }
  return out + "|";
}

std::vector<std::size_t> columns_named(const std::string& head, const std::vector<std::string>& beginnings) {
  std::vector<std::size_t> out;
  const std::vector<std::string> cells = cells_of(head);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    for (const std::string& beginning : beginnings)
      if (cells[i].rfind(" " + beginning, 0) == 0) out.push_back(i);
  }
  return out;
}

}  // namespace

bool same_line(const std::string& shown, const std::string& printed, double share) {
  return same(split(shown), split(printed), share);
}

Document::Document(const fs::path& file) : file_(file), lines_(lines_of(text_of(file))) {
  bool commands = false;
  bool fenced = false;
  bool is_long = false;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::string line = lines_[i].substr(std::min(lines_[i].find_first_not_of(' '), lines_[i].size()));
    if (line.rfind("```", 0) == 0) {
      fenced = !fenced;
      is_long = line == "```sh long";
      commands = fenced && (line == "```sh" || is_long);
    } else if (commands && !line.empty()) {
      Part command;
      command.line = i;
      command.text = line;
      command.is_long = is_long;
      parts_.push_back(command);
    } else if (!fenced && (line.rfind("<!-- printed", 0) == 0 || line.rfind("<!-- drawn", 0) == 0)) {
      mark(i, line);
    }
  }
}

void Document::mark(std::size_t line, const std::string& marker) {
  static const std::regex said(R"(<!-- printed(?:, within ([\d.]+) %)?: (.+) -->)");
  static const std::regex printed(R"(<!-- printed(?:, within ([\d.]+) %)?(?:, not (.+))? -->)");
  static const std::regex drawn(R"(<!-- drawn ([^ ,]+), seal ([0-9a-f]*) -->)");
  const auto wrong = [&](const char* what) {
    return std::runtime_error(fmt::format("{}:{}: {}: {}", file_.string(), line + 1, what, marker));
  };
  std::smatch found;
  Part part;
  part.line = line;
  if (std::regex_match(marker, found, said)) {
    part.kind = Part::Kind::said;
    part.text = found[2];
  } else if (std::regex_match(marker, found, printed)) {
    part.kind = Part::Kind::printed;
    std::istringstream names(found[2]);
    for (std::string name; std::getline(names >> std::ws, name, ',');) part.tolerance.measured.push_back(name);
    std::size_t begin = line + 1;
    while (begin < lines_.size() && lines_[begin].empty()) ++begin;
    if (begin == lines_.size()) throw wrong("nothing follows");
    const auto first = lines_[begin].find_first_not_of(' ');
    if (lines_[begin].compare(first, 3, "```") == 0) {
      part.begin = begin + 1;
      part.end = part.begin;
      while (part.end < lines_.size() && lines_[part.end].find("```") == std::string::npos) ++part.end;
    } else if (lines_[begin][first] == '|') {
      part.begin = begin;
      part.end = begin;
      while (part.end < lines_.size() && lines_[part.end].rfind('|', 0) == 0) ++part.end;
    } else {
      throw wrong("no block and no table follows");
    }
  } else if (std::regex_match(marker, found, drawn)) {
    part.kind = Part::Kind::drawn;
    part.text = found[1];
    part.seal = found[2];
  } else {
    throw wrong("is no marker that anybody understands");
  }
  if (part.kind != Part::Kind::drawn && found[1].matched) part.tolerance.share = std::stod(found[1]) / 100.0;
  if (parts_.empty()) throw wrong("no command stands above it");
  parts_.push_back(part);
}

std::string Document::difference(std::size_t part, const std::string& printed, const fs::path& folder, bool keep) {
  const Part& one = parts_[part];
  switch (one.kind) {
    case Part::Kind::printed:
      return lines_differ(one, printed, keep);
    case Part::Kind::said:
      return text_differs(one, printed);
    case Part::Kind::drawn:
      return picture_differs(part, folder, keep);
    case Part::Kind::command:
      break;
  }
  throw std::logic_error("a command is not compared");
}

std::string Document::text_differs(const Part& part, const std::string& printed) const {
  std::string out;
  if (words_of(prose(), 0).find(words_of(part.text, 0)) == std::string::npos)
    out = fmt::format("{}:{}: the page does not say: {}\n", file_.string(), part.line + 1, part.text);
  const auto count = static_cast<std::size_t>(std::count(part.text.begin(), part.text.end(), ' ') + 1);
  for (const std::string& line : lines_of(printed)) {
    for (std::size_t first = 0; !words_of(line, first).empty(); ++first)
      if (same_line(part.text, words_of(line, first, count), part.tolerance.share)) return out;
  }
  return out +
         fmt::format("{}:{}: shows    {}\n  but is printed: {}\n", file_.string(), part.line + 1, part.text, printed);
}

std::string Document::lines_differ(const Part& part, const std::string& printed, bool keep) {
  const std::vector<std::string> all = lines_of(printed);
  std::vector<std::size_t> columns;
  if (!part.tolerance.measured.empty()) columns = columns_named(lines_[part.begin], part.tolerance.measured);
  std::string out;
  std::size_t next = 0;
  for (std::size_t i = part.begin; i < part.end; ++i) {
    const Split shown = split(without(lines_[i], columns));
    if (shown.words.empty()) continue;
    const auto find = [&](auto fits) {
      std::size_t at = next;
      while (at < all.size() && !fits(split(without(all[at], columns)))) ++at;
      return at;
    };
    std::size_t at = find([&](const Split& line) { return same(shown, line, part.tolerance.share); });
    if (at == all.size()) {
      at = find([&](const Split& line) { return without_ids(line.words) == without_ids(shown.words); });
      const bool is_like = at < all.size();
      if (is_like && keep) {
        lines_[i] =
            lines_[i].substr(0, lines_[i].find_first_not_of(' ')) + all[at].substr(all[at].find_first_not_of(' '));
      } else {
        out += fmt::format("{}:{}: shows    {}\n  but is printed: {}\n", file_.string(), i + 1, lines_[i],
                           is_like ? all[at] : "nothing like it");
      }
    }
    if (at < all.size()) next = at + 1;
  }
  return out.empty() ? out : out + "printed:\n" + printed;
}

std::string Document::picture_differs(std::size_t part, const fs::path& folder, bool keep) {
  const Part& one = parts_[part];
  const std::string& line = lines_[one.line + 1];
  const auto begin = line.find("](");
  if (line.rfind("![", 0) != 0 || begin == std::string::npos)
    return fmt::format("{}:{}: no picture follows\n", file_.string(), one.line + 2);
  const fs::path picture = file_.parent_path() / line.substr(begin + 2, line.find(')', begin) - begin - 2);
  const fs::path made = found(folder / one.text);
  if (made.empty()) return fmt::format("{}:{}: {} was not drawn\n", file_.string(), one.line + 1, one.text);
  if (keep) fs::copy_file(made, picture, fs::copy_options::overwrite_existing);
  std::string sealed = text_of(picture);
  for (std::size_t i = part; i-- > 0;) {
    if (parts_[i].kind != Part::Kind::printed) continue;
    for (std::size_t at = parts_[i].begin; at < parts_[i].end; ++at) sealed += lines_[at] + "\n";
    break;
  }
  const std::string seal = hash_of(sealed);
  if (keep) lines_[one.line] = fmt::format("<!-- drawn {}, seal {} -->", one.text, seal);
  if (keep || seal == one.seal) return "";
  return fmt::format("{}:{}: {} and the lines above were not made together: PALPATE_KEEP=1 makes both\n",
                     file_.string(), one.line + 1, picture.string());
}

std::string Document::prose() const {
  std::string out;
  for (const std::string& line : lines_) {
    if (line.find("<!-- ") == std::string::npos) out += line + "\n";
  }
  return out;
}

void Document::write() const {
  std::string text;
  for (const std::string& line : lines_) text += line + "\n";
  std::ofstream(file_, std::ios::binary) << text;
}

}  // namespace palpate::test
