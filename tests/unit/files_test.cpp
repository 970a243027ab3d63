// SPDX-License-Identifier: MIT
#include "record/files.hpp"

#include "children/child_process.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gtest/gtest.h>

#include <csignal>
#include <utility>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using test::text_of;

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
  try {
    const FileLock lock(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "locked";
}

ino_t inode(const fs::path& file) {
  struct stat status {};
  EXPECT_EQ(::stat(file.c_str(), &status), 0) << file;
  return status.st_ino;
}

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(Lock, IsBusyWhileAnotherProcessHoldsIt) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "lock";
  const auto holder = holder_of(file);
  EXPECT_TRUE(FileLock::is_held(file));
  EXPECT_EQ(refused_lock(file, Error::Kind::busy),
            folder.path().string() + ": another process holds this run, wait for it, or stop it");
}

TEST(Lock, IsFreeOnceItsHolderWasKilled) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "lock";
  auto holder = holder_of(file);
  holder.reset();
  EXPECT_FALSE(FileLock::is_held(file));
  EXPECT_EQ(refused_lock(file, Error::Kind::busy), "locked");
}

TEST(Lock, IsBusyForASecondHolderInTheSameProcess) {
  const TemporaryFolder folder;
  const FileLock lock(folder.path() / "lock");
  EXPECT_EQ(refused_lock(folder.path() / "lock", Error::Kind::busy).find(": another process holds this run"),
            folder.path().string().size());
}

TEST(Lock, IsFreeAfterItsEnd) {
  const TemporaryFolder folder;
  { const FileLock lock(folder.path() / "lock"); }
  EXPECT_FALSE(FileLock::is_held(folder.path() / "lock"));
}

TEST(Lock, IsNotInheritedByAProgramThatWasStartedMeanwhile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "lock";
  auto lock = std::make_unique<FileLock>(file);
  // The shell says when it runs: by then the exec has closed what must not be inherited.
  const fs::path started = folder.path() / "started";
  ASSERT_EQ(::mkfifo(started.c_str(), 0600), 0);
  const test::Child child({"sh", "-c", "echo x > started; exec sleep 600"}, folder.path());
  EXPECT_EQ(text_of(started), "x\n");
  lock.reset();
  EXPECT_FALSE(FileLock::is_held(file));
}

TEST(Lock, MovesWithItsObject) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "lock";
  FileLock outer;
  {
    FileLock inner(file);
    outer = std::move(inner);
  }
  EXPECT_TRUE(FileLock::is_held(file));
  outer = FileLock();
  EXPECT_FALSE(FileLock::is_held(file));
}

TEST(Lock, OfAFileThatIsNotThereIsNotHeld) { EXPECT_FALSE(FileLock::is_held("/nonexistent/lock")); }

TEST(Lock, FailsWhereNoFileCanBe) {
  EXPECT_EQ(refused_lock("/nonexistent/lock", Error::Kind::run),
            "/nonexistent/lock: cannot be opened: No such file or directory");
}

TEST(WriteFile, WritesTheWholeText) {
  const TemporaryFolder folder;
  const std::string text("a\0b\n\xff", 5);
  write_file(folder.path() / "x", text);
  EXPECT_EQ(text_of(folder.path() / "x"), text);
}

TEST(WriteFile, ReplacesByRenamingSoThatAReaderKeepsTheOldContent) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("x", "old");
  const ino_t before = inode(file);
  fs::create_hard_link(file, folder.path() / "reader");
  write_file(file, "new");
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(text_of(folder.path() / "reader"), "old") << "the old file was not written to";
  EXPECT_NE(inode(file), before);
}

TEST(WriteFile, LeavesNoTemporaryFile) {
  const TemporaryFolder folder;
  write_file(folder.path() / "x", "a", true);
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(WriteFile, FollowsNoLinkThatSomebodyPutInItsPlace) {
  const TemporaryFolder folder;
  const fs::path victim = folder.write("victim", "mine");
  fs::create_symlink(victim, folder.path() / "x.tmp");  // as earlier builds named what they wrote first
  fs::create_symlink(victim, folder.path() / "x");
  write_file(folder.path() / "x", "new");
  EXPECT_EQ(text_of(victim), "mine");
  EXPECT_EQ(text_of(folder.path() / "x"), "new");
  EXPECT_FALSE(fs::is_symlink(folder.path() / "x"));
}

TEST(WriteFile, GivesItsFilesTheRightsOfAnyOther) {
  const TemporaryFolder folder;
  write_file(folder.path() / "x", "a");
  EXPECT_EQ(fs::status(folder.path() / "x").permissions(), fs::status(folder.write("y", "a")).permissions());
}

TEST(Neighbours, WithoutNamesAreAllRemoved) {
  const TemporaryFolder folder;
  folder.write("tap_004.csv.0123456789abcdef.tmp", "half of it");
  folder.write("tap_004.csv", "whole");
  remove_neighbours(folder.path(), {});
  EXPECT_FALSE(fs::exists(folder.path() / "tap_004.csv.0123456789abcdef.tmp"));
  EXPECT_TRUE(fs::exists(folder.path() / "tap_004.csv"));
}

TEST(Neighbours, OfTheNamedFilesAloneAreRemoved) {
  const TemporaryFolder folder;
  for (const char* name : {"x.csv.0123456789abcdef.tmp", "y.csv.0123456789abcdef.tmp", "x.csv", "x.csv.tmp"}) {
    folder.write(name, "half");
  }
  remove_neighbours(folder.path(), {"x.csv"});
  EXPECT_FALSE(fs::exists(folder.path() / "x.csv.0123456789abcdef.tmp"));
  EXPECT_EQ(entries(folder.path()), 3);
}

TEST(InnerFolder, IsMadeButNeverALink) {
  const TemporaryFolder folder;
  make_inner_folder(folder.path() / "a");
  make_inner_folder(folder.path() / "a");
  EXPECT_TRUE(fs::is_directory(folder.path() / "a"));
  fs::create_directory_symlink(folder.path() / "a", folder.path() / "b");
  try {
    make_inner_folder(folder.path() / "b");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder.path() / "b").string() + ": is a link, and nothing is written through one, remove it");
  }
}

TEST(WriteFile, SaysWhyAPlaceCannotBeWritten) {
  try {
    write_file("/nonexistent/x", "a");
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/nonexistent/x: cannot be made: No such file or directory");
    EXPECT_EQ(error.kind(), Error::Kind::run);
  }
}

TEST(WriteFile, SaysWhyAFolderCannotBeReplaced) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "x");
  try {
    write_file(folder.path() / "x", "a");
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), (folder.path() / "x").string() + ": cannot be renamed to: Is a directory");
  }
}

TEST(WriteFile, ThatIsRefusedItsBytesSaysWhyAndLeavesTheOldFileAndNoOther) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("x", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  // As a full disk would: a limit of this process on the length of files.
  const auto heard = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  std::string said = "written";
  try {
    write_file(file, std::string(5000, 'a'));
  } catch (const Error& error) {
    said = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, heard);
  EXPECT_EQ(said, file.string() + ": cannot be written: File too large");
  EXPECT_EQ(text_of(file), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ReadFile, ReturnsEveryByte) {
  const TemporaryFolder folder;
  const std::string text("a\0\r\n\xff", 5);
  EXPECT_EQ(read_file(folder.write("x", text)), text);
}

TEST(ReadFile, RefusesWhatIsMissingOrNoFile) {
  const TemporaryFolder folder;
  for (const fs::path& file : {folder.path() / "missing", folder.path()}) {
    try {
      read_file(file);
      ADD_FAILURE() << "read";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()), file.string() + ": cannot be read");
    }
  }
}

TEST(AppendFile, AddsToWhatIsThere) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("log", "one\n");
  AppendFile log(file);
  log.append("two\n", false);
  log.append("three\n", true);
  EXPECT_EQ(text_of(file), "one\ntwo\nthree\n") << "readable before it is closed";
}

TEST(AppendFile, WritesAtTheEndEvenIfAnotherHasWrittenMeanwhile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "log";
  AppendFile first(file);
  AppendFile second(file);
  first.append("1", false);
  second.append("2", false);
  first.append("3", false);
  EXPECT_EQ(text_of(file), "123");
}

TEST(AppendFile, AndLockAndCutFollowNoLink) {
  const TemporaryFolder folder;
  const fs::path victim = folder.write("victim", "mine");
  const fs::path link = folder.path() / "log";
  fs::create_symlink(victim, link);
  const auto refused = [&](const auto& write) {
    try {
      write();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("written");
  };
  const std::string words = link.string() + ": is a link, and nothing is written through one, remove it";
  EXPECT_EQ(refused([&] { AppendFile(link).append("x", false); }), words);
  EXPECT_EQ(refused([&] { FileLock{link}; }), words);
  EXPECT_EQ(refused([&] { cut_file(link, 0); }), words);
  EXPECT_EQ(text_of(victim), "mine");
}

TEST(AppendFile, KnowsWhetherItIsStillWhereItWasOpened) {
  const TemporaryFolder folder;
  AppendFile log(folder.path() / "log");
  EXPECT_TRUE(log.is_in_place());
  fs::rename(folder.path() / "log", folder.path() / "elsewhere");
  EXPECT_FALSE(log.is_in_place());
  folder.write("log", "");
  EXPECT_FALSE(log.is_in_place()) << "another file of that name";
}

TEST(AppendFile, SaysWhyItCannotWrite) {
  AppendFile full("/dev/full");
  try {
    full.append("x", false);
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot be written: No space left on device");
  }
  EXPECT_THROW(AppendFile("/nonexistent/log"), Error);
}

}  // namespace
}  // namespace palpate
