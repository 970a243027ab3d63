// SPDX-License-Identifier: MIT
// The ids of shipped configs, and the text of which each is the hash, as tests/data/ids.txt has them. PALPATE_KEEP=1
// writes what comes out now: since 0.1.0 an id moves only where a default does.
#include "config/catch_error.hpp"
#include "config/describe.hpp"
#include "config/keys.hpp"
#include "reading/read_file.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

using Lines = std::vector<std::string>;

Lines lines_in(const std::string& text) {
  Lines out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// Lines of `now` that `before` lacks, marked with +, and of `before` that `now` lacks, with -. Both are sorted.
std::string difference(const Lines& before, const Lines& now) {
  std::string out;
  const auto add = [&](char sign, const Lines& of, const Lines& without) {
    for (const std::string& line : of) {
      if (!std::binary_search(without.begin(), without.end(), line)) out += sign + line + "\n";
    }
  };
  add('-', before, now);
  add('+', now, before);
  return out;
}

/// The text without its first line, sorted already.
Lines identity_of(const ResolvedConfig& config) {
  Lines lines = lines_in(identity_text(config.notes));
  EXPECT_EQ(lines.front(), "palpate-id 1");
  lines.erase(lines.begin());
  return lines;
}

std::optional<ResolvedConfig> resolved_config(const std::string& file, const std::vector<std::string>& overrides = {}) {
  std::optional<ResolvedConfig> out;
  catch_error([&] { out = shipped_config(file, overrides); });
  return out;
}

/// By what each is called: whole configs with their text, groups with how the text differs from that of their base.
std::map<std::string, std::string> all_ids() {
  const fs::path configs = source_folder() / "configs";
  std::map<std::string, std::string> out;
  const auto groups = config_keys().groups();
  for (const char* folder : {".", "paper", "benchmark", "ci"}) {
    for (const fs::path& file : list_folder(configs / folder)) {
      if (file.extension() != ".yaml") continue;
      const std::string name = file.lexically_relative(configs).lexically_normal().string();
      const auto config = resolved_config(name);
      std::string& text = out[name];
      text = config ? config->id + "\n" : "is no whole config\n";
      for (const std::string& line : config ? identity_of(*config) : Lines()) text += line + "\n";
    }
  }
  std::map<std::string, Lines> bases;
  for (const char* base : {"default.yaml", "any_side.yaml"}) bases[base] = identity_of(shipped_config(base));
  for (const std::string& group : groups) {
    for (const fs::path& file : list_folder(configs / last_key(group))) {
      if (file.extension() != ".yaml" || group == "expect") continue;
      const std::string choice = group + "=" + file.stem().string();
      std::string& text = out["with " + choice];
      for (const auto& [base, lines] : bases) {
        const auto config = resolved_config(base, {choice});
        text += base + " " + (config ? config->id + "\n" + difference(lines, identity_of(*config)) : "refuses it\n");
      }
    }
  }
  return out;
}

std::string text_of_ids(const std::map<std::string, std::string>& ids) {
  std::string out;
  for (const auto& [name, text] : ids) out += "== " + name + "\n" + text;
  return out;
}

std::map<std::string, std::string> recorded_ids(const std::string& text) {
  std::map<std::string, std::string> out;
  std::string* current = nullptr;
  for (const std::string& line : lines_in(text)) {
    if (line.rfind("== ", 0) == 0) {
      current = &out[line.substr(3)];
    } else if (current != nullptr) {
      *current += line + "\n";
    }
  }
  return out;
}

Lines sorted(Lines lines) {
  std::sort(lines.begin(), lines.end());
  return lines;
}

TEST(Ids, OfShippedConfigsAreThoseThatWereRecorded) {
  const fs::path before = fs::current_path();
  fs::current_path(source_folder());  // meshes and programs are named from here
  const std::map<std::string, std::string> now = all_ids();
  fs::current_path(before);
  const fs::path file = source_folder() / "tests" / "data" / "ids.txt";
  if (const char* keep = std::getenv("PALPATE_KEEP"); keep != nullptr && *keep != '\0') {
    std::ofstream(file) << text_of_ids(now);
  }
  const std::map<std::string, std::string> recorded = recorded_ids(text_of(file));
  for (const auto& [name, text] : now) {
    if (name == "with backend=baxter") continue;  // lacks the tool, which only a build with ROS asks for
    const auto found = recorded.find(name);
    if (found == recorded.end()) {
      ADD_FAILURE() << name << " is new: PALPATE_KEEP=1 writes it to " << file;
    } else {
      EXPECT_EQ(difference(sorted(lines_in(found->second)), sorted(lines_in(text))), "") << name;
    }
  }
  EXPECT_EQ(now.size(), recorded.size()) << "configs have gone";
}

/// "path,value" of every option below `path` that declares a neutral value.
void add_neutral(Lines& out, const std::vector<FieldDescription>& fields, const std::string& path) {
  for (const FieldDescription& field : fields) {
    if (!field.neutral.empty()) out.push_back(path + field.name + "," + field.neutral);
    add_neutral(out, field.fields, path + field.name + ".");
    for (const auto& one : field.cases) add_neutral(out, one.fields, path);
  }
}

/// What the reader of configs says of "path,value".
std::string read_neutral(const std::string& line) {
  const std::string path = line.substr(0, line.find(','));
  const std::string value = line.substr(path.size() + 1);
  const auto slash = path.find('/');
  if (slash == std::string::npos) return error_of([&] { shipped_config("default.yaml", {path + "=" + value}); });
  const auto dot = path.find('.');
  const std::string name = path.substr(slash + 1, dot - slash - 1);
  const std::string options = "{" + path.substr(dot + 1) + ": " + value + "}";
  return error_of([&] { choose(shared_host(), path.substr(0, slash), name, options); });
}

TEST(NeutralValues, OfAllOptionsAreThoseThatWereRecordedAndInTheirRanges) {
  Lines now;
  add_neutral(now, describe_fields([](Fields& fields) { ExperimentOptions().list(fields); }), "");
  for (const std::string& kind : PluginHost::kinds()) {
    for (const std::string& name : shared_host().names(kind)) {
      const auto list = [&](Fields& fields) { shared_host().describe(kind, name, fields); };
      add_neutral(now, describe_fields(list), kind + "/" + name + ".");
    }
  }
  Lines recorded = lines_in(text_of(source_folder() / "tests" / "data" / "neutral.csv"));
  ASSERT_EQ(recorded.front(), "path,value");
  recorded.erase(recorded.begin());
  EXPECT_EQ(difference(sorted(recorded), sorted(now)), "")
      << "a new line belongs into tests/data/neutral.csv; since 0.1.0 none of it is changed or taken away";
  for (const std::string& line : now) EXPECT_EQ(read_neutral(line), "accepted") << line;
}

}  // namespace
}  // namespace palpate::test
