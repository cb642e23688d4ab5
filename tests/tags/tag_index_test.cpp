#include "apriltrack/tags/tag_index.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

TEST(TagIndex, FindsEveryTagByFamilyAndId) {
  TagMap map;
  for (const char* family : {"tagStandard52h13", "tag36h11"}) {
    for (int id = 40; id >= 0; id -= 2) {
      map.tags.emplace_back();
      map.tags.back().key = {family, id};
    }
  }
  const TagIndex index(map);
  for (std::size_t i = 0; i < map.tags.size(); ++i) EXPECT_EQ(index.find(map.tags[i].key), i);
  EXPECT_EQ(index.find({"tag36h11", 1}), std::nullopt);
  EXPECT_EQ(index.find({"tag25h9", 2}), std::nullopt);
  EXPECT_EQ(TagIndex(TagMap()).find({"tag36h11", 0}), std::nullopt);
}

}  // namespace
}  // namespace apriltrack
