#include "apriltrack/io/csv.h"

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

CsvTable read(const std::string& text, const std::vector<std::string>& required = {}) {
  const auto path = test::temporary_folder() / "t.csv";
  std::ofstream(path, std::ios::binary) << text;
  return CsvTable::read_file(path, required);
}

TEST(CsvTable, FindsColumnsByName) {
  const CsvTable table = read("timestamp_ns,id,x\n1403636579763555584,7,-0.5\n\n12, 8 ,1e-3\n", {"x", "id"});
  ASSERT_EQ(table.num_rows(), 2U);
  EXPECT_EQ(table.integer(0, "timestamp_ns"), 1403636579763555584LL);
  EXPECT_EQ(table.number(0, "x"), -0.5);
  EXPECT_EQ(table.integer(1, "id"), 8);
  EXPECT_EQ(table.text(1, "id"), "8");
  EXPECT_EQ(table.number(1, "x"), 0.001);
  EXPECT_TRUE(table.has_column("id"));
  EXPECT_FALSE(table.has_column("hamming"));
  EXPECT_THAT(table.where(1), ::testing::EndsWith("t.csv:4"));
}

TEST(CsvTable, ReadsEurocHeadersAndCarriageReturns) {
  const CsvTable table = read("\xEF\xBB\xBF#timestamp [ns],filename\r\n14,14.png\r\n15,\r\n");
  ASSERT_EQ(table.num_rows(), 2U);
  EXPECT_EQ(table.text(0, "filename"), "14.png");
  EXPECT_EQ(table.integer(1, "timestamp [ns]"), 15);
  EXPECT_TRUE(table.is_empty(1, "filename"));
}

TEST(CsvTable, AHeaderAloneIsATableWithoutRows) {
  EXPECT_EQ(read("a,b").num_rows(), 0U);
}

TEST(CsvTable, RefusesWrongTables) {
  EXPECT_THAT(message_of([] { read("a,b\n1,2\n1,2,3\n"); }),
              HasSubstr("t.csv:3: has 3 fields, the header has 2"));
  EXPECT_THAT(message_of([] { read("a,b\n1\n"); }), HasSubstr("t.csv:2: has 1 fields"));
  EXPECT_THAT(message_of([] { read("\na,b\n1,2\n", {"c"}); }),
              AllOf(HasSubstr("t.csv:2: the column 'c' is missing"), HasSubstr("a, b")));
  EXPECT_THAT(message_of([] { read("apriltrack_map: 1\npose: [1, 2]\n", {"t"}); }),
              AllOf(HasSubstr("t.csv:1: the column 't' is missing"), HasSubstr("apriltrack_map: 1")))
      << "of another file the first line tells";
  EXPECT_THAT(message_of([] { read("a,b,a\n"); }), HasSubstr("t.csv:1: the column 'a' stands twice"));
  EXPECT_THAT(
      message_of([] {
        read("1,cam0,0\n2,cam0,0\n", {"t", "camera", "id"});
      }),
      HasSubstr(
          "t.csv:1: the first line is no header, for it has numbers: begin with one such as t,camera,id"));
  EXPECT_THAT(message_of([] {
                read("t;camera;id\n1;cam0;0\n", {"t", "camera"});
              }),
              HasSubstr("t.csv:1: semicolons separate its columns"));
  EXPECT_THAT(message_of([] { read("", {"a", "b"}); }), AllOf(HasSubstr("is empty"), HasSubstr("a,b")));
}

TEST(CsvTable, RefusesFieldsThatAreNoNumbers) {
  const CsvTable table = read("a,b\n1,nan\n1.5,inf\nx,\n");
  EXPECT_THAT(message_of([&] { table.number(0, "b"); }),
              HasSubstr("t.csv:2: b: must be a finite number (is 'nan')"));
  EXPECT_THAT(message_of([&] { table.number(1, "b"); }),
              HasSubstr("t.csv:3: b: must be a finite number (is 'inf')"));
  EXPECT_THAT(message_of([&] { table.integer(1, "a"); }),
              HasSubstr("t.csv:3: a: must be a whole number (is '1.5')"));
  EXPECT_THAT(message_of([&] { table.number(2, "a"); }),
              HasSubstr("t.csv:4: a: must be a finite number (is 'x')"));
  EXPECT_THAT(message_of([&] { table.number(2, "b"); }), HasSubstr("(is '')"));
  EXPECT_THROW(static_cast<void>(table.text(0, "c")), MisuseError);
  EXPECT_THROW(static_cast<void>(table.text(3, "a")), MisuseError);
}

TEST(CsvTable, MissingFileIsAnIoError) {
  try {
    CsvTable::read_file(test::temporary_folder() / "nowhere.csv", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

}  // namespace
}  // namespace apriltrack
