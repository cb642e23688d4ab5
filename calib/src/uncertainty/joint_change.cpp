#include "uncertainty/joint_change.h"

namespace apriltrack {

void JointChange::apply(Eigen::MatrixXd& covariance) const {
  if (lost_root.size() == 0) return;
  covariance -= lost_root * lost_root.transpose();
  covariance += by_frame * frame_covariance * by_frame.transpose() + by_frame * with_frame.transpose() +
                with_frame * by_frame.transpose();
}

Eigen::MatrixXd JointChange::follow(const Eigen::MatrixXd& columns) const {
  if (with_rows.size() == 0) return columns;
  const Eigen::MatrixXd seen = by_tags * columns;
  Eigen::MatrixXd result = columns - with_rows * (precision * seen);
  if (frame_push.size() > 0) result -= by_frame * (frame_push.transpose() * seen);
  return result;
}

}  // namespace apriltrack
