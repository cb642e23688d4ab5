#include "apriltrack/photometric/pattern_textures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "allocation_limit.h"

namespace apriltrack {
namespace {

std::vector<TagPattern> first_patterns(int count) {
  std::vector<TagPattern> patterns;
  for (int id = 0; id < count; ++id) patterns.push_back(TagFamily::get("tag36h11").pattern(id));
  return patterns;
}

TEST(PatternTextures, AreSharedInQuartersOfAnOctaveOfTheSigma) {
  PatternTextures textures(first_patterns(2));
  const double cell = textures.pattern(0).cell_size();
  const auto first = textures.blurred(0, 0.5 * cell, 0.5 * cell);
  EXPECT_EQ(first, textures.blurred(0, 0.505 * cell, 0.495 * cell));
  EXPECT_NE(first, textures.blurred(0, 0.7 * cell, 0.5 * cell));
  EXPECT_NE(first, textures.blurred(1, 0.5 * cell, 0.5 * cell));
  // As wide as it gets, whatever is asked for: a tag seen on edge asks for anything.
  EXPECT_EQ(textures.blurred(0, 1e6, 1e6), textures.blurred(0, 3.0 * cell, 3.0 * cell));
  EXPECT_EQ(textures.blurred(0, 0.0, 0.0), textures.blurred(0, 1e-9, 1e-9));
}

TEST(PatternTextures, OfAllTagsTogetherStayWithinTheirMemoryAndTheLatestStay) {
  constexpr std::size_t kMaxBytes = 1 << 20;
  constexpr int kNumTags = 40;
  PatternTextures textures(first_patterns(kNumTags), kMaxBytes);
  const double cell = textures.pattern(0).cell_size();
  std::vector<std::weak_ptr<const PatternTexture>> seen;
  std::size_t most_bytes = 0, all_bytes = 0;
  for (int id = 0; id < kNumTags; ++id) {
    for (int k = 0; k < 6; ++k) {
      const auto texture =
          textures.blurred(static_cast<std::size_t>(id), 0.2 * std::exp2(0.3 * k) * cell, 0.3 * cell);
      seen.push_back(texture);
      all_bytes += texture->num_bytes();
      most_bytes = std::max(most_bytes, textures.num_bytes());
      EXPECT_FALSE(seen.back().expired());
    }
  }
  EXPECT_GT(all_bytes, 3 * kMaxBytes);
  EXPECT_LE(most_bytes, kMaxBytes);
  std::size_t alive_bytes = 0;
  for (const auto& texture : seen) alive_bytes += texture.expired() ? 0 : texture.lock()->num_bytes();
  EXPECT_EQ(alive_bytes, textures.num_bytes());
  EXPECT_GT(alive_bytes, kMaxBytes / 2);
  EXPECT_TRUE(seen.front().expired());
  EXPECT_FALSE(seen.back().expired());
}

TEST(PatternTextures, ForgetAPictureThatMemoryHadNoRoomFor) {
  constexpr std::size_t kMaxBytes = 1 << 19;
  PatternTextures textures(first_patterns(20), kMaxBytes);
  const double cell = textures.pattern(0).cell_size();
  {
    const test::AllocationLimit limit(25'000);  // less than any picture's texels take
    EXPECT_THROW(textures.blurred(0, 0.5 * cell, 0.5 * cell), std::bad_alloc);
  }
  EXPECT_EQ(textures.num_bytes(), 0U);
  // The oldest go several times over, and what failed is among them.
  for (std::size_t id = 1; id < 20; ++id) {
    textures.blurred(id, 0.5 * cell, 0.5 * cell);
    EXPECT_LE(textures.num_bytes(), kMaxBytes);
  }
  const auto now = textures.blurred(0, 0.5 * cell, 0.5 * cell);
  ASSERT_NE(now, nullptr);
  EXPECT_EQ(now, textures.blurred(0, 0.5 * cell, 0.5 * cell));
}

TEST(PatternTextures, TakeTheMemoryThatTheirHeaderTells) {
  for (const std::string_view family : TagFamily::names()) {
    PatternTextures textures({TagFamily::get(family).pattern(0)});
    const double cell = textures.pattern(0).cell_size();
    const auto num_bytes = [&](double sigma_in_cells) {
      return textures.blurred(0, sigma_in_cells * cell, sigma_in_cells * cell)->num_bytes();
    };
    const std::size_t sharp = num_bytes(0.0), middling = num_bytes(0.25), wide = num_bytes(3.0);
    EXPECT_GE(sharp, 600'000U) << family;
    EXPECT_LE(sharp, 1'400'000U) << family;
    EXPECT_GE(middling, 22'500U) << family;
    EXPECT_LE(middling, 50'000U) << family;
    EXPECT_GE(wide, 160'000U) << family;
    EXPECT_LE(wide, 220'000U) << family;
  }
}

}  // namespace
}  // namespace apriltrack
