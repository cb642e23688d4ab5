#pragma once

#include <array>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "tag_sights.h"

namespace apriltrack::app {

/// How often each tag was what, over a run.
class TagTally {
 public:
  struct Counts {
    std::array<std::size_t, 8> frames{};  ///< By SightStatus.
    /// Of the frames whose poses rest on it; none where there are none.
    std::optional<Timestamp> first_used, last_used;
    std::vector<double> residuals_px;  ///< Of the frames in which it was read and has one (TagSight).

    std::size_t of(SightStatus status) const { return frames[static_cast<std::size_t>(status)]; }
    /// None where it was never read in a frame with a pose.
    std::optional<double> median_residual_px() const;
    std::size_t used() const { return of(SightStatus::kDetected) + of(SightStatus::kTracked); }
  };

  void add(Timestamp timestamp, std::span<const TagSight> sights);
  const std::map<TagKey, Counts>& counts() const { return counts_; }
  /// A list, each tag with its counts (docs/file_formats.md).
  nlohmann::json json() const;

 private:
  std::map<TagKey, Counts> counts_;
};

}  // namespace apriltrack::app
