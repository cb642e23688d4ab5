#include "track_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/statistics.h"
#include "files/blank_images.h"
#include "files/frame_loop.h"
#include "files/left_out_words.h"

namespace apriltrack::app {
namespace {

struct MapContents {
  std::set<TagKey> tags;
  std::set<std::string> families;

  explicit MapContents(const TagMap& map) {
    for (const MapTag& tag : map.tags) {
      tags.insert(tag.key);
      families.insert(tag.key.family);
    }
  }
};

constexpr const char* kAreTheyThere =
    "is this the family that is printed? Are the tags sharp, with a white margin, and 20 px wide or more?";

/// What the tracker said of most frames in which it saw tags.
std::string usual_reason(const std::map<std::string, int>& reasons) {
  const auto usual =
      std::ranges::max_element(reasons, [](const auto& a, const auto& b) { return a.second < b.second; });
  return usual == reasons.end() ? "" : usual->first;
}

std::string why_without_pose(const MapContents& map, const std::set<TagKey>& seen, std::size_t num_frames,
                             const std::map<std::string, int>& reasons) {
  if (num_frames == 0) return "has no frames";
  if (seen.empty()) {
    return fmt::format("no tag of family {} in any of {} frames; {}", fmt::join(map.families, ", "),
                       num_frames, kAreTheyThere);
  }
  std::set<TagKey> mapped, others;
  for (const TagKey& key : seen) (map.tags.contains(key) ? mapped : others).insert(key);
  if (mapped.empty()) {
    return fmt::format(
        "no tag of the map in any of {} frames: seen {}; the map has {}; give the map of this place",
        num_frames, list_of_tags(seen), list_of_tags(map.tags));
  }
  const std::string question = others.size() > mapped.size()
                                   ? "is this the family that is printed, and the map of this place?"
                                   : "check the tag sizes and poses of the map, and the camera file";
  return fmt::format(
      "tags of the map are seen ({}){}, but none of {} frames gives a pose (most often: {}); {}",
      list_of_tags(mapped), others.empty() ? "" : ", and others (" + list_of_tags(others) + ")", num_frames,
      usual_reason(reasons), question);
}

}  // namespace

std::string exposure_not_told(const ExposureReport& exposure) {
  const double exposure_ms = 1e3 * exposure.exposure_s;
  if (!exposure.is_estimated) return fmt::format("{:.3g} ms assumed (not told)", exposure_ms);
  return fmt::format("{:.3g} ms estimated, to {:.0f} % (not told)", exposure_ms, 100.0 * exposure.sigma);
}

std::string list_of_tags(const std::set<TagKey>& keys) {
  std::string text;
  for (auto first = keys.begin(); first != keys.end();) {
    auto last = first;
    for (auto next = std::next(last);
         next != keys.end() && next->family == last->family && next->id == last->id + 1; ++next) {
      last = next;
    }
    if (!text.empty()) text += ", ";
    text += to_string(*first);
    if (last != first) text += fmt::format(" to {}", last->id);
    first = std::next(last);
  }
  return text;
}

void TrackRecord::add(const FrameDetections& frame, const TrackResult& result,
                      const std::optional<double>& exposure_s) {
  std::set<TagKey> tags;
  for (const Detection& detection : frame.detections) tags.insert(detection.tag);
  for (const TagKey& tag : tags) ++frames_by_tag_[tag];
  num_with_tags_ += tags.empty() ? 0 : 1;
  rows_.push_back({.timestamp = result.timestamp,
                   .status = to_string(result.status),
                   .pose = result.pose,
                   .tags_detected = result.tags_detected,
                   .tags_tracked = result.tags_tracked,
                   .latency_ms = 1e3 * result.latency_s,
                   .second_mode_odds = result.second_mode_odds,
                   .covariance = result.covariance,
                   .detection_ms = 1e3 * result.detection_s});
  has_strays_.push_back(!result.contradicting_tags.empty());
  for (const TagKey& tag : result.contradicting_tags) ++strays_[tag];
  for (const TagReport& tag : result.tags) {
    ++frames_in_view_[tag.tag];
    if (tag.state == TagState::kUsed || tag.is_read) seen_tags_.insert(tag.tag);
  }
  latencies_ms_.push_back(1e3 * result.latency_s);
  reasons_.push_back(result.pose ? "" : result.reason);
  if (exposure_s) exposures_s_.push_back(*exposure_s);
  if (result.exposure) last_exposure_ = result.exposure;
  if (result.pose) {
    trajectory_.push_back({result.timestamp, *result.pose});
  } else {
    ++lost_reasons_[result.reason];
  }
}

void TrackRecord::add_unreadable(Timestamp timestamp) {
  ++num_unreadable_;
  FrameLogRow row;
  row.timestamp = timestamp;
  row.status = to_string(TrackStatus::kUnreadable);
  rows_.push_back(row);
  has_strays_.push_back(false);
  reasons_.emplace_back();
}

void TrackRecord::searches(int image_width_px, double decimate) {
  constexpr int kLarge_px = 2560;
  constexpr double kEnough = 4.0;
  searches_large_images_ = searches_large_images_ || (image_width_px > kLarge_px && decimate < kEnough);
}

std::set<TagKey> TrackRecord::read_tags() const {
  std::set<TagKey> tags;
  for (const auto& [key, count] : frames_by_tag_) tags.insert(key);
  return tags;
}

std::string TrackRecord::doubt_of_readings(const TagMap& map) const {
  constexpr std::size_t kOneIn = 20;
  const std::size_t num_readable = rows_.size() - num_unreadable_;
  if (num_with_tags_ == 0 || kOneIn * num_with_tags_ > num_readable) return "";
  return fmt::format(
      "tags of family {} were read in {} of {} frames only ({}), perhaps where there are none; {}",
      fmt::join(MapContents(map).families, ", "), num_with_tags_, num_readable, list_of_tags(read_tags()),
      kAreTheyThere);
}

std::string TrackRecord::why_no_pose(const TagMap& map) const {
  if (are_all_blank_) return told_of_blank_images(rows_.size() - num_unreadable_);
  if (!odd_pictures_.empty()) return odd_pictures_;
  if (std::string doubt = doubt_of_readings(map); !doubt.empty()) return doubt;
  const std::set<TagKey> seen = read_tags();
  std::string why = why_without_pose(MapContents(map), seen, num_lost(), lost_reasons_);
  // The edges of their tags may be smeared over more pixels than the search spans.
  if (seen.empty()) why += told_after(left_out_);
  if (seen.empty() && searches_large_images_) why += " The images are large: try --decimate 4";
  return why;
}

TrackRecord::SeveralTags TrackRecord::frames_with_several_tags() const {
  SeveralTags result;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const FrameLogRow& row = rows_[i];
    if (row.tags_detected < 2 && !has_strays_[i]) continue;  // a suspect need not be read
    ++result.frames;
    if (!row.pose || row.status == to_string(TrackStatus::kPredicted))
      ++result.without_pose;
    else if (has_strays_[i])
      ++result.with_strays;
  }
  return result;
}

std::set<TagKey> TrackRecord::never_seen_tags() const {
  constexpr int kSeveral = 3;
  std::set<TagKey> tags;
  for (const auto& [tag, frames] : frames_in_view_) {
    if (frames >= kSeveral && !seen_tags_.contains(tag)) tags.insert(tag);
  }
  return tags;
}

std::size_t TrackRecord::count(TrackStatus status) const {
  const std::string word = to_string(status);
  const auto is_it = [&](const FrameLogRow& row) { return row.status == word; };
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), is_it));
}

double TrackRecord::latency_ms(double fraction) const {
  return percentile(latencies_ms_, fraction);
}

const FrameLogRow* TrackRecord::slowest_frame() const {
  const auto slowest = std::ranges::max_element(rows_, {}, &FrameLogRow::latency_ms);  // none is least
  return slowest == rows_.end() || !slowest->latency_ms ? nullptr : &*slowest;
}

nlohmann::json TrackRecord::summary() const {
  nlohmann::json summary = {{"frames", rows_.size()},
                            {"with_pose", trajectory_.size()},
                            {"detected", count(TrackStatus::kDetected)},
                            {"tracked", count(TrackStatus::kTracked)},
                            {"predicted", count(TrackStatus::kPredicted)},
                            {"lost", num_lost()},
                            {"unreadable", num_unreadable_},
                            {"copied_frames", num_copies_},
                            {"lost_reasons", lost_reasons_},
                            {"tags_seen", frames_by_tag_.size()},
                            {"readings_left_out", json_of(left_out_)},
                            {"value_range", value_range_json(value_range_)},
                            {"mapped_tags_in_view_never_seen", never_seen_tags().size()},
                            {"latency_p50_ms", latency_ms(0.50)},
                            {"latency_p99_ms", latency_ms(0.99)}};
  if (const FrameLogRow* slowest = slowest_frame()) {
    summary["latency_max_ms"] = *slowest->latency_ms;
    summary["latency_max_timestamp_ns"] = slowest->timestamp.ns;
  }
  if (last_exposure_) {
    summary["exposure"] = {{"used_s", last_exposure_->exposure_s},
                           {"is_told", last_exposure_->told_s.has_value()},
                           {"is_estimated", last_exposure_->is_estimated},
                           {"relative_sigma", last_exposure_->sigma}};
  }
  return summary;
}

std::string TrackRecord::text() const {
  // Of how the poses came about only what a method that tracks has to tell.
  const std::size_t tracked = count(TrackStatus::kTracked), predicted = count(TrackStatus::kPredicted);
  const std::string kinds =
      tracked + predicted == 0 ? "" : fmt::format(" ({} tracked, {} predicted)", tracked, predicted);
  const bool is_untold = last_exposure_ && !last_exposure_->told_s;
  const FrameLogRow* slowest = slowest_frame();
  const std::string most =
      slowest ? fmt::format(", {:.1f} ms (max, at {} ns)", *slowest->latency_ms, slowest->timestamp.ns) : "";
  return fmt::format(
      "{} frames: {} with a pose{}, {} lost, {} unreadable; latency {:.1f} ms (p50), {:.1f} ms (p99){}{}",
      rows_.size(), trajectory_.size(), kinds, num_lost(), num_unreadable_, latency_ms(0.50),
      latency_ms(0.99), most, is_untold ? "; exposure: " + exposure_not_told(*last_exposure_) : "");
}

}  // namespace apriltrack::app
