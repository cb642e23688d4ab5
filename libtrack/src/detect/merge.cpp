#include "merge.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

constexpr double kSameQuad = 0.25;  // of an edge; the next square of a grid lies a whole edge away

Eigen::Vector2d centre_of(const Detection& detection) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : detection.corners_px) sum += corner;
  return sum / kNumCorners;
}

bool is_before(const Detection& a, const Detection& b) {
  const Eigen::Vector2d centre_a = centre_of(a);
  const Eigen::Vector2d centre_b = centre_of(b);
  return std::tie(a.tag, centre_a.x(), centre_a.y()) < std::tie(b.tag, centre_b.x(), centre_b.y());
}

double mean_edge(const Detection& detection) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k)
    sum += (detection.corners_px[(k + 1) % kNumCorners] - detection.corners_px[k]).norm();
  return sum / kNumCorners;
}

double largest_corner_distance(const Detection& a, const Detection& b, std::size_t turn) {
  double largest = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k)
    largest = std::max(largest, (a.corners_px[k] - b.corners_px[(k + turn) % kNumCorners]).norm());
  return largest;
}

double same_quad_limit(const Detection& a, const Detection& b) {
  return kSameQuad * std::min(mean_edge(a), mean_edge(b));
}

/// A code that chance or wrong bits let be read turned has its corners in another order: no start for this
/// one.
bool is_same_way_up(const Detection& a, const Detection& b) {
  return largest_corner_distance(a, b, 0) <= same_quad_limit(a, b);
}

}  // namespace

bool is_same_quad(const Detection& a, const Detection& b) {
  const double limit = same_quad_limit(a, b);
  for (std::size_t turn = 0; turn < kNumCorners; ++turn)
    if (largest_corner_distance(a, b, turn) <= limit) return true;
  return false;
}

std::vector<Candidate> merge_same_quads(std::vector<Candidate> candidates) {
  const auto rank = [](const Candidate& c) {
    const TagFamily& family = TagFamily::get(c.detection.tag.family);
    return std::pair(family.chance_of_reading(c.detection.hamming.value_or(0)),
                     -c.detection.decision_margin.value_or(0.0));
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
  std::vector<Candidate> kept;
  for (Candidate& candidate : candidates) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Candidate& other) {
      return is_same_quad(candidate.detection, other.detection);
    });
    if (same == kept.end()) {
      kept.push_back(std::move(candidate));
    } else if (candidate.detection.tag == same->detection.tag &&
               is_same_way_up(candidate.detection, same->detection)) {
      same->others.push_back(std::move(candidate));
    }
  }
  return kept;
}

void sort_detections(std::vector<Detection>& detections) {
  std::stable_sort(detections.begin(), detections.end(), is_before);
}

void sort_left_out(std::vector<LeftOutTag>& tags) {
  std::stable_sort(tags.begin(), tags.end(),
                   [](const LeftOutTag& a, const LeftOutTag& b) { return is_before(a.reading, b.reading); });
}

}  // namespace apriltrack
