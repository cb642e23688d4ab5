#include "damaged_bag.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

std::map<std::int64_t, Expected> expected_by_time() {
  std::map<std::int64_t, Expected> all;
  for (const Expected& one : expected_messages()) all[one.log_time_ns] = one;
  return all;
}

}  // namespace

std::vector<KnownChunk> known_chunks(const std::string& name) {
  std::vector<KnownChunk> chunks;
  std::ifstream file(fixture("chunks.csv"));
  std::string line;
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    std::string of;
    KnownChunk chunk;
    words >> of >> chunk.begin >> chunk.end;
    if (of != name) continue;
    for (std::int64_t time_ns = 0; words >> time_ns;) chunk.log_times_ns.push_back(time_ns + kFirstStamp_ns);
    chunks.push_back(chunk);
  }
  return chunks;
}

std::vector<KnownChunk> known_messages(const std::string& bytes) {
  constexpr std::size_t kMostBefore = 120;
  std::vector<KnownChunk> chunks;
  for (const Expected& message : expected_messages()) {
    if (message.topic == "/camera/camera_info") continue;  // two have the same payload
    const std::size_t at = bytes.find(message.payload);
    EXPECT_NE(at, std::string::npos) << message.topic;
    chunks.push_back(
        {at - std::min(at, kMostBefore), at + message.payload.size() + 1, {message.log_time_ns}});
  }
  return chunks;
}

Outcome read_damaged(const std::string& bytes) {
  const std::string path = (temporary_folder() / "damaged").string();
  write_bytes(path, bytes);
  Outcome outcome;
  try {
    const auto reader = open_bag(path);
    outcome.given = read_all(*reader);
    outcome.damage = reader->damage();
  } catch (const Error& error) {
    outcome.is_refused = true;
    outcome.damage = error.what();
  }
  return outcome;
}

std::set<std::int64_t> right_ones(const Outcome& outcome) {
  static const auto all = expected_by_time();
  std::set<std::int64_t> times;
  for (const Given& given : outcome.given) {
    const auto expected = all.find(given.log_time_ns);
    if (expected == all.end() || !has_payload(given, expected->second)) continue;
    EXPECT_TRUE(times.insert(given.log_time_ns).second) << "given twice: " << given.log_time_ns;
  }
  return times;
}

std::size_t num_wrong(const Outcome& outcome) {
  const auto num_bad =
      std::ranges::count_if(outcome.given, [](const Given& one) { return !one.error.empty(); });
  return outcome.given.size() - right_ones(outcome).size() - static_cast<std::size_t>(num_bad);
}

}  // namespace apriltrack::test
