#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/left_out_tags.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"
#include "tag_tally.h"

namespace apriltrack::app {

/// "tag36h11/0 to 13, tag16h5/2": sorted keys with runs drawn together.
std::string list_of_tags(const std::set<TagKey>& keys);

/// "7.94 ms estimated, to 3 % (not told)", or what was assumed where the motion did not tell.
std::string exposure_not_told(const ExposureReport& exposure);

/// What a run of `track` leaves behind, frame by frame.
class TrackRecord {
 public:
  /// exposure_s: where the frame tells its own.
  void add(const FrameDetections& frame, const TrackResult& result,
           const std::optional<double>& exposure_s = std::nullopt);
  void add_unreadable(Timestamp timestamp);
  /// Of the frame that was added last.
  void add_sights(std::span<const TagSight> sights) { tag_tally_.add(rows_.back().timestamp, sights); }
  /// An image in which tags are looked for, `decimate` times smaller.
  void searches(int image_width_px, double decimate);

  void were_left_out(std::span<const LeftOutTag> tags) { left_out_.add(tags); }
  /// Pictures in which hardly a tag is read, and what is wrong with them.
  void are_odd(const std::string& told) { odd_pictures_ = told; }
  const std::string& odd_pictures() const { return odd_pictures_; }

  /// That no image shows anything.
  void found_all_blank() { are_all_blank_ = true; }
  /// Frames that are copies of the one before.
  void found_copies(std::size_t copies) { num_copies_ = copies; }
  /// Of 16-bit image files.
  void set_value_range(const std::optional<ValueRange>& range) { value_range_ = range; }

  bool has_pose() const { return !trajectory_.empty(); }
  /// Tags were read, but in so few frames that these may be false readings: what to ask then. Empty where
  /// none was, or more.
  std::string doubt_of_readings(const TagMap& map) const;
  /// Why a whole recording gave no pose, and what to do.
  std::string why_no_pose(const TagMap& map) const;

  struct SeveralTags {
    std::size_t frames = 0;
    std::size_t without_pose = 0;
    std::size_t with_strays = 0;
  };
  /// Frames in which two mapped tags or more were detected, or one is suspect; those of them that gave no
  /// pose, at best a predicted one; and those in which a tag that was read is not where the pose puts it, or
  /// one in view is suspect.
  SeveralTags frames_with_several_tags() const;
  /// Tags that were read and not where the pose puts them, or suspect, with the number of frames.
  const std::map<TagKey, int>& strays() const { return strays_; }

  /// Mapped tags that were seen where a pose put them, or read.
  const std::set<TagKey>& seen_tags() const { return seen_tags_; }
  /// Those that poses put into the image in three frames and more, and that were never seen: behind
  /// something, or not there. Of methods that tell.
  std::set<TagKey> never_seen_tags() const;

  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<FrameLogRow>& rows() const { return rows_; }
  /// For each row why it has no pose; empty where it has one, or is unreadable.
  const std::vector<std::string>& reasons() const { return reasons_; }
  /// Frames that are lost, by cause.
  const std::map<std::string, int>& lost_reasons() const { return lost_reasons_; }
  /// Of the frames that told their own.
  const std::vector<double>& exposures_s() const { return exposures_s_; }
  /// What the blur of the last frame was explained with; none where the method looks for none.
  const std::optional<ExposureReport>& last_exposure() const { return last_exposure_; }
  /// What became of each tag that was in view.
  const TagTally& tag_tally() const { return tag_tally_; }
  /// Frames in which a tag was detected, mapped or not.
  const std::map<TagKey, int>& frames_by_tag() const { return frames_by_tag_; }

  /// The first of those that took longest; null where none was readable.
  const FrameLogRow* slowest_frame() const;

  /// Counts and latencies, for machines and for people.
  nlohmann::json summary() const;
  std::string text() const;

 private:
  std::set<TagKey> read_tags() const;
  std::size_t num_lost() const { return rows_.size() - trajectory_.size() - num_unreadable_; }
  std::size_t count(TrackStatus status) const;
  double latency_ms(double fraction) const;

  Trajectory trajectory_;
  std::vector<FrameLogRow> rows_;
  std::vector<std::string> reasons_;
  std::vector<double> exposures_s_;
  std::optional<ExposureReport> last_exposure_;
  std::vector<double> latencies_ms_;
  std::map<TagKey, int> frames_by_tag_;  ///< Everything detected, mapped or not.
  std::size_t num_with_tags_ = 0;        ///< Frames in which anything was.
  std::vector<bool> has_strays_;         ///< For each row.
  std::map<TagKey, int> strays_;
  std::set<TagKey> seen_tags_;
  std::map<TagKey, int> frames_in_view_;     ///< Of mapped tags that poses put into the image.
  std::map<std::string, int> lost_reasons_;  ///< Frames without a pose, by cause.
  TagTally tag_tally_;
  std::size_t num_unreadable_ = 0;
  LeftOutTags left_out_;
  std::string odd_pictures_;
  bool searches_large_images_ = false;
  bool are_all_blank_ = false;
  std::size_t num_copies_ = 0;
  std::optional<ValueRange> value_range_;
};

}  // namespace apriltrack::app
