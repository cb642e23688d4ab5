#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack::test {

// The recording that all files of tests/bag/data hold, written by other projects' programs
// (make_fixtures.py):
//
//   /camera/image_raw    8 pictures k = 0..7 of 16 x 12 bytes, mono8, rows 20 bytes apart (the rest is 0xee),
//                        pixel (7 x + 13 y + 31 k) mod 256; header.stamp 1700000000.123456789 s + k 100 ms,
//                        logged 15 + k mod 3 ms later
//   /camera/camera_info  with pictures 0 and 5, logged 1 us after them
//   /notes               "note k" with k = 0, 3, 6, logged 2 us after the picture
//   /gyro                40 vectors (i, 0.5, -0.25), i = 0..39, logged 1 ms after the first stamp + i 20 ms
//
// It is written picture by picture, each with its five vectors behind it, so that the order in the file is
// not that of log time.

inline constexpr int kFrames = 8;
inline constexpr int kWidth = 16;
inline constexpr int kHeight = 12;
inline constexpr int kStep = 20;
inline constexpr std::int64_t kFirstStamp_ns = 1'700'000'000'123'456'789;

struct Expected {
  std::string topic;
  std::int64_t log_time_ns = 0;
  std::string payload;  ///< Bytes that the message must have.
  int number = 0;       ///< Of its topic.
};

/// In the order of log time.
std::vector<Expected> expected_messages();

std::int64_t stamp_ns(int frame);
std::string picture_bytes(int frame);

/// A message with its bytes, for later.
struct Given {
  std::string topic;
  std::int64_t log_time_ns = 0;
  std::string bytes;
  std::string error;
};

/// All messages of the topics of these names; all topics where there are none.
std::vector<Given> read_all(BagReader& reader, const std::vector<std::string>& topics = {});

/// Whether it is the very message.
bool is_same(const Given& given, const Expected& expected);

/// The same but for its topic.
bool has_payload(const Given& given, const Expected& expected);

/// Of tests/bag/data.
std::string fixture(const std::string& name);
std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

}  // namespace apriltrack::test
