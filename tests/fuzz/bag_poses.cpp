// Poses of bags: of the only topic, and of each by its name.

#include "apriltrack/source/bag_poses.h"

#include <algorithm>

#include "apriltrack/bag/bag_reader.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  std::vector<apriltrack::BagTopic> topics;
  if (!fuzz::reads([&] { topics = apriltrack::open_bag(path)->topics(); })) return 0;
  topics.resize(std::min<std::size_t>(topics.size(), 8));
  fuzz::reads([&] { apriltrack::read_bag_poses(path.string()); });
  fuzz::reads([&] { apriltrack::read_bag_poses(path.string(), {.transform = "camera:base"}); });
  for (const apriltrack::BagTopic& topic : topics)
    fuzz::reads([&] { apriltrack::read_bag_poses(path.string(), {.topic = topic.name}); });
  return 0;
}
