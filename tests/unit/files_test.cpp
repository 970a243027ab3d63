// SPDX-License-Identifier: MIT
#include "record/files.hpp"

#include "children/child_process.hpp"
#include "support/shortage.hpp"
#include "support/testing.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

/// A process that takes the lock, says so, and then holds it until it is killed.
std::unique_ptr<ChildProcess> holder_of(const fs::path& file) {
  auto out = ChildProcess::fork([&](const ChildProcess::Say& say) {
    const FileLock lock(file);
    say("it is taken");
    return ::pause();
  });
  while (out->said().empty() && !out->wait(0.001)) {
  }
  return out;
}

std::string refused_lock(const fs::path& file, Error::Kind kind) {
  return error_of([&] { const FileLock lock(file); }, kind);
}

ino_t inode(const fs::path& file) {
  struct stat status {};
  EXPECT_EQ(::stat(file.c_str(), &status), 0) << file;
  return status.st_ino;
}

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

using Lock = InFolder;

TEST_F(Lock, IsBusyWhileAnotherProcessHoldsItAndFreeOnceThatWasKilled) {
  const fs::path file = folder_.path() / "lock";
  auto holder = holder_of(file);
  EXPECT_TRUE(FileLock::is_held(file));
  EXPECT_EQ(refused_lock(file, Error::Kind::busy),
            folder_.path().string() + ": another process holds this run, wait for it, or stop it");
  holder.reset();
  EXPECT_FALSE(FileLock::is_held(file));
  EXPECT_EQ(refused_lock(file, Error::Kind::busy), "accepted");
}

TEST_F(Lock, IsBusyForASecondHolderInTheSameProcessAndFreeAfterItsEnd) {
  const fs::path file = folder_.path() / "lock";
  {
    const FileLock lock(file);
    EXPECT_EQ(refused_lock(file, Error::Kind::busy).find(": another process holds this run"),
              folder_.path().string().size());
  }
  EXPECT_FALSE(FileLock::is_held(file));
}

TEST_F(Lock, IsNotInheritedByAProgramThatWasStartedMeanwhile) {
  const fs::path file = folder_.path() / "lock";
  auto lock = std::make_unique<FileLock>(file);
  // The shell says when it runs: by then the exec has closed what must not be inherited.
  const fs::path started = folder_.path() / "started";
  ASSERT_EQ(::mkfifo(started.c_str(), 0600), 0);
  const test::Child child({"sh", "-c", "echo x > started; exec sleep 600"}, folder_.path());
  EXPECT_EQ(text_of(started), "x\n");
  lock.reset();
  EXPECT_FALSE(FileLock::is_held(file));
}

TEST_F(Lock, MovesWithItsObject) {
  const fs::path file = folder_.path() / "lock";
  FileLock outer;
  {
    FileLock inner(file);
    outer = std::move(inner);
  }
  EXPECT_TRUE(FileLock::is_held(file));
  outer = FileLock();
  EXPECT_FALSE(FileLock::is_held(file));
}

TEST_F(Lock, OfAFileThatIsNotThereIsNotHeld) { EXPECT_FALSE(FileLock::is_held("/nonexistent/lock")); }

TEST_F(Lock, FailsWhereNoFileCanBe) {
  EXPECT_EQ(refused_lock("/nonexistent/lock", Error::Kind::run),
            "/nonexistent/lock: cannot be opened: No such file or directory");
}

using WriteFile = InFolder;

TEST_F(WriteFile, WritesTheWholeTextAndLeavesNoTemporaryFile) {
  const std::string text("a\0b\n\xff", 5);
  write_file(folder_.path() / "x", text, true);
  EXPECT_EQ(text_of(folder_.path() / "x"), text);
  EXPECT_EQ(entries(folder_.path()), 1);
}

TEST_F(WriteFile, ReplacesByRenamingSoThatAReaderKeepsTheOldContent) {
  const fs::path file = folder_.write("x", "old");
  const ino_t before = inode(file);
  fs::create_hard_link(file, folder_.path() / "reader");
  write_file(file, "new");
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(text_of(folder_.path() / "reader"), "old") << "the old file was not written to";
  EXPECT_NE(inode(file), before);
}

TEST_F(WriteFile, FollowsNoLinkThatSomebodyPutInItsPlace) {
  const fs::path victim = folder_.write("victim", "mine");
  fs::create_symlink(victim, folder_.path() / "x.tmp");  // as earlier builds named what they wrote first
  fs::create_symlink(victim, folder_.path() / "x");
  write_file(folder_.path() / "x", "new");
  EXPECT_EQ(text_of(victim), "mine");
  EXPECT_EQ(text_of(folder_.path() / "x"), "new");
  EXPECT_FALSE(fs::is_symlink(folder_.path() / "x"));
}

TEST_F(WriteFile, GivesItsFilesTheRightsOfAnyOther) {
  write_file(folder_.path() / "x", "a");
  EXPECT_EQ(fs::status(folder_.path() / "x").permissions(), fs::status(folder_.write("y", "a")).permissions());
}

using TemporaryFiles = InFolder;

TEST_F(TemporaryFiles, OfAWriterThatWasKilledAreRemovedByTheNextThatWritesThere) {
  for (const char* name : {"surface.ply.0123456789abcdef.tmp", "y.0123456789abcdef.tmp", "x.csv", "x.csv.tmp",
                           "x.0123456789abcdeX.tmp", "0123456789abcdef.tmp"}) {
    folder_.write(name, "half");
  }
  write_file(folder_.path() / "report.html", "whole");
  EXPECT_EQ(entries(folder_.path()), 5);
  EXPECT_FALSE(fs::exists(folder_.path() / "surface.ply.0123456789abcdef.tmp"));
  EXPECT_FALSE(fs::exists(folder_.path() / "y.0123456789abcdef.tmp"));
}

TEST_F(TemporaryFiles, OfALivingWriterStay) {
  TemporaryFile file(folder_.path() / "x");
  remove_temporaries(folder_.path());
  file.write("whole");
  file.publish();
  EXPECT_EQ(text_of(folder_.path() / "x"), "whole");
  EXPECT_EQ(entries(folder_.path()), 1);
}

using InnerFolder = InFolder;

TEST_F(InnerFolder, IsMadeButNeverALink) {
  make_inner_folder(folder_.path() / "a");
  make_inner_folder(folder_.path() / "a");
  EXPECT_TRUE(fs::is_directory(folder_.path() / "a"));
  fs::create_directory_symlink(folder_.path() / "a", folder_.path() / "b");
  EXPECT_EQ(
      error_of([&] { make_inner_folder(folder_.path() / "b"); }),
      (folder_.path() / "b").string() + ": is a symbolic link, and links in a record are not followed, remove it");
}

TEST_F(WriteFile, SaysWhyAPlaceCannotBeWrittenOrAFolderReplaced) {
  EXPECT_EQ(error_of([] { write_file("/nonexistent/x", "a"); }, Error::Kind::run),
            "/nonexistent/x: cannot be made: No such file or directory");
  fs::create_directory(folder_.path() / "x");
  EXPECT_EQ(error_of([&] { write_file(folder_.path() / "x", "a"); }),
            (folder_.path() / "x").string() + ": cannot be renamed to: Is a directory");
}

TEST_F(WriteFile, ThatIsRefusedItsBytesSaysWhyAndLeavesTheOldFileAndNoOther) {
  const fs::path file = folder_.write("x", "old");
  EXPECT_EQ(with_little_room(1000, [&] { write_file(file, std::string(5000, 'a')); }),
            file.string() + ": cannot be written: File too large");
  EXPECT_EQ(text_of(file), "old");
  EXPECT_EQ(entries(folder_.path()), 1);
}

using ReadFile = InFolder;

TEST_F(ReadFile, ReturnsEveryByte) {
  const std::string text("a\0\r\n\xff", 5);
  EXPECT_EQ(read_file(folder_.write("x", text)), text);
}

TEST_F(ReadFile, RefusesWhatIsMissingOrNoFile) {
  const fs::path missing = folder_.path() / "missing";
  EXPECT_EQ(error_of([&] { read_file(missing); }), missing.string() + ": cannot be read");
  EXPECT_EQ(error_of([&] { read_file(folder_.path()); }),
            folder_.path().string() + ": is not a regular file, put a file in its place, or remove it");
}

TEST_F(ReadFile, TakesNoShortageOfDescriptorsForADamagedFile) {
  const fs::path file = folder_.write("x", "text");
  EXPECT_EQ(without_descriptors([&] { read_if_there(file); }), file.string() + ": cannot be read: Too many open files");
  EXPECT_EQ(without_descriptors([&] { FileLock::is_held(file); }),
            file.string() + ": cannot be accessed: Too many open files");
}

TEST_F(ReadFile, FindsTheFirstLineHoweverLongItIs) {
  for (const std::size_t length : {0U, 5U, 16383U, 16384U, 300'000U}) {
    const std::string line(length, 'x');
    EXPECT_EQ(first_line_if_there(folder_.write("x", line + "\nsecond\n")), line);
    EXPECT_EQ(first_line_if_there(folder_.write("x", line)), std::nullopt) << "no whole line";
  }
  EXPECT_EQ(first_line_if_there(folder_.path() / "missing"), std::nullopt);
}

using Appending = InFolder;

TEST_F(Appending, AddsToWhatIsThere) {
  const fs::path file = folder_.write("log", "one\n");
  AppendFile log(file);
  log.append("two\n", false);
  log.append("three\n", true);
  EXPECT_EQ(text_of(file), "one\ntwo\nthree\n") << "readable before it is closed";
}

TEST_F(Appending, WritesAtTheEndEvenIfAnotherHasWrittenMeanwhile) {
  const fs::path file = folder_.path() / "log";
  AppendFile first(file);
  AppendFile second(file);
  first.append("1", false);
  second.append("2", false);
  first.append("3", false);
  EXPECT_EQ(text_of(file), "123");
}

TEST_F(Appending, AndLockAndCutFollowNoLink) {
  const fs::path victim = folder_.write("victim", "mine");
  const fs::path link = folder_.path() / "log";
  fs::create_symlink(victim, link);
  const std::string words = link.string() + ": is a symbolic link, and links in a record are not followed, remove it";
  EXPECT_EQ(error_of([&] { AppendFile(link).append("x", false); }), words);
  EXPECT_EQ(error_of([&] { FileLock{link}; }), words);
  EXPECT_FALSE(FileLock::is_held(link)) << "nor is it opened";
  EXPECT_EQ(text_of(victim), "mine");
}

TEST_F(Appending, KeepsOthersOutWhereItIsDoneThroughALock) {
  const fs::path file = folder_.write("log", "one\n");
  const FileLock lock(file);
  AppendFile log = lock.append_file();
  log.append("two\n", true);
  EXPECT_EQ(text_of(file), "one\ntwo\n");
  log.cut(4);
  EXPECT_EQ(text_of(file), "one\n");
  log = AppendFile();
  EXPECT_THAT(refused_lock(file, Error::Kind::busy), testing::HasSubstr("another process holds this run"));
}

TEST_F(Appending, RefusesAfterAFailedSyncForTheSameReason) {
  // A pipe takes what is written and cannot be synced.
  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const FileDescriptor reader(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  AppendFile log(pipe);
  const std::string words = error_of([&] { log.append("x", true); }, Error::Kind::run);
  EXPECT_EQ(words,
            pipe.string() + ": its last line may not be on the disk, because it cannot be synced: Invalid argument");
  EXPECT_EQ(error_of([&] { log.append("y", false); }, Error::Kind::run), words);
}

TEST_F(Appending, CutsOffALineThatItCouldNotWriteWhole) {
  const fs::path file = folder_.write("log", std::string(990, 'a') + "\n");
  AppendFile log(file);
  EXPECT_EQ(with_little_room(1000, [&] { log.append("twenty characters ...", false); }),
            file.string() + ": cannot be written: File too large");
  EXPECT_EQ(fs::file_size(file), 991U) << "no half line, to which the next would be appended";
  log.append("next\n", false);
  EXPECT_EQ(text_of(file), std::string(990, 'a') + "\nnext\n");
}

TEST_F(Appending, SaysWhyItCannotWrite) {
  AppendFile full("/dev/full");
  EXPECT_EQ(error_of([&] { full.append("x", false); }), "/dev/full: cannot be written: No space left on device");
  EXPECT_THROW(AppendFile("/nonexistent/log"), Error);
}

}  // namespace
}  // namespace palpate::test
