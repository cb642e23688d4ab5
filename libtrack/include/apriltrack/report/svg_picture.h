#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

namespace apriltrack {

/// What a thing is drawn in: on a page these follow light and dark surroundings.
enum class SvgInk {
  kNone,
  kText,
  kPale,
  kRule,
  kTint,
  kPaper,
  kAccent,
  kPath,
  kGood,
  kWarning,
  // The palette of colour.h, somewhat lighter on dark pages.
  kOrangeInk,
  kSkyInk,
  kGreenInk,
  kBlueInk,
  kVermilionInk,
  kPurpleInk
};

struct SvgStyle {
  SvgInk stroke = SvgInk::kText;
  double width = 1.0;  ///< Of lines.
  SvgInk fill = SvgInk::kNone;
  double opacity = 1.0;
  double fill_opacity = 1.0;
  bool is_dashed = false;
  std::string tooltip = {};  ///< Shown where a pointer rests on it.
};

enum class SvgAnchor { kStart, kMiddle, kEnd };

struct SvgTextStyle {
  double size = 12.0;
  SvgInk ink = SvgInk::kText;
  SvgAnchor anchor = SvgAnchor::kStart;
  bool is_bold = false;
  bool has_halo = false;        ///< Of the paper's colour, so that it can be read on top of lines.
  double turned_degrees = 0.0;  ///< Clockwise.
};

/// A drawing that a page holds as it is: sharp at any size, its letters can be searched. In its own units, y
/// down. Text is escaped. Points must be finite.
class SvgPicture {
 public:
  /// Requires a width and a height above 0.
  SvgPicture(double width, double height);

  double width() const { return width_; }
  double height() const { return height_; }

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStyle& style);
  /// With a head at its end, as long as the arrow is at most.
  void arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStyle& style,
             double head = 5.0);
  void polyline(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  void polygon(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const SvgStyle& style);
  void circle(const Eigen::Vector2d& center, double radius, const SvgStyle& style);
  /// Round dots in the colour of the stroke, as wide as the style's width: one element, however many.
  void dots(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  /// Where x' covariance^-1 x = 1, around the centre.
  void ellipse(const Eigen::Vector2d& center, const Eigen::Matrix2d& covariance, const SvgStyle& style);
  void text(const Eigen::Vector2d& at, const std::string& words, const SvgTextStyle& style = {});

  /// The element, for HtmlPage::svg. label: what it shows, for those who cannot see it.
  std::string element(const std::string& label) const;

 private:
  void add(const std::string& name, const std::string& attributes, const SvgStyle& style);
  void end_group();

  double width_, height_;
  std::string body_;
  std::string group_css_;  ///< Of the elements that are being added, which share it; empty: none.
};

}  // namespace apriltrack
