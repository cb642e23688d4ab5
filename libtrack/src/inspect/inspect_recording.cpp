#include "apriltrack/inspect/inspect_recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/edge_blur.h"
#include "apriltrack/detect/odd_picture_watch.h"
#include "apriltrack/detect/patch_keeper.h"
#include "apriltrack/image/blank.h"
#include "apriltrack/source/detect_frames.h"
#include "apriltrack/source/response_sample.h"
#include "apriltrack/source/session_clocks.h"
#include "other_families.h"
#include "viewpoints.h"

namespace apriltrack {
namespace {

/// Whether the tag's white is clipped: of the families' cells a third and more are white.
bool is_clipped(const Detection& detection, const GrayView& image) {
  constexpr int kSide = 16;  // points read across the tag
  constexpr double kLeastShare = 0.15;
  const auto& corners = detection.corners_px;
  int white = 0, all = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double right = (i % kSide + 0.5) / kSide, up = (i / kSide + 0.5) / kSide;
    const Eigen::Vector2d point = (1.0 - up) * ((1.0 - right) * corners[0] + right * corners[1]) +
                                  up * ((1.0 - right) * corners[3] + right * corners[2]);
    const int x = static_cast<int>(std::lround(point.x())), y = static_cast<int>(std::lround(point.y()));
    if (!image.contains(x, y)) continue;
    ++all;
    white += image(x, y) == 255;
  }
  return white > kLeastShare * all;
}

SeenTag seen_tag(const Detection& detection, const GrayView& image, const ResponseCurve& response) {
  constexpr double kBorder = 0.03;
  SeenTag seen{.tag = detection.tag,
               .margin = detection.decision_margin.value_or(0.0),
               .corrected_bits = detection.hamming.value_or(0)};
  seen.corners_px = detection.corners_px;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const Eigen::Vector2d& corner = detection.corners_px[k];
    seen.edge_px += (detection.corners_px[(k + 1) % kNumCorners] - corner).norm() / kNumCorners;
    const double from_border_x = std::min(corner.x(), image.width() - 1 - corner.x());
    const double from_border_y = std::min(corner.y(), image.height() - 1 - corner.y());
    seen.is_at_border = seen.is_at_border || from_border_x < kBorder * image.width() ||
                        from_border_y < kBorder * image.height();
  }
  seen.is_clipped = is_clipped(detection, image);
  if (const auto sigma_px = edge_blur_sigma_px(image, response, detection))
    seen.blur_px = motion_of_blur_px(*sigma_px);
  return seen;
}

void add_light(const GrayView& image, FrameFacts& facts) {
  std::array<std::size_t, 256> counts{};
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) ++counts[image(x, y)];
  const double all = static_cast<double>(image.width()) * image.height();
  facts.white_share = static_cast<double>(counts[255]) / all;
  std::size_t brighter = 0;
  for (facts.bright_level = 255; facts.bright_level > 0; --facts.bright_level) {
    brighter += counts[static_cast<std::size_t>(facts.bright_level)];
    if (static_cast<double>(brighter) > 0.01 * all) break;
  }
  facts.is_blank = is_blank(image);
}

FrameFacts facts_of(const DetectedFrame& frame, const ResponseCurve& response) {
  const GrayView image = frame.source.pixels.view();
  FrameFacts facts{.name = frame.source.name,
                   .time = frame.source.timestamp,
                   .width = image.width(),
                   .height = image.height(),
                   .is_copy = frame.is_copy,
                   .tells_exposure = frame.source.exposure_s.has_value()};
  add_light(image, facts);
  for (const Detection& detection : frame.detections)
    facts.tags.push_back(seen_tag(detection, image, response));
  return facts;
}

/// Whether images have times. Where their names tell none, these do not matter to a first look.
bool has_times(const std::string& input, SourceOptions options) {
  options.log = silent_log();
  try {
    open_source(input, options);
    return true;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInvalidInput || options.rate_hz) throw;
    return false;
  }
}

ResponseCamera camera_to_ask(const RecordingFacts& facts) {
  ResponseCamera asked{.name = facts.camera_name};
  if (facts.camera) asked = to_ask_of(*facts.camera);
  return asked;
}

/// What is kept of the frames beside the facts.
struct KeptPictures {
  std::vector<FrameDetections> tags;  ///< With pictures.
  OddPictureWatch watch;
  FamilySample for_families;
};

/// Fills in what is seen with the detector's response.
KeptPictures look_with(const SampledInput& input, const DetectorOptions& detector,
                       const InspectionOptions& options, RecordingFacts& facts) {
  facts.frames.clear();
  facts.left_out = {};
  const auto source = open_source(input.input, input.source);
  KeptPictures kept;
  PatchKeeper keeper;
  const FrameCounts counts = detect_frames(
      *source,
      {detector, nullptr, options.num_threads, input.source.skip, "look at " + facts.input, options.progress,
       options.should_stop},
      [&](DetectedFrame frame) {
        if (!frame.source.is_readable()) return;
        kept.for_families.offer(frame.source.pixels.view(), frame.detections);
        kept.watch.add(frame.source.pixels.view(), frame.detections);
        facts.left_out.add(frame.left_out);
        facts.frames.push_back(facts_of(frame, detector.response));
        kept.tags.push_back({frame.source.timestamp, facts.camera_name, std::move(frame.detections)});
        keeper.keep(frame.source.pixels.view(), kept.tags.back());
      });
  for (const std::string& warning : counts.warnings()) input.source.log(LogLevel::kWarning, warning);
  facts.unreadable = counts.unreadable;
  facts.value_range = counts.value_range;
  facts.is_interrupted = counts.is_interrupted;
  return kept;
}

/// Once, whatever response the pictures turn out to have: neither search depends on it.
void look_for_what_was_not_asked(const KeptPictures& kept, const DetectorOptions& detector,
                                 const InspectionOptions& options, RecordingFacts& facts) {
  facts.odd_pictures = kept.watch.look(detector);
  if (!facts.odd_pictures) {
    facts.odd_pictures = kept.watch.look_among_good(detector);
    facts.are_some_good = facts.odd_pictures.has_value();
  }
  if (!options.tries_other_families) return;
  const std::vector<GrayImage> images = kept.for_families.images();
  facts.other_families =
      read_other_families(images, detector, options.num_threads, options.progress, options.should_stop);
  facts.sampled = images.size();
  const bool has_tags = std::ranges::any_of(facts.frames, [](const auto& one) { return !one.tags.empty(); });
  if (has_tags || facts.odd_pictures || !facts.other_families.empty()) return;
  facts.odd_pictures = find_odd_pictures_of_any(images, detector);
}

/// Frames of several cameras belong together where their times are equal.
std::vector<RigView> views_of(const std::vector<RecordingFacts>& recordings) {
  SessionClocks sessions;
  for (const RecordingFacts& recording : recordings) {
    std::vector<FrameDetections> frames;
    for (const FrameFacts& frame : recording.frames) {
      if (!is_usable(frame, recording.camera)) continue;
      frames.push_back({frame.time, recording.camera_name, {}});
      for (const SeenTag& seen : frame.tags)
        frames.back().detections.push_back({seen.tag, seen.corners_px, std::nullopt, std::nullopt});
    }
    sessions.add(recording.input, {recording.camera_name}, std::move(frames));
  }
  std::vector<RigView> views;
  RigView view;
  const std::vector<FrameDetections> frames = sessions.align().frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const Detection& detection : frames[i].detections)
      view.push_back({frames[i].camera, detection.tag, detection.corners_px});
    const bool goes_on = i + 1 < frames.size() && frames[i + 1].timestamp == frames[i].timestamp &&
                         frames[i + 1].camera != frames[i].camera;
    if (goes_on || view.empty()) continue;
    views.push_back(std::move(view));
    view.clear();
  }
  return views;
}

void add_viewpoints(InspectionFacts& facts) {
  const std::vector<RigView> views = views_of(facts.recordings);
  facts.places = tags_by_viewpoint(views);
  const auto shows_two = [](const RigView& view) {
    return std::ranges::any_of(view, [&](const ViewedTag& one) { return one.tag != view.front().tag; });
  };
  const auto joins_two = [](const std::vector<TagKey>& tags) { return tags.size() > 1; };
  facts.at_rest = static_cast<std::size_t>(std::ranges::count_if(views, shows_two) -
                                           std::ranges::count_if(facts.places, joins_two));
}

}  // namespace

RecordingFacts inspect_recording(const InspectedInput& recording, const InspectionOptions& options) {
  RecordingFacts facts{
      .input = recording.name, .camera_name = recording.camera_name, .camera = recording.camera};
  SourceOptions source_options = recording.source;
  facts.tells_times = has_times(recording.input, source_options);
  if (!facts.tells_times) source_options.rate_hz = 1.0;
  DetectorOptions detector = options.detector;
  if (facts.camera) detector.camera_model = facts.camera->model;
  const SampledInput sampled{recording.input, source_options};
  std::optional<KeptPictures> kept;
  facts.response = run_with_response(
      camera_to_ask(facts), facts.camera ? facts.camera->response_origin : ResponseOrigin::kAssumed, sampled,
      detector, options.num_threads,
      [&](const ResponseCurve& response, const std::optional<ResponseCurve>&) {
        // A rival would change covariances alone, which nobody asks for.
        const bool is_seen = kept && detector.response.name() == response.name();
        detector.response = response;
        if (!is_seen) kept = look_with(sampled, detector, options, facts);
        return std::span<const FrameDetections>(kept->tags);
      },
      options.should_stop);
  if (!facts.is_interrupted) look_for_what_was_not_asked(*kept, detector, options, facts);
  return facts;
}

InspectionFacts join_recordings(std::vector<std::string> families, std::vector<RecordingFacts> recordings) {
  InspectionFacts facts{.families = std::move(families), .recordings = std::move(recordings)};
  facts.is_interrupted = std::ranges::any_of(facts.recordings, &RecordingFacts::is_interrupted);
  add_viewpoints(facts);
  return facts;
}

}  // namespace apriltrack
