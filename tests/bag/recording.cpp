#include "recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::string doubles(const std::vector<double>& values) {
  std::string bytes(8 * values.size(), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace

std::int64_t stamp_ns(int frame) {
  return kFirstStamp_ns + frame * 100 * kMs;
}

std::string picture_bytes(int frame) {
  std::string bytes;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) bytes += static_cast<char>((7 * x + 13 * y + 31 * frame) & 255);
    bytes += std::string(kStep - kWidth, '\xee');
  }
  return bytes;
}

std::vector<Expected> expected_messages() {
  std::vector<Expected> all;
  for (int k = 0; k < kFrames; ++k) {
    const std::int64_t log_ns = stamp_ns(k) + (15 + k % 3) * kMs;
    all.push_back({"/camera/image_raw", log_ns, picture_bytes(k), k});
    if (k == 0 || k == 5)
      all.push_back(
          {"/camera/camera_info", log_ns + 1000, doubles({20.5, 0, 7.25, 0, 21.5, 5.75, 0, 0, 1}), k});
    if (k % 3 == 0) all.push_back({"/notes", log_ns + 2000, fmt::format("note {}", k), k});
  }
  for (int i = 0; i < 5 * kFrames; ++i)
    all.push_back({"/gyro", kFirstStamp_ns + i * 20 * kMs + kMs, doubles({double(i), 0.5, -0.25}), i});
  std::ranges::stable_sort(all, {}, &Expected::log_time_ns);
  return all;
}

std::vector<Given> read_all(BagReader& reader, const std::vector<std::string>& topics) {
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < reader.topics().size(); ++i)
    if (topics.empty() || std::ranges::count(topics, reader.topics()[i].name) > 0) chosen.insert(i);
  reader.choose(chosen);
  std::vector<Given> all;
  while (const auto message = reader.next())
    all.push_back({reader.topics()[message->topic].name, message->log_time.ns, std::string(message->bytes),
                   message->error});
  return all;
}

bool has_payload(const Given& given, const Expected& expected) {
  return given.error.empty() && given.log_time_ns == expected.log_time_ns &&
         given.bytes.find(expected.payload) != std::string::npos;
}

bool is_same(const Given& given, const Expected& expected) {
  return given.topic == expected.topic && has_payload(given, expected);
}

std::string fixture(const std::string& name) {
  return source_path("tests/bag/data/" + name).string();
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace apriltrack::test
