#pragma once

#include <string>
#include <utility>
#include <vector>

#include "console.h"

namespace apriltrack::app {

/// What a run warns of: heard at once, and kept for its summary.
class Warnings {
 public:
  explicit Warnings(const Console& console) : console_(console) {}

  void add(std::string text) {
    console_.warning(text);
    texts_.push_back(std::move(text));
  }
  const std::vector<std::string>& texts() const { return texts_; }

 private:
  const Console& console_;
  std::vector<std::string> texts_;
};

}  // namespace apriltrack::app
