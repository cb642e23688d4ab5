#include "apriltrack/report/svg_picture.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>

#include "apriltrack/base/check.h"
#include "html_text.h"
#include "svg_inks.h"

namespace apriltrack {
namespace {

std::string colour_of_ink(SvgInk ink) {
  return ink == SvgInk::kNone ? "none" : fmt::format("var({})", ink_variable(ink));
}

std::string number(double value) {
  APRILTRACK_CHECK(std::isfinite(value), "a drawing's numbers are finite");
  return fmt::format("{:.5g}", std::abs(value) < 1e-9 ? 0.0 : value);
}

std::string points_of(std::span<const Eigen::Vector2d> points) {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    if (!text.empty()) text += ' ';
    text += number(point.x()) + "," + number(point.y());
  }
  return text;
}

std::string css_of(const SvgStyle& style) {
  std::string text = fmt::format("fill:{};stroke:{};stroke-width:{}", colour_of_ink(style.fill),
                                 colour_of_ink(style.stroke), number(style.width));
  if (style.opacity < 1.0) text += ";opacity:" + number(style.opacity);
  if (style.fill_opacity < 1.0) text += ";fill-opacity:" + number(style.fill_opacity);
  if (style.is_dashed) text += ";stroke-dasharray:4 3";
  return text;
}

}  // namespace

std::string_view ink_variable(SvgInk ink) {
  constexpr std::string_view kVariables[] = {
      "",       "--ink",     "--pale",   "--rule", "--tint",  "--paper", "--accent",    "--path",
      "--good", "--warning", "--orange", "--sky",  "--green", "--blue",  "--vermilion", "--purple"};
  return kVariables[static_cast<std::size_t>(ink)];
}

SvgInk ink_of(const Colour& colour) {
  constexpr std::pair<Colour, SvgInk> kInks[] = {{kBlack, SvgInk::kText},
                                                 {kPaleGrey, SvgInk::kPale},
                                                 {kOrange, SvgInk::kOrangeInk},
                                                 {kSkyBlue, SvgInk::kSkyInk},
                                                 {kBlue, SvgInk::kBlueInk},
                                                 {kBluishGreen, SvgInk::kGreenInk},
                                                 {kVermilion, SvgInk::kVermilionInk},
                                                 {kReddishPurple, SvgInk::kPurpleInk}};
  const auto* found = std::ranges::find(kInks, colour, &std::pair<Colour, SvgInk>::first);
  APRILTRACK_CHECK(found != std::end(kInks), "a drawing's colours are of the palette");
  return found->second;
}

double svg_width_of(std::string_view words, double letter_size) {
  constexpr double kMeanLetter = 0.56;  // of its size, in sans-serif fonts
  return kMeanLetter * letter_size * static_cast<double>(words.size());
}

SvgPicture::SvgPicture(double width, double height) : width_(width), height_(height) {
  APRILTRACK_CHECK(width > 0.0 && height > 0.0, "a picture has a width and a height");
}

void SvgPicture::add(const std::string& name, const std::string& attributes, const SvgStyle& style) {
  // Opacity is of a group as a whole: what overlaps in it would not be seen through.
  const std::string css = css_of(style);
  if (style.opacity < 1.0) {
    end_group();
    body_ += fmt::format("<{}{} style=\"{}\"", name, attributes, css);
  } else {
    if (css != group_css_) {
      end_group();
      body_ += fmt::format("<g style=\"{}\">\n", css);
      group_css_ = css;
    }
    body_ += fmt::format("<{}{}", name, attributes);
  }
  if (style.tooltip.empty()) {
    body_ += "/>\n";
  } else {
    body_ += fmt::format("><title>{}</title></{}>\n", escaped(style.tooltip), name);
  }
}

void SvgPicture::end_group() {
  if (!group_css_.empty()) body_ += "</g>\n";
  group_css_.clear();
}

void SvgPicture::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStyle& style) {
  add("line",
      fmt::format(" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"", number(from.x()), number(from.y()),
                  number(to.x()), number(to.y())),
      style);
}

void SvgPicture::arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStyle& style,
                       double head) {
  line(from, to, style);
  const double length = (to - from).norm();
  if (!(length > 1e-9)) return;
  const Eigen::Vector2d along = (to - from) / length * std::min(head, length);
  const Eigen::Vector2d aside(-0.42 * along.y(), 0.42 * along.x());
  const Eigen::Vector2d corners[] = {to, to - along + aside, to - along - aside};
  polygon(corners, {.stroke = SvgInk::kNone, .fill = style.stroke, .opacity = style.opacity});
}

void SvgPicture::polyline(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  if (points.size() > 1) add("polyline", fmt::format(" points=\"{}\"", points_of(points)), style);
}

void SvgPicture::polygon(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  add("polygon", fmt::format(" points=\"{}\"", points_of(points)), style);
}

void SvgPicture::rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                           const SvgStyle& style) {
  add("rect",
      fmt::format(" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", number(corner.x()), number(corner.y()),
                  number(size.x()), number(size.y())),
      style);
}

void SvgPicture::circle(const Eigen::Vector2d& center, double radius, const SvgStyle& style) {
  add("circle",
      fmt::format(" cx=\"{}\" cy=\"{}\" r=\"{}\"", number(center.x()), number(center.y()), number(radius)),
      style);
}

void SvgPicture::dots(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  if (points.empty()) return;
  std::string path;
  for (const Eigen::Vector2d& point : points)
    path +=
        fmt::format("M{} {}h0", number(point.x()), number(point.y()));  // a line of no length has round ends
  add("path", fmt::format(" d=\"{}\" stroke-linecap=\"round\"", path), style);
}

void SvgPicture::ellipse(const Eigen::Vector2d& center, const Eigen::Matrix2d& covariance,
                         const SvgStyle& style) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const auto radius = [&](Eigen::Index i) { return number(std::sqrt(std::max(0.0, axes.eigenvalues()[i]))); };
  const Eigen::Vector2d longest = axes.eigenvectors().col(1);
  add("ellipse",
      fmt::format(" rx=\"{}\" ry=\"{}\" transform=\"translate({} {}) rotate({})\"", radius(1), radius(0),
                  number(center.x()), number(center.y()),
                  number(std::atan2(longest.y(), longest.x()) * 180.0 / std::numbers::pi)),
      style);
}

void SvgPicture::text(const Eigen::Vector2d& at, const std::string& words, const SvgTextStyle& style) {
  constexpr std::string_view kAnchors[] = {"start", "middle", "end"};
  const std::string turn = style.turned_degrees == 0.0
                               ? std::string()
                               : fmt::format(" transform=\"rotate({} {} {})\"", number(style.turned_degrees),
                                             number(at.x()), number(at.y()));
  end_group();
  body_ += fmt::format(
      "<text x=\"{}\" y=\"{}\"{} style=\"font-size:{}px;fill:{};text-anchor:{}{}{}\">{}</text>\n",
      number(at.x()), number(at.y()), turn, number(style.size), colour_of_ink(style.ink),
      kAnchors[static_cast<std::size_t>(style.anchor)], style.is_bold ? ";font-weight:600" : "",
      style.has_halo ? ";paint-order:stroke;stroke:var(--paper);stroke-width:3px;stroke-linejoin:round" : "",
      escaped(words));
}

std::string SvgPicture::element(const std::string& label) const {
  return fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\" style=\"max-width:{0}px\">\n{3}{4}</svg>",
      number(width_), number(height_), escaped(label), body_, group_css_.empty() ? "" : "</g>\n");
}

}  // namespace apriltrack
