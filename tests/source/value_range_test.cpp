// 16-bit files that hold fewer bits, and temperatures.

#include "value_range.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/source/image_file.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kSide = 64;

/// From `low` to `high`, each row a ramp.
cv::Mat ramp(int low, int high) {
  cv::Mat picture(kSide, kSide, CV_16UC1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      picture.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(low + (high - low) * x / (kSide - 1));
  return picture;
}

ValueRange range_of(const cv::Mat& picture) {
  ValueCounts counts;
  counts.add(picture);
  return counts.range();
}

TEST(ValueRange, IsTheSensorsFullScale) {
  for (const int bits : {8, 10, 12, 14}) {
    const int white = (1 << bits) - 1;
    EXPECT_EQ(range_of(ramp(0, white)), (ValueRange{0, white})) << bits;
    EXPECT_EQ(range_of(ramp(white / 20, white * 2 / 3)), (ValueRange{0, white})) << "nothing is quite white";
  }
  EXPECT_EQ(range_of(ramp(0, 65535)), ValueRange{});
  EXPECT_EQ(range_of(ramp(0, 20000)), ValueRange{}) << "of 16 bits, a dark picture";
}

TEST(ValueRange, OfTemperaturesIsAWindowAroundThem) {
  const ValueRange range = range_of(ramp(7000, 8020));
  EXPECT_EQ(range, (ValueRange{6490, 8530}));
  EXPECT_THAT(description_of(range), HasSubstr("6490 to 8530"));
}

TEST(ValueRange, MinesNoPictureFromNoise) {
  EXPECT_EQ(range_of(ramp(8000, 8020)), (ValueRange{0, 16383}));
}

TEST(ValueRange, PassesOverDeadPixels) {
  cv::Mat picture = ramp(0, 1000);
  picture.at<std::uint16_t>(3, 3) = 65535;
  picture.at<std::uint16_t>(9, 9) = 60000;
  EXPECT_EQ(range_of(picture), (ValueRange{0, 1023}));
  cv::Mat temperatures = ramp(7000, 8020);
  temperatures.at<std::uint16_t>(3, 3) = 0;
  EXPECT_EQ(range_of(temperatures), (ValueRange{6490, 8530}));
}

TEST(ValueRange, PassesOverAThousandthOfHotAndDeadPixels) {
  constexpr int kSensorSide = 640;
  RandomStream random(7);
  const auto with_odd = [&](int low, int high, double hot, double dead) {
    cv::Mat picture(kSensorSide, kSensorSide, CV_16UC1);
    for (int y = 0; y < kSensorSide; ++y) {
      for (int x = 0; x < kSensorSide; ++x) {
        const double drawn = random.uniform();
        const int light = low + (high - low) * x / (kSensorSide - 1);
        picture.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(drawn < hot          ? 65535
                                                                     : drawn > 1.0 - dead ? 0
                                                                                          : light);
      }
    }
    return range_of(picture);
  };
  EXPECT_EQ(with_odd(0, 1000, 1e-3, 0.0), (ValueRange{0, 1023}));
  EXPECT_EQ(with_odd(0, 4000, 1e-3, 1e-3), (ValueRange{0, 4095}));
  EXPECT_EQ(with_odd(7000, 8020, 1e-3, 1e-3), (ValueRange{6490, 8530}));
}

TEST(ValueRange, KeepsASmallLamp) {
  cv::Mat picture = ramp(0, 900);
  for (int y = 20; y < 25; ++y)
    for (int x = 40; x < 45; ++x) picture.at<std::uint16_t>(y, x) = 4000;
  EXPECT_EQ(range_of(picture).white, 4095);
}

void write_deep(const fs::path& path, const cv::Mat& picture) {
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(cv::imwrite(path.string(), picture));
}

TEST(ReadImage, ScalesFewerBitsToTheWholeScale) {
  for (const char* name : {"ten.png", "ten.tiff"}) {
    const fs::path path = temporary_folder() / name;
    write_deep(path, ramp(0, 1023));
    const GrayImage image = read_image(path);
    for (int x = 0; x < kSide; ++x)
      EXPECT_EQ(image(x, 5), std::lround(ramp(0, 1023).at<std::uint16_t>(5, x) * 255.0 / 1023.0))
          << name << x;
  }
}

/// What the sources of a folder say.
struct Heard {
  std::vector<std::string> infos, warnings;
  LogSink sink() {
    return [this](LogLevel level, std::string_view text) {
      (level == LogLevel::kWarning ? warnings : infos).emplace_back(text);
    };
  }
};

TEST(ImageFolder, ScalesAllPicturesAlike) {
  const fs::path folder = temporary_folder() / "twelve";
  // The first ones would be taken for 10 bits.
  for (int i = 0; i < 12; ++i)
    write_deep(folder / (std::to_string(1'000'000'000LL * (i + 1)) + ".png"), ramp(0, i < 6 ? 900 : 4000));
  Heard heard;
  const auto frames = read_all(folder.string(), {.log = heard.sink()});
  ASSERT_EQ(frames.size(), 12U);
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_EQ(frames[i].pixels(kSide - 1, 0), std::lround((i < 6 ? 900 : 4000) * 255.0 / 4095.0)) << i;
  ASSERT_EQ(heard.infos.size(), 1U);
  EXPECT_THAT(heard.infos[0], HasSubstr("12 bits (0 to 4095)"));
  EXPECT_TRUE(heard.warnings.empty());
}

TEST(ImageFolder, TellsTheRangeToPrograms) {
  const fs::path folder = temporary_folder() / "typed";
  write_deep(folder / "deep" / "1000000000.png", ramp(0, 900));
  write_deep(folder / "warm" / "1000000000.png", ramp(7000, 8020));
  fs::create_directories(folder / "plain");
  ASSERT_TRUE(
      cv::imwrite((folder / "plain" / "1000000000.png").string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(9))));
  const auto range_in = [&](const char* name, const SourceOptions& options) {
    const auto source = open_source((folder / name).string(), options);
    EXPECT_FALSE(source->value_range()) << "nothing was read yet";
    source->next();
    return source->value_range();
  };
  EXPECT_EQ(range_in("deep", {}), (ValueRange{0, 1023}));
  EXPECT_EQ(range_in("deep", {})->bits(), 10);
  EXPECT_EQ(range_in("deep", {.bits = 12})->bits(), 12);
  EXPECT_EQ(range_in("warm", {})->bits(), std::nullopt);
  EXPECT_EQ(range_in("plain", {}), std::nullopt);
}

TEST(ImageFolder, TakesTheBitsThatItIsTold) {
  const fs::path folder = temporary_folder() / "told";
  write_deep(folder / "1000000000.png", ramp(0, 900));
  Heard heard;
  const auto frames = read_all(folder.string(), {.bits = 12, .log = heard.sink()});
  EXPECT_EQ(frames.at(0).pixels(kSide - 1, 0), std::lround(900 * 255.0 / 4095.0));
  EXPECT_TRUE(heard.infos.empty() && heard.warnings.empty());
  for (const int bits : {7, 17})
    expect_refused(folder, ErrorKind::kInvalidInput, {"--bits", "[8, 16]"}, {.bits = bits});
}

TEST(ImageFolder, SaysOnceWhereLaterPicturesLieBeyond) {
  const fs::path folder = temporary_folder() / "flash";
  for (int i = 0; i < 40; ++i)  // a flash in pictures that are not looked at beforehand
    write_deep(folder / (std::to_string(1'000'000'000LL * (i + 1)) + ".png"),
               ramp(0, i == 3 || i == 7 ? 4000 : 900));
  Heard heard;
  const auto frames = read_all(folder.string(), {.log = heard.sink()});
  EXPECT_EQ(frames.at(3).pixels(kSide - 1, 0), 255);
  ASSERT_EQ(heard.warnings.size(), 1U);
  EXPECT_THAT(heard.warnings[0], HasSubstr("4000000000.png has values from 0 to"));
  EXPECT_THAT(heard.warnings[0], HasSubstr("--bits"));
}

}  // namespace
}  // namespace apriltrack::test
