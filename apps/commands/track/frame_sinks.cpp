#include "frame_sinks.h"

namespace apriltrack::app {

FrameSinks::FrameSinks(const TrackArguments& arguments, const Camera& camera, const TagMap& map) {
  const TrackMode mode = arguments.method_options().localizer.mode;
  if (!arguments.video.empty()) video_.emplace(arguments.video, camera, map, mode);
  if (!arguments.tags_csv.empty()) tags_csv_.emplace(files_, arguments.tags_csv);
  if (arguments.streams_poses())
    poses_.emplace(!(arguments.frames_csv + arguments.tags_csv + arguments.video + arguments.report).empty());
  if (arguments.writes_mcap())
    mcap_.emplace(files_, arguments.output, camera, map,
                  TrackMcap::Options{.mode = mode, .with_images = arguments.output_images});
}

void FrameSinks::add(const TrackResult& result, std::span<const TagSight> sights, const SourceFrame* image) {
  if (poses_ && result.pose) poses_->add({result.timestamp, *result.pose});
  if (video_ && image) video_->add(*image, result);
  if (tags_csv_) tags_csv_->add(result.timestamp, sights);
  if (mcap_) mcap_->add(result, sights, image);
}

void FrameSinks::add_unreadable(const SourceFrame& frame) {
  if (video_) video_->add_unreadable(frame.timestamp);
  if (mcap_) mcap_->add_unreadable(frame);
}

void FrameSinks::close(StagedFiles& files) {
  if (video_) video_->close(files);
  if (tags_csv_) tags_csv_->close();
  if (mcap_) mcap_->close();
}

void FrameSinks::commit() {
  files_.commit();
  if (poses_) poses_->close();
}

}  // namespace apriltrack::app
