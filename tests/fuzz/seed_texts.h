#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace apriltrack::fuzz {

struct SeedText {
  std::string_view target;  ///< Name of the fuzzer.
  std::string bytes;
};

/// Small files of what has no writer among ours.
std::vector<SeedText> seed_texts();

}  // namespace apriltrack::fuzz
