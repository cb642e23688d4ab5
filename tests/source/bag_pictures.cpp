#include "bag_pictures.h"

#include "support/shared_data.h"

namespace apriltrack::test {
namespace fs = std::filesystem;

std::string bag_fixture(const std::string& name) {
  return source_path("tests/bag/data/" + name).string();
}

ImageFields picture_of(const std::string& encoding, const std::string& pattern, const std::string& second) {
  ImageFields fields{.stamp_ns = kSecond, .width = kWide, .height = kHigh, .encoding = encoding};
  constexpr int kPadding = 5;
  std::string rows[2];
  const bool is_per_pixel = second.empty();
  for (int x = 0; x < kWide / (is_per_pixel ? 1 : 2); ++x) {
    rows[0] += pattern;
    rows[1] += is_per_pixel ? pattern : second;
  }
  fields.step = static_cast<int>(rows[0].size()) + kPadding;
  for (int y = 0; y < kHigh; ++y) fields.data += rows[y % 2] + std::string(kPadding, '\x77');
  return fields;
}

fs::path bag_of(const std::vector<std::string>& messages, const std::string& type, Wire wire) {
  const fs::path path = temporary_folder() / "any.mcap";
  std::vector<TestMessage> all;
  for (const std::string& message : messages)
    all.push_back({"/camera/image", type, kSecond * static_cast<std::int64_t>(all.size() + 1), message});
  write_mcap(path, wire, all);
  return path;
}

TestMessage small_picture(const std::string& topic, std::int64_t stamp_ns, char value) {
  ImageFields fields = picture_of("mono8", std::string(1, value));
  fields.stamp_ns = stamp_ns;
  return {topic, "sensor_msgs/Image", stamp_ns + 1000, image_message(Wire::kCdr, fields)};
}

}  // namespace apriltrack::test
