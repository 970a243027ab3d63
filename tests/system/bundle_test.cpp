// SPDX-License-Identifier: MIT
// `palpate bundle`, `verify` and `rerun`: what a bundle contains, and that every change of it is found. PALPATE_LONG=1
// makes 300 changes of each kind, as in ./check --long.
#include "support/programs.hpp"
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include "bundle/archive.hpp"
#include "bundle/bundle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <functional>
#include <random>
#include <regex>
#include <sstream>

namespace palpate {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kFile = "x.palpate.tar.gz";

class Bundle : public Shell {
 protected:
  /// Makes a bundle of these records and returns its files.
  ArchivedFiles bundled(const Words& words) const {
    fs::remove(here() / kFile);
    const Ended ended = palpate(Words{"bundle", "-o", kFile} + words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return files_of(here() / kFile);
  }
  static ArchivedFiles files_of(const fs::path& file) {
    ArchivedFiles out;
    read_archive(file, kMostArchivedBytes,
                 [&](const std::string& name, const std::string& content) { out[name] = content; });
    return out;
  }
  Ended verify(const Words& more = {}) const { return palpate(Words{"verify", kFile} + more); }
  /// Verifies other files under the name of the bundle. `sums`: whether SHA256SUMS fits them.
  Ended verify_files(ArchivedFiles files, bool sums) const {
    if (sums) {
      std::map<std::string, std::string> hashes;
      for (const auto& [name, content] : files) {
        if (name != kSumsFile) hashes[name] = sha256_of(content);
      }
      files[kSumsFile] = sums_text(hashes);
    }
    write_archive(here() / kFile, "x", files);
    return verify();
  }
  fs::path small_sweep() const {
    return swept("acquisition=uncertainty,weighted taps=6 candidates.count=16 seed=1,2 name=small");
  }
};

TEST_F(Bundle, VerifiesAndHasTheSameBytesWhereverItsRecordsAre) {
  const fs::path sweep = small_sweep();
  const Words results{"--result", "compare --by acquisition --metric rmse_m"};
  const ArchivedFiles files = bundled(Words{sweep.string()} + results);
  const std::string bytes = text_of(here() / kFile);
  const Ended ended = verify();
  EXPECT_EQ(ended.status, 0) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("4 in the bundle, 4 repeated, 0 replayed"), HasSubstr("1 of 1 are equal"),
                               HasSubstr("\nno differences\n")));
  EXPECT_THAT(ended.out, HasSubstr("digest: " + sha256_of(files.at(kSumsFile))));
  EXPECT_EQ(test::run_program(
                {"sh", "-c", std::string("tar xzf ") + kFile + " && cd x && sha256sum --quiet -c SHA256SUMS"}, here())
                .status,
            0);
  fs::create_directories(here() / "elsewhere");
  fs::rename(here() / "runs", here() / "elsewhere" / "runs");
  bundled(Words{"elsewhere/runs/small"} + results);
  EXPECT_EQ(text_of(here() / kFile), bytes);
}

TEST_F(Bundle, ContainsNoPathOfTheMachineAndMeshesByTheirContent) {
  write("cup.stl", text_of(test::source_folder() / "configs/scene/meshes/cup.stl"));
  const fs::path run = ran(
      {"name=own", "taps=4",
       "scene.objects=[{type: mesh, file: " + (here() / "cup.stl").string() + ", unit: 1 mm, at: [11 cm, 11 cm]}]"});
  const ArchivedFiles files = bundled({run.string()});
  for (const auto& [name, content] : files) {
    EXPECT_THAT(content, Not(HasSubstr(here().string()))) << name;
    EXPECT_THAT(content, Not(HasSubstr(test::source_folder().string()))) << name;
  }
  const std::string mesh = text_of(here() / "cup.stl");
  EXPECT_EQ(files.at("files/" + sha256_of(mesh) + ".stl"), mesh);
  fs::remove(here() / "cup.stl");
  fs::remove_all(here() / "runs");
  EXPECT_EQ(verify().status, 0) << verify().out;
  const Ended ended = palpate({"rerun", kFile, run.filename().string()});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(palpate({"replay", "own"}).status, 0) << "the run keeps its mesh";
}

/// Removes what depends on clocks and processes. A change of it cannot be found.
void remove_clocks(nlohmann::json& value) {
  if (!value.is_object()) return;
  if (value.contains("timing")) value = {{"timing", value["timing"]}};
  for (const char* const key : {"at", "wall_seconds", "compute_seconds", "compute", "peak_rss_bytes", "summary.json"})
    value.erase(key);
  for (auto& [key, inner] : value.items()) remove_clocks(inner);
}

/// Returns what a file says, without clocks and comments; the text itself if that is no JSON.
std::string meaning(const std::string& name, const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (name.find("config.yaml") != std::string::npos) line = line.substr(0, line.find("  # "));
    nlohmann::json parsed = nlohmann::json::parse(line, nullptr, false);
    if (parsed.is_object() && name.find("record.jsonl") != std::string::npos) {
      remove_clocks(parsed);
      line = parsed.dump();
    }
    out += line + "\n";
  }
  return out;
}

std::string changed_text(const std::string& text, std::mt19937& random) {
  const auto below = [&](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  std::string out = text;
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line + "\n");
  const std::size_t how = lines.size() < 2 ? below(2) : below(5);
  const std::size_t line = below(lines.size());
  if (how < 2) {
    const std::size_t at = below(out.size());
    const char digit = static_cast<char>('0' + below(10));
    out[at] = out[at] >= '0' && out[at] <= '9' ? digit : static_cast<char>(out[at] ^ (1 << below(4)));
    return out;
  }
  if (how == 2) lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(line));
  if (how == 3) lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(line), lines[below(lines.size())]);
  if (how == 4) std::swap(lines[line], lines[below(lines.size())]);
  out.clear();
  for (const std::string& one : lines) out += one;
  return out;
}

/// Returns the files after one random change that is none of clocks or comments, and a description of it.
std::pair<ArchivedFiles, std::string> tampered(const ArchivedFiles& files, std::mt19937& random) {
  for (;;) {
    ArchivedFiles out = files;
    const auto below = [&](std::size_t count) {
      return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
    };
    const auto any = [&] { return std::next(out.begin(), static_cast<std::ptrdiff_t>(below(out.size()))); };
    const auto file = any();
    if (file->first == kSumsFile) continue;
    std::string what = file->first;
    const std::size_t how = below(12);
    if (how == 0) {
      out.erase(file);
      return {out, what + " is removed"};
    }
    if (how == 1) {
      const auto other = any();
      if (other->second == file->second || fs::path(other->first).filename() != fs::path(what).filename()) continue;
      std::swap(other->second, file->second);
      return {out, what + " and " + other->first + " are swapped"};
    }
    if (how == 2) {
      const std::size_t at = file->second.find("0.1.0");
      if (at == std::string::npos) continue;
      file->second.replace(at, 5, "0.1.1");
      return {out, what + " has another version"};
    }
    if (how == 3) {
      out.emplace(what + "2", file->second);
      return {out, what + "2 is added"};
    }
    const std::string before = file->second;
    file->second = changed_text(before, random);
    if (meaning(what, before) == meaning(what, file->second)) continue;
    const auto at = std::mismatch(before.begin(), before.end(), file->second.begin(), file->second.end());
    return {out, what + " is changed at " + std::string(at.first, before.end()).substr(0, 60) + ", now " +
                     std::string(at.second, file->second.end()).substr(0, 60)};
  }
}

int tamperings() { return test::brief() ? 20 : std::getenv("PALPATE_LONG") != nullptr ? 300 : 40; }

TEST_F(Bundle, ShowsEveryChangeEvenIfItsChecksumsAreMadeAgain) {
  write("cup.stl", text_of(test::source_folder() / "configs/scene/meshes/cup.stl"));
  const fs::path mesh =
      ran({"name=own", "taps=4", "scene.objects=[{type: mesh, file: cup.stl, unit: 1 mm, at: [11 cm, 11 cm]}]"});
  const ArchivedFiles files =
      bundled(Words{small_sweep().string(), mesh.string(), "--result", "compare --by acquisition --metric rmse_m",
                    "--result", "curves --by acquisition"});
  ASSERT_EQ(verify().status, 0) << verify().out;
  std::mt19937 random(7);
  for (const bool sums : {false, true}) {
    for (int i = 0; i < tamperings(); ++i) {
      const auto [changed, what] = tampered(files, random);
      const Ended ended = verify_files(changed, sums);
      if (ended.status == 1 || ended.status == 2) continue;
      ADD_FAILURE() << what << (sums ? ", with new checksums" : "") << ": status " << ended.status << "\n" << ended.out;
    }
  }
}

TEST_F(Bundle, OfRunsThatWereKilledOrFailedVerifiesAndShowsALostEnd) {
  const fs::path killed = ran({"name=killed", "taps=8", "candidates.count=16"});
  break_off(killed);
  ASSERT_EQ(resume(killed).status, 0);
  const ArchivedFiles files = bundled({killed.string()});
  const std::string record = "records/killed/" + killed.filename().string() + "/record.jsonl";
  ASSERT_THAT(files.at(record), HasSubstr("\n{\"attempt\": 2,"));
  EXPECT_EQ(verify().status, 0) << verify().out;
  const auto changed = [&](const std::string& part, const std::string& other) {
    ArchivedFiles out = files;
    std::string& text = out.at(record);
    EXPECT_NE(text.find(part), std::string::npos) << part;
    text.replace(text.find(part), part.size(), other);
    return verify_files(out, true);
  };
  EXPECT_EQ(changed(files.at(record).substr(files.at(record).find("{\"end\": \"done\"")), "").status, 1) << "no end";
  EXPECT_EQ(changed("\"source\": \"acquisition\"", "\"source\": \"caller\"").status, 1);
  EXPECT_NE(changed("\"height\": ", "\"height\": 1, \"height\": ").status, 0) << "a key twice";
  EXPECT_EQ(changed("\"reason\": null", "\"reason\": \"null\"").status, 1);
  break_off(killed);
  EXPECT_THAT(refused({"bundle", killed.string(), "-o", "y.palpate.tar.gz"}), HasSubstr("has not ended"));
}

TEST_F(Bundle, RunsNoCommandAndWritesNoFileOfAStranger) {
  const fs::path sweep = small_sweep();
  const ArchivedFiles files = bundled({sweep.string(), "--result", "compare --by acquisition --metric rmse_m"});
  ArchivedFiles changed = files;
  const std::string id = job_of(sweep, 0).filename().string();
  const auto job = std::find_if(changed.begin(), changed.end(), [&](const auto& one) {
    return one.first.find(id + "/config.yaml") != std::string::npos;
  });
  ASSERT_NE(job, changed.end());
  std::string& config = job->second;
  const std::size_t at = config.find("acquisition:\n");
  ASSERT_NE(at, std::string::npos);
  config.replace(at, config.find("choice:", at) - at,
                 "acquisition:\n  type: program\n  command: \"touch " + (here() / "PWNED").string() +
                     "\"\n  folder: \"/\"\n  checksum: \"x\"\n  reads: \"none\"\n  deadline: 1 s\n  start: 1 s\n");
  EXPECT_NE(verify_files(changed, true).status, 0);
  palpate({"rerun", kFile, id, "--runs", "other"});
  EXPECT_FALSE(fs::exists(here() / "PWNED"));
  for (const std::string& words : {"curves --by acquisition -o" + (here() / "PWNED.csv").string(),
                                   "compare --by acquisition --metric rmse_m " + sweep.string(), std::string("run x"),
                                   std::string("pareto --cost taps --error rmse_m --within 3mm")}) {
    changed = files;
    changed.at("results/1/command") = words + "\n";
    EXPECT_EQ(verify_files(changed, true).status, 1) << words;
    EXPECT_EQ(palpate({"bundle", sweep.string(), "-o", "z.palpate.tar.gz", "--result", words}).status, 2) << words;
  }
  EXPECT_FALSE(fs::exists(here() / "PWNED.csv"));
}

TEST_F(Bundle, OfAnotherInstructionSetVerifiesWithinTheStatedBound) {
  const fs::path sweep = small_sweep();
  bundled({sweep.string(), "--result", "compare --by acquisition --metric rmse_m"});
  environment_ = {"PALPATE_INSTRUCTIONS=baseline"};
  const Ended ended = verify();
  EXPECT_EQ(ended.status, 0) << ended.out;
}

TEST_F(Bundle, WithALongListOfHashesIsRefusedInOneLine) {
  ArchivedFiles files = bundled({small_sweep().string()});
  for (int i = 0; i < 100'000; ++i) files.at(kSumsFile) += std::to_string(i) + "\n";
  const Ended ended = verify_files(files, false);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, EndsWith("\nSHA256SUMS is too large for its files\n1 difference\n"));
}

TEST_F(Bundle, IsCheckedBySampleWithTheShareThatThisWouldMiss) {
  bundled({small_sweep().string()});
  const Ended ended = verify({"--sample", "2"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  // (1 - s)^2 = 0.05
  EXPECT_THAT(ended.out, AllOf(HasSubstr("4 in the bundle, 2 repeated"), HasSubstr("more than 78 % of the runs")));
}

TEST_F(Bundle, ReplaysRunsWhoseTapsCannotBeMadeAgainAndFindsAChangedTap) {
  write("arm.py", test::python("for ask in asks():\n    tell(ask, outcome='contact', height=0.05 if ask['x'] > 0.1 "
                               "else 0.0, force=3, seconds=1)\n"));
  const fs::path run = ran({"name=arm", "taps=8", "backend={type: process, command: python3 arm.py}"});
  const ArchivedFiles files = bundled({run.string()});
  const Ended ended = verify();
  EXPECT_EQ(ended.status, 0) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("not repeated: 1 run, because its taps are of the backend process"));
  ArchivedFiles changed = files;
  const std::string record = "records/arm/" + run.filename().string() + "/record.jsonl";
  std::string& text = changed.at(record);
  const std::size_t at = text.find("\"height\": 0.05");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 14, "\"height\": 0.06");
  const Ended wrong = verify_files(changed, true);
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.out, HasSubstr("recorded "));
  const Ended again = palpate({"rerun", kFile, run.filename().string(), "--runs", "other"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("so its record was copied"));
}

TEST_F(Bundle, RerunsARunWithTheSameTaps) {
  const fs::path sweep = small_sweep();
  bundled({sweep.string()});
  const std::string id = job_of(sweep, 2).filename().string();
  const Ended ended = palpate({"rerun", kFile, id.substr(0, 8), "--runs", "mine"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(text_of(here() / "mine/small" / id / "taps.csv"), text_of(job_of(sweep, 2) / "taps.csv"));
  EXPECT_EQ(palpate({"explain", "mine/small/" + id, "4"}).status, 0);
  EXPECT_EQ(refused({"rerun", kFile, "nothing"}),
            std::string(kFile) +
                ": contains 0 runs whose id begins with 'nothing', its README.md and manifest.jsonl list the runs\n");
}

TEST_F(Bundle, RefusesWhatItCannotPack) {
  const fs::path sweep = small_sweep();
  write("there.palpate.tar.gz", "precious");
  EXPECT_THAT(refused({"bundle", sweep.string(), "-o", "there.palpate.tar.gz"}), HasSubstr("exists already"));
  EXPECT_THAT(refused({"bundle", sweep.string(), "-o", "x.tar"}),
              HasSubstr("write a name that ends in .palpate.tar.gz"));
  EXPECT_THAT(refused({"bundle", sweep.string(), "--result", "run x"}), HasSubstr("is not compare, pareto or curves"));
  EXPECT_THAT(palpate({"bundle", sweep.string(), "--result", "compare --by nothing --metric rmse_m"}).err,
              HasSubstr("nothing"));
  EXPECT_THAT(refused({"bundle", sweep.string(), "--sources", "none"}), HasSubstr("none: is not a folder"));
  fs::remove_all(job_of(sweep, 1));
  EXPECT_NE(palpate({"bundle", sweep.string()}).status, 0);
  EXPECT_FALSE(fs::exists(here() / "small.palpate.tar.gz")) << "nothing is left";
  EXPECT_THAT(refused({"verify", "nothing.palpate.tar.gz"}), HasSubstr("name a bundle"));
  write("text.palpate.tar.gz", "no archive");
  EXPECT_THAT(refused({"verify", "text.palpate.tar.gz"}), HasSubstr("is not an archive of gzip"));
  write_archive(here() / "other.palpate.tar.gz", "other",
                {{"a.txt", "a"}, {kSumsFile, sums_text({{"a.txt", sha256_of("a")}})}});
  EXPECT_THAT(palpate({"verify", "other.palpate.tar.gz"}).out,
              AllOf(HasSubstr("a.txt does not belong to the bundle"), HasSubstr("README.md is not as")));
}

}  // namespace
}  // namespace palpate
