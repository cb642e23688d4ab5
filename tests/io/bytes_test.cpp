// What stands in files' bytes: numbers, sums, and bytes as letters.

#include <gtest/gtest.h>

#include "apriltrack/io/base64.h"
#include "apriltrack/io/byte_order.h"
#include "apriltrack/io/crc32.h"

namespace apriltrack {
namespace {

TEST(Base64, IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
  EXPECT_EQ(bytes_of_base64(""), "");
  EXPECT_EQ(bytes_of_base64("Zm8="), "fo");
  EXPECT_EQ(bytes_of_base64("Zm8"), "fo");
  EXPECT_EQ(bytes_of_base64("Zg=="), "f");
  EXPECT_EQ(bytes_of_base64("//79"), "\xFF\xFE\xFD");
  for (const char* text : {"Z", "A===", "Zm 8", "Zm8-", "Zm=8"}) EXPECT_FALSE(bytes_of_base64(text)) << text;
}

TEST(Crc32, GoesOnWhereItEnded) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926u);  // the check value of CRC-32/ISO-HDLC
  EXPECT_EQ(crc32("456789", crc32("123")), 0xCBF43926u);
  EXPECT_EQ(crc32("", crc32("123")), crc32("123"));
}

TEST(ByteOrder, NumbersOfBytesAndBack) {
  EXPECT_EQ(little_endian("\x01\x02\xFF"), 0xFF0201u);
  EXPECT_EQ(big_endian("\x01\x02\xFF"), 0x0102FFu);
  EXPECT_EQ(little_endian("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x80"), 0x80FFFFFFFFFFFFFFu);
  std::string bytes = ">";
  append_little_endian(bytes, 0xAABBCCDDu, 2);
  append_big_endian(bytes, 0xAABBCCDDu, 3);
  EXPECT_EQ(bytes, ">\xDD\xCC\xBB\xCC\xDD");
}

}  // namespace
}  // namespace apriltrack
