#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/quoted_text.h"
#include "apriltrack/io/yaml_reader.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;

std::size_t num_files(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, WritesAndReplaces) {
  const auto path = test::temporary_folder() / "out.txt";
  const std::string bytes("a\0b\n\xff", 5);
  write_file_atomically(path, "first");
  write_file_atomically(path, bytes);
  EXPECT_EQ(read_file(path), bytes);
  EXPECT_EQ(num_files(path.parent_path()), 1U) << "nothing is left aside";
}

TEST(AtomicFile, KeepsWhatIsThereWhenWritingFails) {
  const auto path = test::temporary_folder() / "taken";
  fs::create_directories(path / "inside");  // a folder that holds something cannot be replaced by a file
  try {
    write_file_atomically(path, "text");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_THAT(error.what(), ::testing::HasSubstr(path.string()));
  }
  EXPECT_TRUE(fs::is_directory(path / "inside"));
  EXPECT_EQ(num_files(path.parent_path()), 1U) << "nothing is left aside";
}

TEST(AtomicFile, MissingFolderIsAnIoError) {
  try {
    write_file_atomically(test::temporary_folder() / "missing" / "out.txt", "text");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

TEST(AtomicFile, KeepsALinkAndReplacesWhatItNames) {
  const auto folder = test::temporary_folder();
  fs::create_directories(folder / "far");
  write_file_atomically(folder / "far" / "file", "old");
  fs::create_symlink("file", folder / "far" / "near");
  fs::create_symlink("far/near", folder / "link");  // relative to the link's own folder
  write_file_atomically(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_TRUE(fs::is_symlink(folder / "far" / "near"));
  EXPECT_EQ(read_file(folder / "far" / "file"), "new");
  EXPECT_EQ(num_files(folder / "far"), 2U) << "nothing is left aside";
}

TEST(AtomicFile, MakesTheFileThatADanglingLinkNames) {
  const auto folder = test::temporary_folder();
  fs::create_symlink(folder / "later", folder / "link");
  write_file_atomically(folder / "link", "text");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "later"), "text");
}

TEST(AtomicFile, LinkToItselfIsAnIoError) {
  const auto link = test::temporary_folder() / "loop";
  fs::create_symlink("loop", link);
  try {
    write_file_atomically(link, "text");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("symbolic links"));
  }
  EXPECT_TRUE(fs::is_symlink(link));
}

TEST(AtomicFile, WritesIntoAFifo) {
  const auto fifo = test::temporary_folder() / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);  // so that the writer need not wait
  ASSERT_GE(reader, 0);
  write_file_atomically(fifo, "text");
  char bytes[16] = {};
  const ssize_t count = ::read(reader, bytes, sizeof bytes);
  ::close(reader);
  ASSERT_EQ(count, 4);
  EXPECT_EQ(std::string(bytes, 4), "text");
  EXPECT_TRUE(fs::is_fifo(fifo));
}

// Through links in a folder of our own: a mistake replaces the link, not the machine's device.
TEST(AtomicFile, WritesIntoADevice) {
  const auto folder = test::temporary_folder();
  fs::create_symlink("/dev/null", folder / "null");
  fs::create_symlink("/dev/full", folder / "full");
  write_file_atomically(folder / "null", "text");
  EXPECT_TRUE(fs::is_symlink(folder / "null"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  try {
    write_file_atomically(folder / "full", "text");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("No space"));
  }
  EXPECT_EQ(num_files(folder), 2U) << "nothing is left aside";
}

TEST(AtomicFile, AddsToAnOpenDescriptor) {
  const auto folder = test::temporary_folder();
  const int fd = ::open((folder / "log").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(::write(fd, "before ", 7), 7);
  write_file_atomically("/dev/fd/" + std::to_string(fd), "after");
  struct stat held {};
  EXPECT_EQ(::fstat(fd, &held), 0);
  ::close(fd);
  EXPECT_EQ(held.st_nlink, 1U) << "the open file was replaced";
  EXPECT_EQ(read_file(folder / "log"), "before after");
}

TEST(AtomicFile, KeepsTheModeOfAnExistingFile) {
  const auto path = test::temporary_folder() / "out.txt";
  for (const Durability durability : {Durability::kOnDisk, Durability::kComplete}) {
    for (const auto mode : {fs::perms{0600}, fs::perms{0664}, fs::perms{0755}}) {
      write_file_atomically(path, "first", durability);
      fs::permissions(path, mode);
      write_file_atomically(path, "second", durability);
      EXPECT_EQ(read_file(path), "second");
      EXPECT_EQ(fs::status(path).permissions(), mode);
    }
  }
}

TEST(Numbers, ReadWholeTextsOnly) {
  EXPECT_EQ(parse_double("-1.5e3"), -1500.0);
  EXPECT_EQ(parse_double("+2"), 2.0);
  EXPECT_TRUE(std::isnan(*parse_double("nan")));
  for (const char* text : {"", "1,5", "1.5 ", " 1", "1.5x", "+-1", "0x10", "--1"})
    EXPECT_FALSE(parse_double(text)) << text;
  EXPECT_EQ(parse_integer("-9223372036854775808"), std::numeric_limits<long long>::min());
  for (const char* text : {"", "1.0", "9223372036854775808", "1e3", "0x1"})
    EXPECT_FALSE(parse_integer(text)) << text;
}

TEST(Numbers, DecimalPointMovesWithoutRounding) {
  EXPECT_EQ(shift_decimal(165.1, -3), 0.1651);  // 165.1 / 1000 may be another double
  EXPECT_EQ(shift_decimal(0.1651, 3), 165.1);
  EXPECT_EQ(shift_decimal(-1e-5, 3), -0.01);
  EXPECT_EQ(shift_decimal(1.5e300, -3), 1.5e297);
  EXPECT_EQ(shift_decimal(0.0, 3), 0.0);
  for (int i = 1; i < 2000; ++i) {  // what is written with up to fifteen digits comes back
    const std::string digits = std::to_string(123456789012345LL - 54321098765LL * i);
    const double value = *parse_double(digits + "e-" + std::to_string(i % 25));
    EXPECT_EQ(shift_decimal(value, 3), *parse_double(digits + "e" + std::to_string(3 - i % 25))) << digits;
    EXPECT_EQ(shift_decimal(shift_decimal(value, 3), -3), value) << digits;
  }
}

TEST(QuotedText, IsWhatJsonAndYamlRead) {
  EXPECT_EQ(quoted_text("a \"b\" \\ c\n\x01"), "\"a \\\"b\\\" \\\\ c\\u000A\\u0001\"");
  const std::string odd = "tab\t, quote \", backslash \\, bell \a, caf\xC3\xA9";
  EXPECT_EQ(YamlNode::read_text(quoted_text(odd), "x").as_string(), odd);
  EXPECT_EQ(YamlNode::read_json_text("[" + quoted_text(odd) + "]", "x").items()[0].as_string(), odd);
}

TEST(Numbers, ExactTextReadsBack) {
  for (const double value :
       {0.1, 1.0 / 3.0, -1e-310, 1.7976931348623157e308, 123456789.123456789, -0.0, 5e-324}) {
    EXPECT_EQ(parse_double(format_exact(value)), value);
  }
  EXPECT_EQ(format_exact(0.1), "0.1");
}

}  // namespace
}  // namespace apriltrack
