#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace apriltrack::app {

/// Finds places for names beside points, so that few of them cover each other.
class LabelPlaces {
 public:
  LabelPlaces(double width, double height, double letter_size);

  /// Something is drawn there.
  void keep_clear(const Eigen::Vector2d& center, double radius);
  /// Middle of the text's base line, beside `point`, towards `direction` if that can be. y down.
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

/// Moves points that are closer to each other than `distance` apart, little by little, within the bounds.
void push_apart(std::vector<Eigen::Vector2d>& points, double distance, const Eigen::Vector2d& low,
                const Eigen::Vector2d& high);

}  // namespace apriltrack::app
