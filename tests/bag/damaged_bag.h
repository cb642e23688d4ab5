#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "recording.h"

namespace apriltrack::test {

/// What another reader says of a chunk (make_fixtures.py): its bytes, and when its messages were logged.
struct KnownChunk {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::vector<std::int64_t> log_times_ns;
};

/// Of a fixture; formats with chunks.
std::vector<KnownChunk> known_chunks(const std::string& name);

/// Of formats without chunks, each message is its own: where its payload is in the file, and room for the
/// record before it.
std::vector<KnownChunk> known_messages(const std::string& bytes);

/// What a reader makes of damaged bytes.
struct Outcome {
  bool is_refused = false;
  std::vector<Given> given;
  std::string damage;
};

Outcome read_damaged(const std::string& bytes);

/// Log times of the messages that were given as they were recorded, each once. Their topics' names are not
/// looked at, which no checksum of ROS 1 guards; no two messages were logged at one time.
std::set<std::int64_t> right_ones(const Outcome& outcome);

/// Messages that are neither right nor said to be bad.
std::size_t num_wrong(const Outcome& outcome);

/// Messages of the chunks that `is_whole` holds of must all be given.
template <class IsWhole>
void expect_whole_chunks(const std::vector<KnownChunk>& chunks, const Outcome& outcome,
                         const IsWhole& is_whole, std::size_t& num_checked) {
  const std::set<std::int64_t> right = right_ones(outcome);
  for (const KnownChunk& chunk : chunks) {
    if (!is_whole(chunk)) continue;
    for (const std::int64_t time_ns : chunk.log_times_ns) {
      EXPECT_TRUE(right.contains(time_ns))
          << "lost: " << time_ns << " of the chunk at " << chunk.begin << "; told: " << outcome.damage;
      ++num_checked;
    }
  }
}

}  // namespace apriltrack::test
