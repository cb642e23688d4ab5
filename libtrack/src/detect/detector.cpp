#include "apriltrack/detect/detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/base/held.h"
#include "apriltrack/detect/chance_readings.h"
#include "apriltrack/tags/tag_family.h"
#include "corner_refinement.h"
#include "joined_borders.h"
#include "least_contrast.h"
#include "library_detector.h"
#include "light_sampler.h"
#include "merge.h"
#include "pattern_correlation.h"
#include "pattern_fit.h"
#include "two_cell_border.h"

namespace apriltrack {
namespace {

constexpr double kMaxDecimate = 8.0;
constexpr int kMaxHamming = 2;         // what the decoding tables correct
constexpr double kUsualBlur_px = 1.0;  // what fits start from: between a lens in focus and a moving hand
/// Beyond the border, of tags that are cut out along it.
constexpr double kLeastMargin_cells = 0.3;
constexpr double kEdgesErr_px =
    0.5;  // at most, by neighbouring cells' light (docs/algorithms/detector.md, section 5)
/// Kalibr's printed grids, whose black squares touch the tags' corners.
constexpr std::string_view kGridFamily = "tag36h11b2";

[[noreturn]] void refuse(std::string_view option, const std::string& value, std::string_view range) {
  throw invalid_input("detector", fmt::format("{} must be {} (is {})", option, range, value));
}

/// The library reduces images by whole numbers and by one and a half.
void check_decimate(double decimate) {
  if (!(decimate == 1.5 || (decimate >= 1.0 && decimate <= kMaxDecimate && decimate == std::floor(decimate))))
    refuse("decimate", fmt::format("{}", decimate), "1, 1.5, or a whole number from 2 to 8");
}

/// With the corrected bits up to which a reading is looked at.
std::vector<LibraryDetector::Family> families_of(const DetectorOptions& options) {
  std::vector<LibraryDetector::Family> families;
  for (const std::string& name : options.families)
    families.push_back({name, options.max_hamming.value_or(corrected_bits_by_picture(TagFamily::get(name)))});
  return families;
}

}  // namespace

void DetectorOptions::check() const {
  if (families.empty()) refuse("families", "empty", "a list of at least one family");
  for (const std::string& name : families) {
    if (!TagFamily::is_known(name)) TagFamily::get(name);  // its message lists the known names
    if (std::count(families.begin(), families.end(), name) > 1)
      refuse("families", name + " twice", "each named once");
  }
  check_decimate(decimate);
  if (!(min_decision_margin >= 0.0 && min_decision_margin <= 255.0))
    refuse("min_decision_margin", fmt::format("{}", min_decision_margin), "in [0, 255]");
  if (max_hamming && !(*max_hamming >= 0 && *max_hamming <= kMaxHamming))
    refuse("max_hamming", fmt::format("{}", *max_hamming), "in [0, 2]");
}

class Detector::Implementation {
 public:
  explicit Implementation(const DetectorOptions& options)
      : options_((options.check(), options)),
        families_(families_of(options)),
        library_(families_, options.refine_edges),
        has_grids_(std::ranges::find(options.families, kGridFamily) != options.families.end()) {
    library_pixel_offset();  // measured here, once, lest the first image wait for it
  }

  const DetectorOptions& options() const { return options_; }

  FoundTags find(const GrayView& image) { return localised(image, candidates_in(image)); }

  std::vector<Detection> detect_in(const GrayView& image, std::span<const TagRegion> regions,
                                   double decimate) {
    check_decimate(decimate);
    std::vector<Candidate> candidates;
    for (const auto& [area, family] : regions) {
      APRILTRACK_CHECK(area.x >= 0 && area.y >= 0 && area.x + area.width <= image.width() &&
                           area.y + area.height <= image.height(),
                       "regions must lie inside the image");
      std::vector<Candidate> found = find_quickly(image.part(area), family, decimate);
      const Eigen::Vector2d origin(area.x, area.y);
      for (Candidate& candidate : found) {
        for (Eigen::Vector2d& corner : candidate.detection.corners_px) corner += origin;
        candidates.push_back(std::move(candidate));
      }
    }
    return localised(image, std::move(candidates)).detections;
  }

 private:
  struct Corners {
    Quad px;
    std::optional<CornerCovariance> covariance_px2;
  };

  FoundTags localised(const GrayView& image, std::vector<Candidate> candidates) {
    FoundTags found;
    if (has_grids_) drop_one_cell_borders(image, &candidates);
    for (const Candidate& candidate : merge_same_quads(std::move(candidates))) {
      const std::optional<Corners> corners = localise(image, candidate);
      if (!corners || !is_beyond_chance(image, candidate.detection, corners->px)) {
        found.left_out.push_back(
            {candidate.detection, corners ? LeftOutReason::kMayBeChance : LeftOutReason::kEdgesNotFitted});
        continue;
      }
      found.detections.push_back(candidate.detection);
      found.detections.back().corners_px = corners->px;
      found.detections.back().covariance_px2 = corners->covariance_px2;
    }
    sort_detections(found.detections);
    sort_left_out(found.left_out);
    return found;
  }

  /// Finding in linear light alone loses dark tags, in codes as cameras and screens have them alone blurred
  /// ones: both, each tag once.
  std::vector<Candidate> candidates_in(const GrayView& image) {
    const bool is_linear = options_.response.is_linear();
    std::vector<Candidate> candidates;
    if (options_.search_raw_image_only) {
      find_in(image, is_linear, &candidates);
      if (has_grids_) find_joined(image, &candidates);
      return candidates;
    }
    const GrayImage other =
        is_linear ? linear_to_srgb_bytes(image) : to_linear_bytes(image, options_.response);
    const GrayView codes = is_linear ? other.view() : image, light = is_linear ? image : other.view();
    find_in(codes, false, &candidates);
    find_in(light, true, &candidates);
    if (has_grids_) {
      find_joined(codes, &candidates);
      find_joined(light, &candidates);
    }
    return candidates;
  }

  /// In linear light alone. family: as TagRegion's.
  std::vector<Candidate> find_quickly(const GrayView& image, const std::string& family, double decimate) {
    std::optional<std::size_t> family_index;
    if (!family.empty()) {
      const auto one = std::ranges::find(options_.families, family);
      APRILTRACK_CHECK(one != options_.families.end(), "regions must be for families of the options");
      family_index = static_cast<std::size_t>(one - options_.families.begin());
    }
    std::vector<Candidate> candidates;
    const GrayImage linear =
        options_.response.is_linear() ? GrayImage() : to_linear_bytes(image, options_.response);
    const GrayView light = linear.is_empty() ? image : linear.view();
    find_in(light, true, &candidates, decimate, family_index);
    if (has_grids_ && (family.empty() || family == kGridFamily)) find_joined(light, &candidates);
    return candidates;
  }

  /// Kalibr's black squares join the borders of the tags whose corners they touch, and what is joined is no
  /// quad: of 36 tags 23 to 30 are found. With the black shrunk by a pixel they come apart; shrunk by half a
  /// pixel, in an image twice as large, small tags keep more of their borders and give better starts for the
  /// corners (grid_test.cpp).
  void find_joined(const GrayView& image, std::vector<Candidate>* candidates) {
    find_in(shrink_black(image).view(), false, candidates);
    std::vector<Candidate> enlarged;
    find_in(shrink_black(enlarge_twice(image).view()).view(), false, &enlarged);
    for (Candidate& candidate : enlarged) {
      for (Eigen::Vector2d& corner : candidate.detection.corners_px)
        corner = 0.5 * (corner - Eigen::Vector2d::Constant(0.5));
      candidates->push_back(std::move(candidate));
    }
  }

  void find_in(const GrayView& image, bool is_linear_light, std::vector<Candidate>* candidates) {
    find_in(image, is_linear_light, candidates, options_.decimate);
  }

  void find_in(const GrayView& image, bool is_linear_light, std::vector<Candidate>* candidates,
               double decimate, std::optional<std::size_t> family_index = {}) {
    const int contrast = options_.refine_edges ? least_contrast(image, options_.min_decision_margin)
                                               : LibraryDetector::kLibrarysLeastContrast;
    for (const LibraryDetection& found : library_.detect(image, decimate, contrast, family_index)) {
      // A chance code is a thousand times likelier with two wrong bits than with none (sum of C(36, k)
      // patterns).
      const double min_margin = options_.min_decision_margin * (1 + found.hamming);
      if (found.hamming > families_[found.family_index].corrected_bits || found.decision_margin < min_margin)
        continue;
      candidates->push_back({{{options_.families[found.family_index], found.id},
                              found.corners_px,
                              found.hamming,
                              found.decision_margin,
                              std::nullopt},
                             is_linear_light});
    }
  }

  /// Before anything is merged: of a tag with one cell of border the wrong reading may have the better
  /// margin.
  void drop_one_cell_borders(const GrayView& image, std::vector<Candidate>* candidates) const {
    const LightSampler light(image, options_.response);
    std::erase_if(*candidates, [&](const Candidate& candidate) {
      const TagKey& tag = candidate.detection.tag;
      return tag.family == kGridFamily && !has_two_cell_border(light, tag.id, candidate.detection.corners_px);
    });
  }

  /// Where random bits read as the family's codes too often, the picture must show the tag's cells, too. Who
  /// lets more bits be corrected than that would allow takes the risk.
  bool is_beyond_chance(const GrayView& image, const Detection& detection, const Quad& corners_px) const {
    const TagFamily& family = TagFamily::get(detection.tag.family);
    const bool is_risk_taken = options_.max_hamming.value_or(0) > corrected_bits_by_picture(family);
    if (is_risk_taken || detection.hamming.value_or(0) <= corrected_bits_by_code(family)) return true;
    const LightSampler light(image, options_.response);
    return pattern_correlation(light, family.pattern(detection.tag.id), family.has_reversed_border(),
                               corners_px, kLeastPatternCorrelation) >= kLeastPatternCorrelation;
  }

  /// Of the fit, and of its response, where that is in doubt: half of the chance is the rival's, and then all
  /// corners err by what the two fits differ. What the wrong response leaves of the picture is no noise, so
  /// that of noise the better fit tells. Of the fit alone where the rival fits nothing.
  std::optional<CornerCovariance> covariance_of(const GrayView& image, const TagPattern& shown,
                                                const FittedPattern& fitted,
                                                const CameraModel* camera) const {
    if (!options_.rival_response) return fitted.covariance_px2;
    constexpr double kPixel_px2 = 1.0 / 12.0;  // variance of a pixel's own area
    const auto rival =
        fit_pattern(LightSampler(image, *options_.rival_response), shown,
                    {fitted.corners_px, std::sqrt(0.5 * fitted.blur_px2.trace() + kPixel_px2), camera});
    if (!rival) return fitted.covariance_px2;
    Eigen::Matrix<double, 8, 1> difference_px;
    for (std::size_t k = 0; k < kNumCorners; ++k)
      difference_px.segment<2>(2 * static_cast<Eigen::Index>(k)) =
          rival->corners_px[k] - fitted.corners_px[k];
    constexpr double kProbabilityOfRival = 0.5;
    const bool is_rival_better = rival->covariance_px2.trace() < fitted.covariance_px2.trace();
    return (is_rival_better ? *rival : fitted).covariance_px2 +
           kProbabilityOfRival * difference_px * difference_px.transpose();
  }

  /// Quads found in linear light are nearer to the truth, so they are tried first. nullopt when no start
  /// leads to a picture of this tag: something hides too much of it, or the code was read by chance. Below 1
  /// % of what is found (bench/detector_accuracy.cpp).
  std::optional<Corners> localise(const GrayView& image, const Candidate& candidate) const {
    std::vector<Candidate> starts = candidate.others;
    starts.insert(starts.begin(), candidate);
    std::stable_partition(starts.begin(), starts.end(),
                          [](const Candidate& c) { return c.is_from_linear_light; });
    if (!options_.refine_edges) return Corners{starts.front().detection.corners_px, std::nullopt};
    const TagKey& tag = candidate.detection.tag;
    const TagFamily& family = TagFamily::get(tag.family);
    const TagPattern pattern = family.pattern(tag.id);
    const LightSampler light(image, options_.response);
    const CameraModel* camera = options_.camera_model ? &*options_.camera_model : nullptr;
    const auto fit = [&](const TagPattern& shown, const Quad& quad, double blur_sigma_px) {
      const auto fitted = fit_pattern(light, shown, {quad, blur_sigma_px, camera});
      if (!fitted) return std::optional<Corners>();
      return std::optional(Corners{fitted->corners_px, covariance_of(image, shown, *fitted, camera)});
    };
    for (const Candidate& start : starts) {
      const Quad& quad = start.detection.corners_px;
      // Most quads of the library are near enough; edges lead there from farther off.
      if (const auto corners = fit(pattern, quad, kUsualBlur_px)) return corners;
      const auto edges_within = [&](double margin_cells) {
        return refine_corners(image, options_.response, pattern, family.has_reversed_border(), quad,
                              margin_cells);
      };
      if (const auto edges = edges_within(kWholeMargin_cells)) {
        const auto corners = fit(pattern, edges->corners_px, edges->blur_sigma_px);
        return corners ? corners : Corners{edges->corners_px, std::nullopt};
      }
      // Perhaps cut out with less white than the family prints. What is fitted then ends where the corners
      // are, so edges must say the same.
      if (family.has_reversed_border()) continue;
      const auto edges = edges_within(kLeastMargin_cells);
      const auto corners = edges ? fit(without_margin(pattern), edges->corners_px, edges->blur_sigma_px)
                                 : fit(without_margin(pattern), quad, kUsualBlur_px);
      if (corners && (!edges || largest_distance(corners->px, edges->corners_px) < kEdgesErr_px))
        return corners;
      if (edges) return Corners{edges->corners_px, std::nullopt};
    }
    return std::nullopt;
  }

  DetectorOptions options_;
  std::vector<LibraryDetector::Family> families_;
  LibraryDetector library_;
  bool has_grids_;
};

namespace {

void check_rows(const GrayView& image) {
  APRILTRACK_CHECK(
      image.is_empty() || image.stride() >= image.width(),
      "an image's rows lie one behind the other in memory, the first one first (stride >= width)");
}

}  // namespace

Detector::Detector(const DetectorOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

std::vector<Detection> Detector::detect(const GrayView& image) {
  return find(image).detections;
}

FoundTags Detector::find(const GrayView& image) {
  check_rows(image);
  return held(implementation_).find(image);
}

std::vector<Detection> Detector::detect_in(const GrayView& image, std::span<const TagRegion> regions,
                                           double decimate) {
  check_rows(image);
  return held(implementation_).detect_in(image, regions, decimate);
}

const DetectorOptions& Detector::options() const {
  return held(implementation_).options();
}

}  // namespace apriltrack
