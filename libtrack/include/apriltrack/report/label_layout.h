#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace apriltrack {

/// Finds places for labels beside points of a picture, so that few of them cover each other. All in the
/// picture's units, y down.
class LabelLayout {
 public:
  /// Of a picture of this size. letter_size: height of the letters.
  LabelLayout(double width, double height, double letter_size);

  /// No label is to cover the square of half side `radius` around `center`.
  void keep_clear(const Eigen::Vector2d& center, double radius);
  /// Returns the middle of the text's base line: beside `point`, towards `direction` if there is room.
  Eigen::Vector2d place(const Eigen::Vector2d& point, const Eigen::Vector2d& direction,
                        const std::string& text);

 private:
  struct Box {
    Eigen::Vector2d low, high;
  };
  double overlap(const Box& box) const;

  Box paper_;
  double letter_size_;
  std::vector<Box> taken_;
};

/// Moves points that are closer to each other than `distance` apart, within the bounds `low` to `high`.
void push_apart(std::vector<Eigen::Vector2d>& points, double distance, const Eigen::Vector2d& low,
                const Eigen::Vector2d& high);

}  // namespace apriltrack
