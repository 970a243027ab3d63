// SPDX-License-Identifier: MIT
#include "baxter/description.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace palpate::baxter {
namespace {

/// A tag of XML: <name a="b">, <name/>, </name>.
struct Tag {
  std::string name;  ///< with the slash of a closing one
  std::map<std::string, std::string> attributes;
  bool empty = false;  ///< closes itself
};

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// The tags of a text in their order, without comments, declarations and what stands between them: of a URDF that is
/// all. Flat, so that no text is too deep.
class Tags {
 public:
  explicit Tags(const std::string& text) : text_(text) {}

  std::optional<Tag> next() {
    while ((at_ = text_.find('<', at_)) != std::string::npos) {
      if (text_.compare(at_, 4, "<!--") == 0) {
        at_ = text_.find("-->", at_);
      } else if (text_.compare(at_, 2, "<?") == 0 || text_.compare(at_, 2, "<!") == 0) {
        at_ = text_.find('>', at_);
      } else {
        ++at_;
        const Tag out = tag();
        return at_ < text_.size() ? std::optional<Tag>(out) : std::nullopt;  // a text that ends in it has no such tag
      }
    }
    return {};
  }

 private:
  std::string word(const char* ends) {
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(ends, at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  Tag tag() {
    Tag out;
    if (at_ < text_.size() && text_[at_] == '/') {
      ++at_;
      out.name = "/";
    }
    out.name += word(" \t\r\n/>");
    while (at_ < text_.size() && text_[at_] != '>') {
      if (is_space(text_[at_]) || text_[at_] == '/') {
        out.empty = text_[at_++] == '/';
        continue;
      }
      out.empty = false;
      const std::string key = word("= \t\r\n>");
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      if (at_ >= text_.size() || text_[at_] != '=') continue;
      ++at_;
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) continue;
      const char quote[] = {text_[at_++], '\0'};
      out.attributes[key] = word(quote);
      if (at_ < text_.size()) ++at_;
    }
    return out;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

/// NaN where it is no number from 0 on.
double mass_of(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const bool number = error == std::errc() && rest == end && std::isfinite(value) && value >= 0.0;
  return number ? value : std::numeric_limits<double>::quiet_NaN();
}

struct Tree {
  std::map<std::string, double> masses;                        ///< of each link
  std::map<std::string, std::vector<std::string>> hanging_on;  ///< each link's children
};

Tree tree_of(const std::string& urdf) {
  Tree out;
  std::string link, parent, child;
  Tags tags(urdf);
  for (std::optional<Tag> tag = tags.next(); tag; tag = tags.next()) {
    if (tag->name == "link") {
      link = tag->attributes["name"];
      out.masses.emplace(link, 0.0);
      if (tag->empty) link.clear();
    } else if (tag->name == "/link") {
      link.clear();
    } else if (tag->name == "mass" && !link.empty()) {
      out.masses[link] = mass_of(tag->attributes["value"]);
    } else if (tag->name == "joint") {
      parent.clear();
      child.clear();
    } else if (tag->name == "parent") {
      parent = tag->attributes["link"];
    } else if (tag->name == "child") {
      child = tag->attributes["link"];
    } else if (tag->name == "/joint" && !parent.empty() && !child.empty()) {
      out.hanging_on[parent].push_back(child);
    }
  }
  return out;
}

}  // namespace

std::optional<double> mass_beyond(const std::string& urdf, const std::string& link) {
  Tree tree = tree_of(urdf);
  if (tree.masses.count(link) == 0) return {};
  double sum = 0.0;
  std::set<std::string> seen{link};
  std::vector<std::string> open{link};
  while (!open.empty()) {
    const std::string here = open.back();
    open.pop_back();
    for (const std::string& child : tree.hanging_on[here]) {
      if (!seen.insert(child).second) continue;
      sum += tree.masses[child];
      open.push_back(child);
    }
  }
  return std::isfinite(sum) ? std::optional<double>(sum) : std::nullopt;
}

}  // namespace palpate::baxter
