#include "apriltrack/report/svg_picture.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "apriltrack/base/check.h"
#include "html_text.h"

namespace apriltrack {
namespace {

/// Variables of the page's style.
std::string_view colour_of_ink(SvgInk ink) {
  switch (ink) {
    case SvgInk::kNone:
      return "none";
    case SvgInk::kText:
      return "var(--ink)";
    case SvgInk::kPale:
      return "var(--pale)";
    case SvgInk::kRule:
      return "var(--rule)";
    case SvgInk::kTint:
      return "var(--tint)";
    case SvgInk::kPaper:
      return "var(--paper)";
    case SvgInk::kAccent:
      return "var(--accent)";
    case SvgInk::kPath:
      return "var(--path)";
    case SvgInk::kGood:
      return "var(--good)";
    case SvgInk::kWarning:
      return "var(--warning)";
  }
  return "none";
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

std::string attributes_of(const SvgStyle& style) {
  std::string text = fmt::format(" style=\"fill:{};stroke:{};stroke-width:{}", colour_of_ink(style.fill),
                                 colour_of_ink(style.stroke), number(style.width));
  if (style.opacity < 1.0) text += ";opacity:" + number(style.opacity);
  if (style.fill_opacity < 1.0) text += ";fill-opacity:" + number(style.fill_opacity);
  if (style.is_dashed) text += ";stroke-dasharray:4 3";
  return text + "\"";
}

}  // namespace

SvgPicture::SvgPicture(double width, double height) : width_(width), height_(height) {
  APRILTRACK_CHECK(width > 0.0 && height > 0.0, "a picture has a width and a height");
}

void SvgPicture::add(const std::string& name, const std::string& attributes, const SvgStyle& style) {
  body_ += fmt::format("<{}{}{}", name, attributes, attributes_of(style));
  if (style.tooltip.empty()) {
    body_ += "/>\n";
  } else {
    body_ += fmt::format("><title>{}</title></{}>\n", escaped(style.tooltip), name);
  }
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
  body_ += fmt::format(
      "<text x=\"{}\" y=\"{}\"{} style=\"font-size:{}px;fill:{};text-anchor:{}{}{}\">{}</text>\n",
      number(at.x()), number(at.y()), turn, number(style.size), colour_of_ink(style.ink),
      kAnchors[static_cast<std::size_t>(style.anchor)], style.is_bold ? ";font-weight:600" : "",
      style.has_halo ? ";paint-order:stroke;stroke:var(--paper);stroke-width:3px;stroke-linejoin:round" : "",
      escaped(words));
}

std::string SvgPicture::element(const std::string& label) const {
  return fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\" style=\"max-width:{0}px\">\n{3}</svg>",
      number(width_), number(height_), escaped(label), body_);
}

}  // namespace apriltrack
