#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack {

struct BagPart {
  std::string name;
  std::unique_ptr<BagReader> reader;
};

/// Several files as one, in the order of time.
std::unique_ptr<BagReader> joined_reader(std::vector<BagPart> parts);

}  // namespace apriltrack
