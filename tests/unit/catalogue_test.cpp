// SPDX-License-Identifier: MIT
// Which run or sweep is meant by a folder or a name. The folders are written by hand, and with the times that they
// need.
#include "record/catalogue.hpp"
#include "record/resolved_config.hpp"

#include "support/testing.hpp"

#include <chrono>

namespace palpate::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

class Records : public InFolder {
 protected:
  /// A run that was begun so many minutes after the others, with this seed and whatever else its config says.
  fs::path run(const std::string& directory, int minute, const std::string& config = "name: first\nseed: 1\n") const {
    const fs::path file = folder_.write("runs/" + directory + "/config.yaml", config);
    fs::last_write_time(file, begin_ + std::chrono::minutes(minute));
    return file.parent_path();
  }
  fs::path sweep(const std::string& directory, int minute) const {
    folder_.write("runs/" + directory + "/manifest.jsonl", "");
    return run(directory, minute);
  }
  fs::path runs() const { return folder_.path() / "runs"; }
  fs::path found(const std::string& words, RecordKind wanted = RecordKind::any) const {
    return find_record(words, wanted, runs());
  }
  std::string refusal(const std::string& words, RecordKind wanted = RecordKind::any) const {
    return error_of([&] { found(words, wanted); }, Error::Kind::usage);
  }

 private:
  fs::file_time_type begin_ = fs::file_time_type::clock::now() - std::chrono::hours(24);
};

TEST_F(Records, StandInTheOrderInWhichTheyWereBegun) {
  const fs::path second = run("a/000000000002", 2);
  const fs::path third = run("a/000000000001", 3);
  const fs::path first = sweep("b/000000000003", 1);
  EXPECT_THAT(read_catalogue(runs()).records, ElementsAre(first, second, third));
}

TEST_F(Records, JobsDraftsLinksAndRunsMovedAsideAreNoneAndFoldersWithoutOneAreCounted) {
  const fs::path many = sweep("many/000000000001", 1);
  run("many/000000000001/jobs/000000000002", 2);
  run("many/.sweep-Xyz123", 3);
  const fs::path aside = run("first/000000000004.old-1", 4);
  folder_.write("runs/notes/deep/text.md", "");
  fs::create_directory_symlink(runs() / "many", runs() / "linked");
  const Catalogue all = read_catalogue(runs());
  EXPECT_THAT(all.records, ElementsAre(many));
  EXPECT_EQ(all.strangers, 1);
  EXPECT_EQ(all.moved_aside, 1);
  EXPECT_THAT(read_catalogue(aside).records, ElementsAre(aside)) << "who gives its path means it";
}

TEST_F(Records, AFolderWithoutOneThatHasAReadmeIsNotCounted) {
  folder_.write("runs/reference/README.md", "");
  folder_.write("runs/reference/table.csv", "");
  folder_.write("runs/notes/text.md", "");
  EXPECT_EQ(read_catalogue(runs()).strangers, 1);
}

TEST_F(Records, AreFoundFromAnyFolderAboveWhileThereIsOneBelow) {
  const fs::path only = run("first/000000000001", 1);
  for (const fs::path& words : {folder_.path(), runs(), runs() / "first", only}) EXPECT_EQ(found(words), only) << words;
}

TEST_F(Records, AreFoundByNameAlsoWhereAFolderCannotBeCalledSo) {
  const fs::path plain = run("first/000000000001", 1);
  const fs::path spaced = run(slug("my run") + "/000000000002", 2, "name: my run\n");
  const fs::path dashed = run("my-run/000000000003", 3, "name: my-run\n");
  EXPECT_EQ(found("first"), plain);
  EXPECT_EQ(found("my run"), spaced);
  EXPECT_EQ(found("my-run"), dashed);
  EXPECT_EQ(found(slug("my run")), spaced) << "the folder's own name";
  EXPECT_THAT(refusal("my  run"), HasSubstr("contains no run or sweep of that name"));
}

TEST_F(Records, AreFoundByNameBesideAFolderOfTheSameNameWithoutOne) {
  const fs::path one = run("first/000000000001", 1);
  const fs::path last = run("first/000000000002", 2);
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  fs::create_directory("first");  // of sources, as `palpate new` makes it
  EXPECT_EQ(found("first@latest"), last);
  EXPECT_THAT(refusal("first"), HasSubstr("matches 2 runs: "));
  fs::current_path(before);
}

TEST_F(Records, OfSeveralAreToldApartByWhatTheirConfigsDoNotShare) {
  const fs::path one = run("first/000000000001", 1, "name: first\nkernel: {type: rbf}\nseed: 1\ntaps: 9\n");
  const fs::path two = run("first/000000000002", 2, "name: first\nkernel: {type: matern52}\nseed: 7\ntaps: 9\n");
  EXPECT_EQ(refusal("first"),
            "first: matches 2 runs: " + two.string() + " (" + begun_text(two) + ", seed 7, kernel.type matern52); " +
                one.string() + " (" + begun_text(one) +
                ", seed 1, kernel.type rbf), give the directory of one, or first@latest for the latest");
  EXPECT_THAT(begun_text(two), MatchesRegex("20..-..-..T..:..:.."));
}

TEST_F(Records, OfManyTheLastFourAreTold) {
  for (int i = 0; i < 9; ++i) run("first/00000000000" + std::to_string(i), i, "seed: " + std::to_string(i) + "\n");
  EXPECT_THAT(refusal("first"), AllOf(HasSubstr("matches 9 runs: "), HasSubstr(", seed 8); "), HasSubstr("seed 5); "),
                                      HasSubstr("; 5 that were started earlier, "), Not(HasSubstr("seed 4"))));
}

TEST_F(Records, BegunLastAreMeantByLatest) {
  run("first/00000000000b", 1);
  const fs::path last = run("first/00000000000a", 2);
  const fs::path other = sweep("many/000000000003", 3);
  EXPECT_EQ(found("first@latest"), last);
  EXPECT_EQ(found((runs() / "first").string() + "@latest"), last);
  EXPECT_EQ(found(runs().string() + "@latest"), other);
  EXPECT_EQ(found(runs().string() + "@latest", RecordKind::run), last);
}

TEST_F(Records, OfTheKindThatACommandTakesAreMeantWhereThereAreAny) {
  const fs::path one = run("first/000000000001", 1);
  const fs::path many = sweep("first/000000000002", 2);
  EXPECT_EQ(found("first", RecordKind::run), one);
  EXPECT_EQ(found("first", RecordKind::sweep), many);
  EXPECT_THAT(refusal("first"), HasSubstr("matches 2 runs and sweeps: "));
  const fs::path alone = sweep("many/000000000003", 3);
  EXPECT_EQ(found("many", RecordKind::run), alone) << "the command says what it cannot do with a sweep";
}

TEST_F(Records, ThatAreDamagedAreFoundForTheCommandToSaySo) {
  run("first/000000000001", 1, "name: [\n");
  folder_.write("runs/second/000000000002/record.jsonl", "{");
  EXPECT_EQ(found("first"), runs() / "first/000000000001");
  EXPECT_EQ(found("second"), runs() / "second/000000000002");
  EXPECT_THAT(refusal(runs()), StartsWith(runs().string() + ": matches 2 runs: "));
}

TEST_F(Records, ThatAreNotThereAreOneLineAndPathsStayAsTheyAre) {
  run("first/000000000001", 1);
  EXPECT_EQ(refusal("frist"), "frist: is not a folder, and " + runs().string() +
                                  " contains no run or sweep of that name, did you mean 'first'?");
  EXPECT_THAT(refusal("zzz"),
              HasSubstr("contains no run or sweep of that name, run 'palpate list' to see all runs and sweeps"));
  EXPECT_THAT(refusal("first@first"),
              HasSubstr("contains no run or sweep of that name, only @latest may follow a name"));
  EXPECT_THAT(refusal(""), HasSubstr("contains no run or sweep of that name"));
  const fs::path empty = folder_.path() / "empty";
  fs::create_directory(empty);
  const fs::path file = folder_.write("file.txt", "");
  for (const fs::path& path : {empty, file, folder_.path() / "missing/run"}) EXPECT_EQ(found(path), path);
}

TEST_F(Records, TellEveryValueOfTheirConfigsByItsPath) {
  const fs::path one = run("first/000000000001", 1, "seed: 1\nscene: {objects: [{type: wave, at: [1 cm, 2 cm]}]}\n");
  const Row settings = read_settings(one);
  EXPECT_EQ(settings.text("scene.objects.0.at.1"), "2 cm");
  EXPECT_EQ(settings.text("seed"), "1");
  EXPECT_EQ(settings.fields.size(), 4U);
}

}  // namespace
}  // namespace palpate::test
