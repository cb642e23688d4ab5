#include "apriltrack/tags/tag_key.h"

#include <gtest/gtest.h>

#include <string>

namespace apriltrack {
namespace {

TEST(TagKey, IsParsedAsItIsWritten) {
  EXPECT_EQ(parse_tag_key("tag36h11/7"), (TagKey{"tag36h11", 7}));
  EXPECT_EQ(parse_tag_key("7"), (TagKey{"", 7}));
  EXPECT_EQ(parse_tag_key("0"), (TagKey{"", 0}));
  EXPECT_EQ(parse_tag_key("2147483647"), (TagKey{"", 2147483647}));
  const TagKey key{"tagStandard41h12", 2114};
  EXPECT_EQ(parse_tag_key(to_string(key)), key);
}

TEST(TagKey, IsNotParsedFromWhatNamesNoTag) {
  for (const std::string text : {"", "/", "seven", "07", "+7", "-1", "7.0", " 7", "7 ", "tag36h11/",
                                 "tag36h11/07", "tag36h11/-1", "tag36h11/7/8", "2147483648", "4294967303"})
    EXPECT_FALSE(parse_tag_key(text)) << "'" << text << "'";
}

}  // namespace
}  // namespace apriltrack
