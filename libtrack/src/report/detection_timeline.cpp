#include "apriltrack/report/detection_timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"
#include "canvas.h"

namespace apriltrack {
namespace {

// Layout in points.
constexpr double kPageWidth = 1200.0;
constexpr double kPageMargin = 60.0;
constexpr double kInner = kPageWidth - 2.0 * kPageMargin;
constexpr double kTitleHeight = 70.0;
constexpr double kExampleGap = 16.0;
constexpr double kExampleCaptionHeight = 30.0;
constexpr double kTitleRoom = 30.0;   // above the chart, for the axis's title
constexpr double kLeaderRoom = 70.0;  // with it, for the leaders from the examples
constexpr double kChartHeight = 260.0;
constexpr double kFooterHeight = 96.0;

struct Legend {
  FrameOutcome outcome;
  const char* words;
  Colour colour;
};
const Legend kLegend[] = {
    {FrameOutcome::kPoseRight, "pose within 5 px", kBluishGreen},
    {FrameOutcome::kPoseWrong, "pose over 5 px off", kOrange},
    {FrameOutcome::kBlind, "blind: tags in view, no pose", kVermilion},
    {FrameOutcome::kNoTagInView, "no tag in view", kPaleGrey},
};

cv::Scalar colour_of(FrameOutcome outcome) {
  return bgr_of(std::find_if(std::begin(kLegend), std::end(kLegend), [&](const Legend& l) {
                  return l.outcome == outcome;
                })->colour);
}

struct Strip {
  double width = 0.0;  // of one picture
  double height = 0.0;
};

Strip example_strip(std::span<const ExampleFrame> examples) {
  if (examples.empty()) return {};
  const auto count = static_cast<double>(examples.size());
  const double width = (kInner - kExampleGap * (count - 1.0)) / count;
  double tallest = 0.0;
  for (const ExampleFrame& example : examples)
    tallest = std::max(tallest, width * example.image.height() / example.image.width());
  return {width, tallest};
}

void draw_tag_outline(Canvas& canvas, const TagOutline& outline, cv::Point2d origin, double scale) {
  const auto place = [&](const Eigen::Vector2d& pixel) {
    return cv::Point2d(origin.x + scale * (pixel.x() + 0.5), origin.y + scale * (pixel.y() + 0.5));
  };
  for (std::size_t i = 0; i < 4; ++i) {
    canvas.line(place(outline.corners_px[i]), place(outline.corners_px[(i + 1) % 4]),
                colour_of(outline.outcome), 2.0);
  }
}

void draw_examples(Canvas& canvas, std::span<const ExampleFrame> examples, const Strip& strip) {
  double x = kPageMargin;
  for (const ExampleFrame& example : examples) {
    const double scale = strip.width / example.image.width();
    canvas.picture(example.image, {x, kTitleHeight, strip.width, scale * example.image.height()});
    for (const TagOutline& outline : example.outlines)
      draw_tag_outline(canvas, outline, {x, kTitleHeight}, scale);
    canvas.text(example.caption, {x, kTitleHeight + strip.height + 20.0}, 11.0, kInk);
    x += strip.width + kExampleGap;
  }
}

/// Where times and blurs lie on the canvas.
struct Axes {
  double top, start_s, end_s, max_blur_px;
  double slot;  // of one frame's bar; half of it is left free at either end, for the first and the last

  double x(double time_s) const {
    return kPageMargin + 0.5 * slot + (kInner - slot) * (time_s - start_s) / (end_s - start_s);
  }
  double y(double blur_px) const { return top + kChartHeight * (1.0 - std::min(blur_px / max_blur_px, 1.0)); }
};

Axes axes_for(std::span<const TimelineFrame> frames, double top) {
  double max_blur = 10.0;
  for (const TimelineFrame& frame : frames) max_blur = std::max(max_blur, frame.blur_px);
  const double start = frames.front().time_s;
  return {top, start, std::max(frames.back().time_s, start + 1e-3), 10.0 * std::ceil(max_blur / 10.0),
          kInner / static_cast<double>(frames.size())};
}

void draw_timeline_grid(Canvas& canvas, const Axes& axes) {
  const double blur_step = axes.max_blur_px > 50.0 ? 20.0 : 10.0;
  for (double blur = 0.0; blur <= axes.max_blur_px + 1e-9; blur += blur_step) {
    canvas.line({kPageMargin, axes.y(blur)}, {kPageMargin + kInner, axes.y(blur)}, kGrid);
    canvas.text(fmt::format("{:.0f}", blur), {kPageMargin - 8.0, axes.y(blur) + 4.0}, 9.0, kPaleInk,
                Canvas::Align::kRight);
  }
  const double duration = axes.end_s - axes.start_s;
  const double step = std::max(1.0, std::ceil(duration / 10.0));
  for (double t = 0.0; t <= duration + 1e-9; t += step) {
    canvas.text(fmt::format("{:.0f} s", t), {axes.x(axes.start_s + t), axes.top + kChartHeight + 18.0}, 9.0,
                kPaleInk, Canvas::Align::kCentre);
  }
}

/// A sharp frame shows its colour too.
double top_of_bar(const TimelineFrame& frame, const Axes& axes) {
  return std::min(axes.y(frame.blur_px), axes.y(0.0) - 2.0);
}

void draw_bars(Canvas& canvas, std::span<const TimelineFrame> frames, const Axes& axes) {
  for (const TimelineFrame& frame : frames) {
    const double top = top_of_bar(frame, axes);
    canvas.box({axes.x(frame.time_s) - 0.5 * axes.slot, top, std::max(axes.slot, 1.0), axes.y(0.0) - top},
               colour_of(frame.outcome));
  }
}

/// From an example's caption to above its frame's bar, and straight down onto it.
struct Leader {
  cv::Point2d start, bend, end;
};

std::vector<Leader> leaders(std::span<const TimelineFrame> frames, std::span<const ExampleFrame> examples,
                            const Strip& strip, const Axes& axes) {
  std::vector<Leader> lines;
  double x = kPageMargin + 0.5 * strip.width;
  for (const ExampleFrame& example : examples) {
    const TimelineFrame& frame = *std::ranges::min_element(
        frames, {}, [&](const TimelineFrame& f) { return std::abs(f.time_s - example.time_s); });
    const double bar = axes.x(frame.time_s);
    lines.push_back(
        {{x, axes.top - kLeaderRoom}, {bar, axes.top - kTitleRoom}, {bar, top_of_bar(frame, axes)}});
    x += strip.width + kExampleGap;
  }
  return lines;
}

/// At the left end of the chart, or where a leader comes down there, at the right one.
void draw_blur_title(Canvas& canvas, const std::vector<Leader>& lines, const Axes& axes) {
  constexpr double kHeight = 10.0, kAir = 12.0;
  constexpr double kHalo = 3.0;  // where leaders come down at both ends, behind the letters
  const std::string words = "motion blur of the worst corner, px";
  const double end = kPageMargin + Canvas::width_of(words, kHeight) + kAir;
  const bool is_left_free = std::ranges::none_of(lines, [&](const Leader& line) { return line.end.x < end; });
  const double x = is_left_free ? kPageMargin : kPageMargin + kInner;
  canvas.text(words, {x, axes.top - 10.0}, kHeight, kPaleInk,
              is_left_free ? Canvas::Align::kLeft : Canvas::Align::kRight, kHalo);
}

void draw_leaders(Canvas& canvas, const std::vector<Leader>& lines) {
  for (const Leader& line : lines) {
    canvas.line(line.start, line.bend, kPaleInk);
    canvas.line(line.bend, line.end, kPaleInk);
    canvas.disc(line.end, 3.0, kPaleInk);
  }
}

void draw_legend(Canvas& canvas, std::span<const TimelineFrame> frames, double y) {
  double x = kPageMargin;
  for (const Legend& entry : kLegend) {
    const auto count = std::count_if(frames.begin(), frames.end(), [&](const TimelineFrame& frame) {
      return frame.outcome == entry.outcome;
    });
    const double share = 100.0 * static_cast<double>(count) / static_cast<double>(frames.size());
    canvas.box({x, y - 11.0, 14.0, 14.0}, bgr_of(entry.colour));
    x = canvas.text(fmt::format("{}  {:.0f} %", entry.words, share), {x + 22.0, y}, 10.5, kInk) + 32.0;
  }
}

}  // namespace

void write_detection_timeline(const std::filesystem::path& path, const std::string& title,
                              std::span<const TimelineFrame> frames, std::span<const ExampleFrame> examples) {
  APRILTRACK_CHECK(!frames.empty(), "a time line needs at least one frame");
  const Strip strip = example_strip(examples);
  const double chart_top = kTitleHeight + strip.height + kExampleCaptionHeight + kLeaderRoom;
  Canvas canvas(static_cast<int>(kPageWidth), static_cast<int>(chart_top + kChartHeight + kFooterHeight));
  const Axes axes = axes_for(frames, chart_top);
  canvas.text(title, {kPageMargin, 42.0}, 16.0, kInk);
  draw_examples(canvas, examples, strip);
  draw_timeline_grid(canvas, axes);
  draw_bars(canvas, frames, axes);
  const std::vector<Leader> lines = leaders(frames, examples, strip, axes);
  draw_leaders(canvas, lines);
  draw_blur_title(canvas, lines, axes);
  draw_legend(canvas, frames, chart_top + kChartHeight + 60.0);
  canvas.write_png(path);
}

}  // namespace apriltrack
