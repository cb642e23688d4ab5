#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
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

TEST(Numbers, ExactTextReadsBack) {
  for (const double value :
       {0.1, 1.0 / 3.0, -1e-310, 1.7976931348623157e308, 123456789.123456789, -0.0, 5e-324}) {
    EXPECT_EQ(parse_double(format_exact(value)), value);
  }
  EXPECT_EQ(format_exact(0.1), "0.1");
}

}  // namespace
}  // namespace apriltrack
