// Noise of a pose as berndpfrommer/tagslam takes it: `position_noise` and `rotation_noise` are standard
// deviations per axis; R is a 6x6 square root of the information, errors in the order rotation, position
// (gtsam's), in the frame on the right. TagSLAM maps R's 36 numbers column by column and takes R^T R for the
// information (yaml.cpp and pose_noise.cpp there), and so do we.
#include "tagslam_noise.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "../tag_faults.h"
#include "apriltrack/io/numbers.h"
#include "map_words.h"

namespace apriltrack {
namespace {

/// From [rotation; position] to [position; rotation], and back.
Matrix6d with_halves_swapped(const Matrix6d& matrix) {
  Matrix6d out;
  out << matrix.bottomRightCorner<3, 3>(), matrix.bottomLeftCorner<3, 3>(), matrix.topRightCorner<3, 3>(),
      matrix.topLeftCorner<3, 3>();
  return out;
}

Eigen::Vector3d sigmas_of(const YamlNode& node) {
  const auto sigma = [&](std::string_view key) {
    const YamlNode value = node.at(key);
    const double number = value.as_double();
    if (number < 0.0) value.fail(fmt::format("is a standard deviation and must be >= 0 (is {})", number));
    return number;
  };
  return {sigma("x"), sigma("y"), sigma("z")};
}

Matrix6d covariance_of_root(const YamlNode& node) {
  const std::vector<double> numbers = node.as_doubles(36);
  const Matrix6d root = Eigen::Map<const Matrix6d>(numbers.data());  // column by column
  const Eigen::FullPivLU<Matrix6d> lu(root.transpose() * root);
  if (!lu.isInvertible()) node.fail("must have an inverse: it is a square root of the pose's information");
  const Matrix6d covariance = lu.inverse();
  return with_halves_swapped(0.5 * (covariance + covariance.transpose()));
}

}  // namespace

std::optional<Matrix6d> covariance_of_tagslam(const YamlNode& pose) {
  const auto root = pose.find("R");
  const auto position = pose.find("position_noise");
  const auto rotation = pose.find("rotation_noise");
  Matrix6d covariance = Matrix6d::Zero();
  if (position && rotation) {
    covariance.diagonal().head<3>() = sigmas_of(*position).cwiseAbs2();
    covariance.diagonal().tail<3>() = sigmas_of(*rotation).cwiseAbs2();
  } else if (root) {
    covariance = covariance_of_root(*root);
  } else {
    return std::nullopt;
  }
  if (const auto fault = fault_of_covariance(covariance)) pose.fail("noise: " + *fault);
  return covariance;
}

std::optional<std::string> text_of_tagslam_covariance(const Matrix6d& covariance, const std::string& indent) {
  const Matrix6d theirs = with_halves_swapped(covariance_to_frame(covariance, rotation_ros_tag()));
  const Eigen::LLT<Matrix6d> of_covariance(theirs);
  if (of_covariance.info() != Eigen::Success || of_covariance.rcond() < 1e-14) return std::nullopt;
  const Matrix6d inverse = of_covariance.solve(Matrix6d::Identity());
  const Eigen::LLT<Matrix6d> of_information(0.5 * (inverse + inverse.transpose()));
  if (of_information.info() != Eigen::Success) return std::nullopt;
  const Matrix6d root = of_information.matrixU();
  std::string text = indent + "R: [";
  for (int i = 0; i < 36; ++i)
    text += (i == 0 ? "" : i % 6 == 0 ? ",\n" + indent + "    " : ", ") + yaml_double(root(i % 6, i / 6));
  return text + "]\n";
}

std::string text_of_tagslam_sigmas(const Vector6d& sigmas, double least, const std::string& indent) {
  const Vector6d s = sigmas.cwiseMax(least);
  const auto line = [&](const char* key, const Eigen::Vector3d& v) {
    return fmt::format("{}{}: {{x: {}, y: {}, z: {}}}\n", indent, key, yaml_double(v.x()), yaml_double(v.y()),
                       yaml_double(v.z()));
  };
  return line("position_noise", s.head<3>()) + line("rotation_noise", s.tail<3>());
}

}  // namespace apriltrack
