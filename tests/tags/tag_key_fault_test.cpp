#include "apriltrack/tags/tag_key_fault.h"

#include <gmock/gmock.h>

namespace apriltrack::test {
namespace {

TEST(TagKeyFault, IsAnUnknownFamilyOrAnIdThatItDoesNotHave) {
  EXPECT_EQ(fault_of_key({"tag36h11", 586}), std::nullopt);
  EXPECT_EQ(fault_of_key({"tag36h11", 587}), "tag36h11 has ids 0 to 586 (is 587)");
  EXPECT_EQ(fault_of_key({"tag36h11", -1}), "tag36h11 has ids 0 to 586 (is -1)");
  const auto unknown = fault_of_key({"aruco", 0});
  ASSERT_TRUE(unknown);
  EXPECT_THAT(*unknown, testing::StartsWith("unknown tag family 'aruco' (known: tag16h5, "));
}

}  // namespace
}  // namespace apriltrack::test
