#pragma once

#include <string>
#include <vector>

#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "demo_plan.h"

namespace apriltrack::app {

/// How one method fared in one scene, against the exact truth.
struct DemoScore {
  const DemoScene* scene = nullptr;
  std::string method;
  TrajectoryEvaluation evaluation;
  FrameLogEvaluation log;
  std::vector<FrameScore>
      predicted;  ///< Frames whose pose the method itself calls no more than a prediction.
};

/// Of all scenes and methods. Throws Error.
std::vector<DemoScore> score_demo(const DemoFiles& files);

/// Head and rows: scene, method, claimed share, within 5 px, median and 95 % by blur, silent failures, ms a
/// frame.
struct DemoTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  std::string text() const;  ///< In columns, for a terminal.
};
DemoTable tabulate(const std::vector<DemoScore>& scores);
/// What the cells under `blur ...` hold.
std::string explain_blur_columns();

}  // namespace apriltrack::app
