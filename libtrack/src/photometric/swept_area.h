#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "tag_prediction.h"

namespace apriltrack {

/// The pixels of one level that a printed square may pass during the exposure.
struct SweptArea {
  using Square = std::array<Eigen::Vector2f, 4>;

  Eigen::AlignedBox2i box;          ///< First and last; empty where there are none.
  std::array<Square, 3> squares{};  ///< Where its corners are as the shutter opens, midway, and as it closes.
};

/// level_image: of the level. Empty where the square is not in it, or a corner cannot be projected.
SweptArea swept_area(const PhotometricWorld& world, const Image<float>& level_image, const TagSight& sight,
                     const PhotometricTag& tag, int level);

/// Of each row of the area's box, the first and last pixel that the square may pass.
class SweptRows {
 public:
  /// Uses its memory again.
  void find(const SweptArea& area);

  struct Span {
    int first, last;  ///< Empty where last < first.
  };
  const Span& operator[](int y) const { return spans_[static_cast<std::size_t>(y - first_row_)]; }

 private:
  void include(const Eigen::Vector2f& from, const Eigen::Vector2f& to);

  struct Reach {
    float least, most;
  };
  int first_row_ = 0;
  std::vector<Reach> reaches_;
  std::vector<Span> spans_;
};

}  // namespace apriltrack
