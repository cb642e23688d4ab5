#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bag/bag_writers.h"

namespace apriltrack::test {

inline constexpr std::int64_t kSecond = 1'000'000'000;
inline constexpr int kWide = 6;
inline constexpr int kHigh = 4;

/// A file of tests/bag/data, which other projects' writers made (tests/bag/recording.h tells what is in it).
std::string bag_fixture(const std::string& name);

/// A picture of 6 x 4 pixels whose rows have five bytes more. pattern: bytes that a row repeats; of every
/// second row the second one, where there is one.
ImageFields picture_of(const std::string& encoding, const std::string& pattern,
                       const std::string& second = "");

/// An MCAP file in the test's folder, which is fresh then, with these messages on /camera/image.
std::filesystem::path bag_of(const std::vector<std::string>& messages,
                             const std::string& type = "sensor_msgs/Image", Wire wire = Wire::kCdr);

/// All pixels of this value, in CDR.
TestMessage small_picture(const std::string& topic, std::int64_t stamp_ns, char value = 'a');

}  // namespace apriltrack::test
