// SPDX-License-Identifier: MIT
// Archives of bundles: the same bytes for the same files, readable by tar, and nothing else is accepted.
#include "bundle/archive.hpp"
#include "support/testing.hpp"

#include <zlib.h>

#include <array>
#include <cstdlib>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using testing::AnyOf;
using testing::HasSubstr;

std::string unzipped(const fs::path& file) {
  std::string out;
  gzFile in = gzopen(file.c_str(), "rb");
  std::array<char, 4096> chunk;
  for (int got = gzread(in, chunk.data(), chunk.size()); got > 0; got = gzread(in, chunk.data(), chunk.size()))
    out.append(chunk.data(), static_cast<std::size_t>(got));
  gzclose(in);
  return out;
}

class Archive : public test::InFolder {
 protected:
  fs::path zipped(const std::string& bytes) const {
    fs::path file = folder_.path() / "made.tar.gz";
    gzFile out = gzopen(file.c_str(), "wb9");
    gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(out);
    return file;
  }
  fs::path written(const ArchivedFiles& files) const {
    fs::path file = folder_.path() / "written.tar.gz";
    write_archive(file, "bundle", files);
    return file;
  }
  static ArchivedFiles read(const fs::path& file, std::uintmax_t most_bytes = kMostArchivedBytes) {
    ArchivedFiles out;
    read_archive(file, most_bytes, [&](const std::string& name, const std::string& content) { out[name] = content; });
    return out;
  }
  /// The one line of the error with which an archive of these bytes is refused.
  std::string refusal(const std::string& tar) const {
    std::string line = test::error_of([&] { read(zipped(tar)); });
    EXPECT_EQ(line.find('\n'), std::string::npos);
    return line;
  }
  /// The archive that GNU tar makes of files and links here.
  std::string made_by_tar(const std::string& commands, const std::string& tar) const {
    const std::string all = "cd " + folder_.path().string() + " && mkdir -p bundle && " + commands +
                            " && tar c --format=ustar " +
                            "--owner=0 --group=0 --numeric-owner --mtime=@0 --mode=0644 -b 2 " + tar + " > made.tar";
    EXPECT_EQ(std::system(all.c_str()), 0) << all;
    return test::text_of(folder_.path() / "made.tar");
  }
};

TEST_F(Archive, GivesBackItsFilesWhateverIsInThem) {
  const ArchivedFiles files{{"a/b.txt", std::string("\0\n\xff", 3)},
                            {"empty", ""},
                            {"large", std::string(1'000'000, 'x') + "end"},
                            {std::string(90, 'd') + "/" + std::string(100, 'f'), "long name"}};
  EXPECT_EQ(read(written(files)), files);
}

TEST_F(Archive, HasTheSameBytesForTheSameFilesAndTarReadsIt) {
  const ArchivedFiles files{{"README.md", "text\n"}, {"jobs/1/record.jsonl", "{}\n"}};
  const std::string first = test::text_of(written(files));
  EXPECT_EQ(test::text_of(written(files)), first);
  const fs::path here = folder_.path();
  EXPECT_EQ(std::system(("tar xzf " + (here / "written.tar.gz").string() + " -C " + here.string()).c_str()), 0);
  EXPECT_EQ(test::text_of(here / "bundle" / "jobs" / "1" / "record.jsonl"), "{}\n");
}

TEST_F(Archive, HasTheHeadersOfGnuTar) {
  const std::string tar = made_by_tar("printf 'text\\n' > bundle/a.txt", "bundle/a.txt");
  EXPECT_EQ(unzipped(written({{"a.txt", "text\n"}})), tar);
}

TEST_F(Archive, RefusesLinksFoldersAndNamesThatLeadOutside) {
  const std::string no_file = "is not a plain file";
  EXPECT_THAT(refusal(made_by_tar("ln -sf /etc/passwd bundle/link", "bundle/link")), HasSubstr(no_file));
  EXPECT_THAT(refusal(made_by_tar("echo a > bundle/one && ln -f bundle/one bundle/two", "bundle/one bundle/two")),
              HasSubstr("entry 2 is not a plain file"));
  EXPECT_THAT(refusal(made_by_tar("mkdir -p bundle/folder", "bundle/folder")), HasSubstr(no_file));
  EXPECT_THAT(refusal(made_by_tar("mkfifo bundle/pipe || true", "bundle/pipe")), HasSubstr(no_file));
  const std::string rename = "--transform='s,bundle/one,";
  for (const char* const name : {"bundle/../../one", "/tmp/one", "bundle//one", "bundle/./one", "bundle/o ne", "one"})
    EXPECT_THAT(refusal(made_by_tar("echo a > bundle/one", rename + name + ",' -P bundle/one")),
                AnyOf(HasSubstr("empty or strange part"), HasSubstr("not a plain file")))
        << name;
}

TEST_F(Archive, RefusesNamesThatSomeFileSystemsCannotHaveTogether) {
  for (const ArchivedFiles& files : {ArchivedFiles{{"A", ""}, {"a", ""}}, ArchivedFiles{{"a", ""}, {"a/b", ""}},
                                     ArchivedFiles{{"A/b", ""}, {"a/c", ""}}}) {
    EXPECT_THROW(written(files), Error);
  }
  const std::string a = unzipped(written({{"a", "1"}}));
  const std::string b = unzipped(written({{"A", "1"}}));
  EXPECT_THAT(refusal(b.substr(0, 1024) + a), HasSubstr("'A' and 'a' exclude each other"));
  EXPECT_THAT(refusal(a.substr(0, 1024) + a), HasSubstr("not sorted"));
}

TEST_F(Archive, RefusesBombsAndSizesThatItsLimitForbids) {
  std::string nothing;
  nothing.resize(100'000'000);
  const fs::path zeros = written({{"zeros", nothing}});
  EXPECT_THAT(test::error_of([&] { read(zeros); }), HasSubstr("is compressed by more than 60 : 1"));
  ArchivedFiles ten;
  for (int i = 0; i < 10; ++i) ten[std::to_string(i)] = std::string(1000, 'x');
  const fs::path file = written(ten);
  EXPECT_THAT(test::error_of([&] { read(file, 9000); }), HasSubstr("unpacks to more than 9000 bytes"));
  EXPECT_THAT(test::error_of([&] { read(file, 7000); }), HasSubstr("'0' has more than 875 bytes"));
  EXPECT_EQ(read(file, 10'000), ten);
  std::string claims = unzipped(written({{"a", "x"}}));
  EXPECT_THAT(refusal(claims.substr(0, 600)), HasSubstr("ends too early"));
}

TEST_F(Archive, RefusesMoreFilesAndFoldersThanItsLimitAllows) {
  ArchivedFiles many;
  for (int i = 0; i < 100'001; ++i) many.emplace(std::to_string(i), sha256_of(std::to_string(i)));  // hard to compress
  EXPECT_THAT(test::error_of([&] { read(written(many)); }), HasSubstr("has more than 100000 files"));
  ArchivedFiles deep;
  const std::string levels = "/b/c/d/e/f/g/h/i/j/k";
  for (int i = 0; i < 30'000; ++i) deep.emplace(std::to_string(i) + levels, "");
  EXPECT_THAT(test::error_of([&] { read(written(deep)); }), HasSubstr("or too many folders"));
}

TEST_F(Archive, RefusesEveryChangedByteOfItsFrame) {
  const std::string good = unzipped(written({{"a", "xyz"}}));
  for (std::size_t at = 0; at < good.size(); ++at) {
    if (at >= 512 && at < 515) continue;  // the content
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_NE(refusal(bad), "accepted") << "byte " << at;
  }
  EXPECT_THAT(refusal(good + std::string(512, '\0')), HasSubstr("behind its last file"));
  const fs::path file = written({{"a", "xyz"}});
  const std::string bytes = test::text_of(file);
  folder_.write("shorter.tar.gz", bytes.substr(0, bytes.size() - 1));
  EXPECT_THROW(read(folder_.path() / "shorter.tar.gz"), Error);
}

TEST(Sha256, GivesTheHashesOfTheStandard) {
  // FIPS 180-4 examples; coreutils prints the same.
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_of(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace palpate
