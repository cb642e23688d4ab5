#include "apriltrack/tags/tag_family.h"

#include <apriltag/apriltag.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "native_family.h"

namespace apriltrack {
namespace {

/// Published with the families (AprilTag 3.3's sources and pictures); tag36h11b2 is 36h11 with one more ring.
struct Published {
  const char* name;
  int num_codes;
  int width_at_border;
  int total_width;
  bool has_reversed_border;
  int max_corrected_bits;
  int min_hamming_distance;
};

void PrintTo(const Published& published, std::ostream* out) {
  *out << published.name;
}

constexpr Published kPublished[] = {
    {"tag16h5", 30, 6, 8, false, 2, 5},
    {"tag25h9", 35, 7, 9, false, 2, 9},
    {"tag36h10", 2320, 8, 10, false, 2, 10},
    {"tag36h11", 587, 8, 10, false, 2, 11},
    {"tag36h11b2", 587, 10, 12, false, 2, 11},
    {"tagCircle21h7", 38, 5, 9, true, 2, 7},
    {"tagCircle49h12", 65535, 5, 11, true, 1, 12},
    {"tagCustom48h12", 42211, 6, 10, true, 1, 12},
    {"tagStandard41h12", 2115, 5, 9, true, 2, 12},
    {"tagStandard52h13", 48714, 6, 10, true, 1, 13},
};

/// '#' black, '.' white, '?' not printed; rows from the top.
std::vector<std::string> drawing(const TagPattern& pattern) {
  std::vector<std::string> rows;
  for (int y = 0; y < pattern.cells().height(); ++y) {
    rows.emplace_back();
    for (int x = 0; x < pattern.cells().width(); ++x) {
      const float cell = pattern.cells()(x, y);
      rows.back() += std::isnan(cell) ? '?' : cell == 0.0F ? '#' : cell == 1.0F ? '.' : '!';
    }
  }
  return rows;
}

std::vector<std::string> quarter_turn(const std::vector<std::string>& rows) {
  auto turned = rows;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows.size(); ++x) turned[x][rows.size() - 1 - y] = rows[y][x];
  }
  return turned;
}

int hamming_distance(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  int distance = 0;
  for (std::size_t y = 0; y < a.size(); ++y) {
    for (std::size_t x = 0; x < a.size(); ++x) distance += a[y][x] != b[y][x];
  }
  return distance;
}

class EveryFamily : public ::testing::TestWithParam<Published> {
 protected:
  const Published& published() const { return GetParam(); }
  const TagFamily& family() const { return TagFamily::get(published().name); }

  /// At most `count` ids, spread over the family, first and last among them.
  std::vector<int> sample_ids(int count) const {
    std::set<int> ids;
    for (int i = 0; i < count; ++i) {
      ids.insert(static_cast<int>(static_cast<long long>(i) * (family().num_codes() - 1) / (count - 1)));
    }
    return {ids.begin(), ids.end()};
  }
};

TEST_P(EveryFamily, HasThePublishedFigures) {
  EXPECT_EQ(family().name(), published().name);
  EXPECT_EQ(family().num_codes(), published().num_codes);
  EXPECT_EQ(family().width_at_border(), published().width_at_border);
  EXPECT_EQ(family().total_width(), published().total_width);
  EXPECT_EQ(family().has_reversed_border(), published().has_reversed_border);
  EXPECT_EQ(family().max_corrected_bits(), published().max_corrected_bits);
}

TEST_P(EveryFamily, PrintsEveryIdAsTheLibraryDoes) {
  const NativeFamily native = make_native_family(published().name);
  for (int id = 0; id < family().num_codes(); ++id) {
    const TagPattern pattern = family().pattern(id);
    const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> picture(
        apriltag_to_image(native.get(), static_cast<uint32_t>(id)), image_u8_destroy);
    ASSERT_EQ(pattern.cells().width(), picture->width);
    ASSERT_EQ(pattern.cells().height(), picture->height);
    for (int y = 0; y < picture->height; ++y) {
      for (int x = 0; x < picture->width; ++x) {
        // The library leaves black what the family does not print.
        const float cell = pattern.cells()(x, y);
        ASSERT_EQ(std::isnan(cell) ? 0 : static_cast<int>(255 * cell), picture->buf[y * picture->stride + x])
            << "id " << id << " column " << x << " row " << y;
      }
    }
  }
}

TEST_P(EveryFamily, HasBlackAndWhiteRingsRoundTheDetectedSquare) {
  const int margin = (published().total_width - published().width_at_border) / 2;
  const float inside = published().has_reversed_border ? 1.0F : 0.0F;
  for (const int id : sample_ids(50)) {
    const TagPattern pattern = family().pattern(id);
    const int first = margin;
    const int last = published().total_width - 1 - margin;
    for (int i = first; i <= last; ++i) {
      for (const auto& [x, y] : {std::pair(i, first), {i, last}, {first, i}, {last, i}}) {
        ASSERT_EQ(pattern.cells()(x, y), inside) << "id " << id << " column " << x << " row " << y;
      }
    }
    for (int i = first - 1; i <= last + 1; ++i) {
      for (const auto& [x, y] : {std::pair(i, first - 1), {i, last + 1}, {first - 1, i}, {last + 1, i}}) {
        ASSERT_EQ(pattern.cells()(x, y), 1.0F - inside) << "id " << id << " column " << x << " row " << y;
      }
    }
  }
}

TEST_P(EveryFamily, LeavesUnprintedOnlyWhatTheFamilyLeavesOut) {
  // Cells without a bit or a ring: all cells - bits - 2 rings; none in families of the plain kind.
  const std::string name = published().name;
  const int expected = name == "tagCircle21h7"    ? 81 - 21 - 16 - 24
                       : name == "tagCircle49h12" ? 121 - 49 - 16 - 24
                       : name == "tagCustom48h12" ? 100 - 48 - 20 - 28
                                                  : 0;
  int unprinted = 0;
  for (const std::string& row : drawing(family().pattern(0))) {
    unprinted += static_cast<int>(std::count(row.begin(), row.end(), '?'));
  }
  EXPECT_EQ(unprinted, expected);
}

TEST_P(EveryFamily, KeepsItsHammingDistanceInEveryRotation) {
  std::vector<std::vector<std::string>> upright;
  for (const int id : sample_ids(160)) upright.push_back(drawing(family().pattern(id)));
  int smallest = 1000;
  int compared = 0;
  for (std::size_t i = 0; i < upright.size(); ++i) {
    auto turned = upright[i];
    for (int turn = 0; turn < 4; ++turn, turned = quarter_turn(turned)) {
      for (std::size_t k = 0; k < upright.size(); ++k) {
        if (k == i && turn == 0) continue;
        smallest = std::min(smallest, hamming_distance(turned, upright[k]));
        ++compared;
      }
    }
  }
  EXPECT_GE(smallest, published().min_hamming_distance);
  EXPECT_GE(compared, 4 * 30 * 30 - 30);
}

TEST_P(EveryFamily, BrightnessIsThatOfTheCellUnderThePoint) {
  const TagPattern pattern = family().pattern(family().num_codes() - 1);
  const int n = published().total_width;
  EXPECT_DOUBLE_EQ(pattern.cell_size(), 2.0 / published().width_at_border);
  EXPECT_DOUBLE_EQ(pattern.half_extent(), static_cast<double>(n) / published().width_at_border);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const float cell = pattern.cells()(x, y);
      const double expected = std::isnan(cell) ? 1.0 : cell;
      for (const double du : {0.01, 0.5, 0.99}) {
        const double u = (x + du) * 2.0 / published().width_at_border - pattern.half_extent();
        const double v = (y + 1.0 - du) * 2.0 / published().width_at_border - pattern.half_extent();
        ASSERT_EQ(pattern.brightness(u, v), expected) << "column " << x << " row " << y;
      }
    }
  }
  for (const double beyond : {pattern.half_extent() + 1e-9, 3.0, 1e300, HUGE_VAL, std::nan("")}) {
    EXPECT_EQ(pattern.brightness(beyond, 0.0), 1.0);
    EXPECT_EQ(pattern.brightness(0.0, -beyond), 1.0);
  }
}

TEST_P(EveryFamily, IsReadUprightByTheLibrarysDetector) {
  // A picture with u right and v down in the image; the detected square spans [-1, 1] x [-1, 1].
  constexpr int kWidth = 240;
  constexpr double kCentre = 120.0;
  constexpr double kHalfTag = 50.0;
  // No corrected bits: a table of a few MB even for the largest families.
  const NativeFamily native = make_native_family(published().name);
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  apriltag_detector_add_family_bits(detector.get(), native.get(), 0);
  detector->quad_decimate = 1.0F;
  for (const int id : {0, family().num_codes() / 2, family().num_codes() - 1}) {
    const TagPattern pattern = family().pattern(id);
    const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(image_u8_create(kWidth, kWidth),
                                                                   image_u8_destroy);
    for (int y = 0; y < kWidth; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double light =
            pattern.brightness((x + 0.5 - kCentre) / kHalfTag, (y + 0.5 - kCentre) / kHalfTag);
        image->buf[y * image->stride + x] = static_cast<std::uint8_t>(30 + 200 * light);
      }
    }
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(
        apriltag_detector_detect(detector.get(), image.get()), apriltag_detections_destroy);
    ASSERT_EQ(zarray_size(found.get()), 1) << "id " << id;
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), 0, &detection);
    EXPECT_EQ(detection->id, id);
    const double u[] = {-1.0, 1.0, 1.0, -1.0};
    const double v[] = {1.0, 1.0, -1.0, -1.0};
    for (int corner = 0; corner < 4; ++corner) {
      // Half a pixel of convention between library versions, and its own corner noise.
      EXPECT_NEAR(detection->p[corner][0], kCentre + kHalfTag * u[corner], 1.0)
          << "id " << id << " corner " << corner;
      EXPECT_NEAR(detection->p[corner][1], kCentre + kHalfTag * v[corner], 1.0)
          << "id " << id << " corner " << corner;
    }
  }
}

TEST_P(EveryFamily, RefusesIdsItDoesNotHave) {
  EXPECT_THROW(family().pattern(-1), MisuseError);
  EXPECT_THROW(family().pattern(family().num_codes()), MisuseError);
}

INSTANTIATE_TEST_SUITE_P(TagFamily, EveryFamily, ::testing::ValuesIn(kPublished),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(TagFamily, TestsCoverEveryName) {
  std::set<std::string_view> tested;
  for (const Published& published : kPublished) tested.insert(published.name);
  const auto names = TagFamily::names();
  EXPECT_EQ(tested, std::set<std::string_view>(names.begin(), names.end()));
}

TEST(TagFamily, PrintsTheCodesThatKalibrPublishes) {
  // kalibr_create_target_pdf lists the same 36h11 codes row by row from the top, most significant bit first.
  const std::uint64_t codes[] = {0xd5d628584, 0xd97f18b49, 0xdd280910e, 0xe479e9c98, 0xebcbca822};
  for (const auto& [name, first] : {std::pair("tag36h11", 2), {"tag36h11b2", 3}}) {
    for (int id = 0; id < 5; ++id) {
      const TagPattern pattern = TagFamily::get(name).pattern(id);
      std::uint64_t code = 0;
      for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 6; ++x) code = 2 * code + (pattern.cells()(first + x, first + y) == 1.0F);
      }
      EXPECT_EQ(code, codes[id]) << name << " id " << id;
    }
  }
}

TEST(TagFamily, PrintsTag36h11Id0AsOnPaper) {
  const std::vector<std::string> upright = {"..........", ".########.", ".#..#.#.#.", ".##...#.#.",
                                            ".##..####.", ".#.#.####.", ".##.#..##.", ".####.###.",
                                            ".########.", ".........."};
  EXPECT_EQ(drawing(TagFamily::get("tag36h11").pattern(0)), upright);
}

TEST(TagFamily, NamesTheKnownFamiliesWhenAskedForAnother) {
  for (const char* name : {"tag36h9", "", "TAG36H11", "tag36h11 "}) {
    EXPECT_FALSE(TagFamily::is_known(name));
    try {
      TagFamily::get(name);
      FAIL() << "no complaint about '" << name << "'";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      const std::string message = error.what();
      EXPECT_NE(message.find(std::string("'") + name + "'"), std::string::npos) << message;
      for (const std::string_view known : TagFamily::names())
        EXPECT_NE(message.find(known), std::string::npos);
    }
    EXPECT_THROW(make_native_family(name), Error);
  }
}

TEST(TagFamily, IsBuiltOnceForThreadsThatAskTogether) {
  constexpr int kThreads = 4;
  std::vector<std::vector<const TagFamily*>> seen(kThreads);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < kThreads; ++i) {
      threads.emplace_back([&seen, i] {
        for (const std::string_view name : TagFamily::names()) seen[i].push_back(&TagFamily::get(name));
      });
    }
  }
  for (int i = 0; i < kThreads; ++i) EXPECT_EQ(seen[i], seen[0]);
  EXPECT_EQ(std::set<const TagFamily*>(seen[0].begin(), seen[0].end()).size(), TagFamily::names().size());
}

TEST(NativeFamily, IsAnObjectOfItsOwnForEveryCaller) {
  const NativeFamily a = make_native_family("tag36h11b2");
  const NativeFamily b = make_native_family("tag36h11b2");
  EXPECT_NE(a.get(), b.get());
  EXPECT_STREQ(a->name, "tag36h11b2");
  EXPECT_EQ(a->width_at_border, 10);
  EXPECT_EQ(make_native_family("tag36h11")->width_at_border, 8) << "36h11 itself must stay as it is";
}

}  // namespace
}  // namespace apriltrack
