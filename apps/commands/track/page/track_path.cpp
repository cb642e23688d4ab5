#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apriltrack/report/drawn_tags.h"
#include "apriltrack/report/map_scene.h"
#include "pages/status_colours.h"
#include "pages/upward.h"
#include "track_drawings.h"
#include "track_extent.h"

namespace apriltrack::app {
namespace {

constexpr double kPathWidth = 1010.0, kPathHeight = 700.0, kPathMargin = 50.0;
constexpr double kSmallPathWidth = 620.0, kSmallPathHeight = 480.0, kSmallPathMargin = 44.0;

bool is_ego(const TrackRun& run) {
  return run.arguments.method_options().localizer.mode == TrackMode::kEgo;
}

SvgInk ink_of_fate(TagFate fate) {
  switch (fate) {
    case TagFate::kSeen:
      return SvgInk::kText;
    case TagFate::kSuspect:
      return SvgInk::kWarning;
    case TagFate::kNeverSeen:
      return SvgInk::kPurpleInk;
    case TagFate::kNeverInView:
      return SvgInk::kPale;
  }
  return SvgInk::kText;
}

/// In the frame of the path.
std::vector<DrawnTag> tags_of_path(const TrackRun& run) {
  const Pose T_path_map = is_ego(run) ? Pose::identity() : run.record.trajectory().front().pose;
  std::vector<DrawnTag> tags;
  for (const MapTag& tag : run.map.tags) {
    const TagFate fate = fate_of(run.record, tag.key);
    tags.push_back({.tag = tag,
                    .name = short_name(run.map, tag),
                    .ink = ink_of_fate(fate),
                    .takes_part = fate == TagFate::kSeen || fate == TagFate::kNeverInView,
                    .tooltip = tooltip_of(tag)});
    tags.back().tag.T_map_tag = T_path_map * tag.T_map_tag;
  }
  return tags;
}

/// Up as the camera was held; a body moves before the camera, and is seen as this sees it.
std::vector<Elevation> papers_of(const TrackRun& run) {
  if (!is_ego(run))
    return {{"As the camera sees it", Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY()},
            {"From above", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
            {"From the camera's right", Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitY()}};
  MapEvidence path;
  for (const TimedPose& pose : run.record.trajectory()) path.moments.push_back({pose.timestamp, pose.pose});
  const Elevations all = elevations_of(run.map, upward(run.map, path));
  return {all.above, all.front, all.side};
}

/// Predictions may fly far off, and would leave nothing to be seen of the rest: they do not stretch the
/// paper.
std::vector<Eigen::Vector2d> points_of(const TrackRun& run, const std::vector<DrawnTag>& tags,
                                       const Elevation& elevation) {
  std::vector<Eigen::Vector2d> points;
  for (const DrawnTag& drawn : tags)
    for (const Eigen::Vector3d& corner : corners_in_map(drawn.tag)) points.push_back(elevation.of(corner));
  for (const FrameLogRow& row : run.record.rows())
    if (row.pose && claims_evidence(row)) points.push_back(elevation.of(row.pose->translation()));
  return points;
}

class PathPencil {
 public:
  PathPencil(const Elevation& elevation, const PaperScale& scale, SvgPicture& picture)
      : elevation_(elevation), scale_(scale), picture_(picture) {}

  void draw_truth(const Trajectory& truth) {
    std::vector<Eigen::Vector2d> line;
    for (const TimedPose& pose : truth) add(pose.pose, line);
    picture_.polyline(line, {.stroke = SvgInk::kText, .width = 1.0, .opacity = 0.6, .is_dashed = true});
  }

  /// Dots in the colour of the status, over a line from frame to frame with a pose.
  void draw_run(const TrackRecord& record) {
    std::vector<Eigen::Vector2d> line;
    const auto end_line = [&] {
      picture_.polyline(std::exchange(line, {}), {.stroke = SvgInk::kPale, .width = 0.9});
    };
    for (const FrameLogRow& row : record.rows()) {
      if (row.pose) {
        add(*row.pose, line);
      } else {
        end_line();
      }
    }
    end_line();
    for (const TrackStatus status :
         {TrackStatus::kDetected, TrackStatus::kTracked, TrackStatus::kPredicted}) {
      std::vector<Eigen::Vector2d> dots;
      for (const FrameLogRow& row : record.rows())
        if (row.pose && row.status == to_string(status)) add(*row.pose, dots);
      picture_.dots(dots, {.stroke = ink_of_status(status), .width = 4.0});
    }
  }

 private:
  /// Nothing off the paper, and no two places that cannot be told apart.
  void add(const Pose& pose, std::vector<Eigen::Vector2d>& points) const {
    constexpr double kGrain = 0.7;
    const Eigen::Vector2d at = scale_.at(elevation_.of(pose.translation()))
                                   .cwiseMax(Eigen::Vector2d::Zero())
                                   .cwiseMin(Eigen::Vector2d(picture_.width(), picture_.height()));
    if (points.empty() || (points.back() - at).norm() >= kGrain) points.push_back(at);
  }

  const Elevation& elevation_;
  const PaperScale& scale_;
  SvgPicture& picture_;
};

SvgPicture draw_path_on(const TrackRun& run, const Trajectory& truth, const Elevation& elevation,
                        bool is_large) {
  const std::vector<DrawnTag> tags = tags_of_path(run);
  const PaperScale scale(points_of(run, tags, elevation), is_large ? kPathWidth : kSmallPathWidth,
                         is_large ? kPathHeight : kSmallPathHeight,
                         is_large ? kPathMargin : kSmallPathMargin);
  SvgPicture picture(scale.width(), scale.height());
  PathPencil pencil(elevation, scale, picture);
  draw_paper(scale, picture);
  pencil.draw_truth(truth);
  pencil.draw_run(run.record);
  draw_tags(tags, elevation, scale, picture);
  draw_title_and_scale(elevation.name, scale, picture);
  return picture;
}

}  // namespace

std::vector<MapDrawing> draw_path(const TrackRun& run, const Trajectory& truth) {
  const std::vector<Elevation> elevations = papers_of(run);
  MapDrawing large{
      {draw_path_on(run, truth, elevations[0], true)},
      fmt::format("The path {}: dots are detected in green, tracked in blue, predicted in orange; a grey "
                  "line joins frames that follow each other.{} Tags with the direction they face{}; "
                  "dashed and crossed: in orange not where the map has them in some frame, in purple in "
                  "view and never seen; pale: never in view.",
                  describe_positions(run.arguments.method_options().localizer.mode),
                  truth.empty() ? "" : " The dashed line is the truth.",
                  is_ego(run) ? "" : ", at the body's first pose")};
  MapDrawing small{{}, "The same from two sides."};
  for (std::size_t i = 1; i < elevations.size(); ++i)
    small.pictures.push_back(draw_path_on(run, truth, elevations[i], false));
  return {std::move(large), std::move(small)};
}

}  // namespace apriltrack::app
