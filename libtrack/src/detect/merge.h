#pragma once

#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/detector.h"

namespace apriltrack {

/// A tag that was found, and every place where it was found: starts for the refinement of its corners.
struct Candidate {
  Detection detection;
  bool is_from_linear_light = false;
  /// Quads of the same tag found elsewhere, the likeliest first.
  std::vector<Candidate> others = {};
};

/// Two quads that are one square of the scene, found twice: with the corners paired in the best of the four
/// ways to turn it, none is off by more than a quarter of the lesser quad's mean edge.
bool is_same_quad(const Detection& a, const Detection& b);

/// What stays of detections found in several images or by several families: of each square the one that
/// chance reads most seldom (within a family: with fewer corrected bits), then with the higher margin, then
/// the first in the list. The same tag found elsewhere, the same way up, goes into its `others`.
std::vector<Candidate> merge_same_quads(std::vector<Candidate> candidates);

/// By family, id, then centre (x, y).
void sort_detections(std::vector<Detection>& detections);
void sort_left_out(std::vector<LeftOutTag>& tags);

}  // namespace apriltrack
