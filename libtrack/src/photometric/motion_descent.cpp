#include "motion_descent.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace apriltrack {
namespace {

constexpr int kMaxAttempts = 4;
constexpr double kFirstDamping = 1e-3;
constexpr double kLeastDamping = 1e-6;
/// Squared standard deviations that the step ahead would still move the state: nobody sees them.
constexpr double kNegligible2 = 0.01;
constexpr double kNegligible2Coarse = 0.25;
/// Likewise: a step that should gain so little, and gains nothing, was the last. Costs are not known as well
/// as that, and shorter steps promise still less.
constexpr double kDoubtful2 = 0.25;

Vector12d damped_step(MotionEquations equations, double damping) {
  equations.H.diagonal() *= 1.0 + damping;
  equations.H.diagonal().array() += 1e-9;
  return equations.step();
}

class Descent {
 public:
  Descent(const MotionObjective& objective, EvaluatedState& current, EvaluatedState& spare)
      : objective_(objective), current_(current), spare_(spare) {}

  double negligible2() const { return objective_.level() == 0 ? kNegligible2 : kNegligible2Coarse; }

  /// What was ahead before the step; none where it was not made. Judged by the step without damping: a damped
  /// one hardly moves where the picture tells little, and would call that the end.
  std::optional<double> step() {
    const MotionEquations equations = objective_.equations(current_);
    const double ahead2 = equations.worth(damped_step(equations, 0.0));
    if (!(ahead2 >= negligible2())) return std::nullopt;
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
      const Vector12d move = damped_step(equations, damping_);
      if (!move.allFinite()) return std::nullopt;
      if (is_better_after(move)) return ahead2;
      if (ahead2 < kDoubtful2) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  bool is_better_after(const Vector12d& move) {
    objective_.evaluate(moved(current_.state, move), current_.cost, spare_);
    const bool is_better = spare_.cost < current_.cost;
    damping_ = is_better ? std::max(kLeastDamping, 0.2 * damping_) : std::max(kFirstDamping, 10.0 * damping_);
    if (is_better) std::swap(current_, spare_);
    return is_better;
  }

  const MotionObjective& objective_;
  EvaluatedState& current_;
  EvaluatedState& spare_;
  double damping_ = kFirstDamping;
};

}  // namespace

bool descend(const MotionObjective& objective, int max_steps, EvaluatedState& current,
             EvaluatedState& spare) {
  Descent descent(objective, current, spare);
  double last2 = 0.0;
  for (int step = 0; step < max_steps; ++step) {
    const std::optional<double> ahead2 = descent.step();
    if (!ahead2) return true;
    // As steps shrink, the next one is negligible: it need not be known.
    if (*ahead2 * *ahead2 < descent.negligible2() * last2) return true;
    last2 = *ahead2;
  }
  return false;
}

}  // namespace apriltrack
