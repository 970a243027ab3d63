// SPDX-License-Identifier: MIT
// Labels of contacts are read again after later taps: what is shown says so, and counts agree with it.
#include "system/figure_blocks.hpp"

#include "record/fields.hpp"
#include "record/run_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace palpate {
namespace {

/// Labels by the numbers of their taps.
using Labels = std::map<int, std::string>;

/// Those that the lines of the table have: tap, source, x, y, height, contact.
Labels labels_in_table(const std::string& printed) {
  Labels out;
  for (const std::string& line : lines_of(printed)) {
    std::istringstream words(line);
    int tap = 0;
    std::string source, x, y, height, label;
    if (words >> tap >> source >> x >> y >> height >> label) out[tap] = label;
  }
  return out;
}

/// Labels with those of the line "relabelled at the end: tap 1 is on the object (desk at first), ..." in their place.
Labels corrected(Labels labels, const std::string& printed) {
  for (const std::string& line : lines_of(printed)) {
    if (line.rfind("relabelled at the end: ", 0) != 0) continue;
    for (auto at = line.find("tap "); at != std::string::npos; at = line.find("tap ", at + 1)) {
      std::istringstream words(line.substr(at));
      int tap = 0;
      std::string now, then, skipped;
      words >> skipped >> tap >> skipped >> skipped >> skipped >> now >> then;
      EXPECT_EQ("(" + labels[tap], then) << line;
      EXPECT_NE(labels[tap], now) << line;
      labels[tap] = now;
    }
  }
  return labels;
}

int count(const Labels& labels, const std::string& label) {
  return static_cast<int>(
      std::count_if(labels.begin(), labels.end(), [&](const auto& one) { return one.second == label; }));
}

class LabelsReadAgain : public Shell {
 protected:
  /// Runs a config in which labels change and compares what it shows with itself.
  fs::path expect_agreement(const Words& words, const std::string& file, int changed, const std::string& when_made) {
    const Ended ended = palpate(Words{"run", (test::source_folder() / file).string()} + words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const fs::path directory = this->directory();
    const Row summary = read_summary(directory).value();
    const Labels table = labels_in_table(ended.out);
    EXPECT_EQ(table.at(changed), when_made);
    const Labels end = corrected(table, ended.out);
    EXPECT_NE(end.at(changed), when_made) << ended.out;
    EXPECT_EQ(count(end, "object"), summary.number("object_taps").value());
    EXPECT_EQ(count(end, "desk"), summary.number("desk_taps").value());
    EXPECT_NE(count(table, "object"), count(end, "object")) << "the seed shows nothing";

    // The record: taps.csv has labels as they were made, the summary names the others.
    const std::vector<RelabelledContact> relabelled = relabelled_in(summary);
    Labels recorded;
    for (const Cells& tap : csv_rows(text_of(directory / "taps.csv"))) {
      const int number = std::stoi(tap.at("tap"));
      if (tap.at("outcome") == "contact") recorded[number] = tap.at("on_object") == "true" ? "object" : "desk";
      if (table.at(number) != "object" && table.at(number) != "desk") continue;
      EXPECT_EQ(recorded[number], table.at(number));
    }
    for (const RelabelledContact& one : relabelled) recorded[one.tap] = one.on_object ? "object" : "desk";
    EXPECT_EQ(count(recorded, "object"), summary.number("object_taps").value());
    EXPECT_EQ(palpate({"replay", directory}).status, 0);

    const Ended done = palpate(Words{"run", (test::source_folder() / file).string()} + words);
    EXPECT_THAT(done.out, HasSubstr("already done"));
    EXPECT_THAT(done.out, HasSubstr(fmt::format("relabelled at the end: tap {} is on the {} ({} at first)", changed,
                                                end.at(changed), when_made)));
    EXPECT_THAT(palpate({"explain", directory, std::to_string(changed)}).out,
                HasSubstr(end.at(changed) == "desk" ? "it is read as a contact with the desk"
                                                    : "it is read as a contact with an object"));

    // For other programs: the labels at the end, those of the surface beside them.
    EXPECT_EQ(palpate({"export", directory}).status, 0);
    int hits = 0;
    bool points = false;
    for (const std::string& line : lines_of(text_of(directory / "export/taps.ply"))) {
      if (points && line.back() == '1' && line[line.size() - 2] == ' ') ++hits;
      points = points || line == "end_header";
    }
    EXPECT_EQ(hits, count(end, "object"));
    return directory;
  }
};

TEST_F(LabelsReadAgain, OfTapsFromAboveAreNamedAndCountedAlikeByTableSummaryRecordAndPicture) {
  const fs::path directory = expect_agreement({"scene=mug"}, "configs/default.yaml", 1, "desk");
  const Row summary = read_summary(directory).value();
  ASSERT_EQ(palpate({"report", directory, "--figures"}).status, 0);
  const auto blocks = blocks_of(directory / "figures/maps.gnuplot");
  EXPECT_EQ(block_or_none(blocks, "on_last").size(), summary.number("object_taps").value());
  EXPECT_EQ(block_or_none(blocks, "off_last").size(), summary.number("desk_taps").value());
}

TEST_F(LabelsReadAgain, OfTapsFromAnySideAreNamedAndCountedAlike) {
  fs::create_symlink(test::source_folder() / "configs", here() / "configs");
  expect_agreement({"scene.effects=standard", "taps=12", "seed=6"}, "configs/any_side.yaml", 6, "object");
}

TEST_F(LabelsReadAgain, AreNoFieldWhereNothingIsReadAgain) {
  EXPECT_EQ(read_summary(ran("taps=4")).value().find("relabelled"), nullptr);
}

}  // namespace
}  // namespace palpate
