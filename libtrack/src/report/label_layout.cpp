#include "apriltrack/report/label_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace apriltrack {

LabelLayout::LabelLayout(double width, double height, double letter_size)
    : paper_{{0.0, 0.0}, {width, height}}, letter_size_(letter_size) {}

void LabelLayout::keep_clear(const Eigen::Vector2d& center, double radius) {
  const Eigen::Vector2d half(radius, radius);
  taken_.push_back({center - half, center + half});
}

double LabelLayout::overlap(const Box& box) const {
  const auto shared = [&](const Box& other) {
    const Eigen::Vector2d size = box.high.cwiseMin(other.high) - box.low.cwiseMax(other.low);
    return std::max(0.0, size.x()) * std::max(0.0, size.y());
  };
  double area = (box.high - box.low).prod() - shared(paper_);  // outside
  for (const Box& other : taken_) area += shared(other);
  return area;
}

Eigen::Vector2d LabelLayout::place(const Eigen::Vector2d& point, const Eigen::Vector2d& direction,
                                   const std::string& text) {
  const Eigen::Vector2d half(0.32 * letter_size_ * static_cast<double>(text.size()) + 1.0,
                             0.45 * letter_size_);
  const Eigen::Vector2d first =
      direction.norm() > 0.3 ? Eigen::Vector2d(direction.normalized()) : Eigen::Vector2d(0.0, -1.0);
  double least = std::numeric_limits<double>::infinity();
  Box best{point, point};
  for (const double away : {11.0, 16.0, 24.0, 34.0}) {
    for (const double turn : {0.0, 0.8, -0.8, 1.6, -1.6, 2.4, -2.4, 3.14}) {
      const Eigen::Vector2d towards = Eigen::Rotation2Dd(turn) * first;
      const Eigen::Vector2d middle = point + (away + half.cwiseProduct(towards.cwiseAbs()).norm()) * towards;
      const Box box{middle - half, middle + half};
      const double cost = overlap(box) + 0.5 * away + 3.0 * std::abs(turn);
      if (cost < least) {
        least = cost;
        best = box;
      }
    }
  }
  taken_.push_back(best);
  return {0.5 * (best.low.x() + best.high.x()), best.high.y() - 0.12 * letter_size_};
}

void push_apart(std::vector<Eigen::Vector2d>& points, double distance, const Eigen::Vector2d& low,
                const Eigen::Vector2d& high) {
  constexpr int kRounds = 60;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t a = 0; a < points.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        Eigen::Vector2d apart = points[a] - points[b];
        const double length = apart.norm();
        if (length >= distance) continue;
        // Of two at one place, which may be above each other: aside, the same way in every run.
        apart = length > 1e-6 ? Eigen::Vector2d(apart / length) : Eigen::Vector2d(0.8, 0.6);
        points[a] += 0.5 * (distance - length) * apart;
        points[b] -= 0.5 * (distance - length) * apart;
      }
    }
    for (Eigen::Vector2d& point : points) point = point.cwiseMax(low).cwiseMin(high);
  }
}

}  // namespace apriltrack
