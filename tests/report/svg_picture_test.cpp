// Drawings are read by the same two parsers as pages (read_page.py).
#include "apriltrack/report/svg_picture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <sstream>

#include "apriltrack/base/check.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/report/html_page.h"
#include "page_elements.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(SvgPicture, StandsInThePageWithItsWordsEscaped) {
  SvgPicture picture(200.0, 100.0);
  picture.text({10.0, 20.0}, "a < b & \"c\"", {.is_bold = true, .has_halo = true});
  picture.line({0.0, 0.0}, {5.0, 6.0}, {.tooltip = "<tip> & more"});
  HtmlPage page("title");
  page.svg(picture, "what <it> shows");
  page.svg(std::vector<SvgPicture>{picture, picture}, "both");
  page.warnings({"beware <of> it"});
  page.list({"one & two"});
  const auto lines = test::elements_of(page);
  EXPECT_THAT(lines, Contains(HasSubstr("viewbox=0 0 200 100 role=img aria-label=what <it> shows")));
  EXPECT_THAT(lines,
              Contains(testing::AllOf(testing::StartsWith("text|"), testing::EndsWith("|a < b & \"c\""))));
  EXPECT_THAT(lines, Contains("title||<tip> & more"));
  EXPECT_THAT(lines, Contains("figcaption||what <it> shows"));
  EXPECT_THAT(lines, Contains("p|class=alarm|beware <of> it"));
  EXPECT_THAT(lines, Contains("li||one & two"));
  EXPECT_THAT(page.html(), Not(HasSubstr("http:")));
}

TEST(SvgPicture, EllipsesLieAlongTheAxesOfTheirCovariance) {
  // 9 along 30 degrees, 4 across: radii 3 and 2.
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(std::numbers::pi / 6.0).toRotationMatrix();
  SvgPicture picture(100.0, 100.0);
  picture.ellipse({40.0, 50.0}, R * Eigen::Vector2d(9.0, 4.0).asDiagonal() * R.transpose(), {});
  const std::string drawn = picture.element("");
  EXPECT_THAT(drawn, HasSubstr("rx=\"3\" ry=\"2\""));
  EXPECT_THAT(drawn, HasSubstr("translate(40 50)"));
  const double turned = std::stod(drawn.substr(drawn.find("rotate(") + 7));
  EXPECT_NEAR(std::remainder(turned - 30.0, 180.0), 0.0, 0.01);
}

TEST(SvgPicture, ArrowsPointWhereTheyEnd) {
  SvgPicture picture(100.0, 100.0);
  picture.arrow({10.0, 10.0}, {30.0, 10.0}, {}, 5.0);
  EXPECT_THAT(picture.element(""), HasSubstr("x1=\"10\" y1=\"10\" x2=\"30\" y2=\"10\""));
  EXPECT_THAT(picture.element(""), HasSubstr("points=\"30,10 25,"));
  SvgPicture none(100.0, 100.0);
  none.arrow({10.0, 10.0}, {10.0, 10.0}, {});
  EXPECT_THAT(none.element(""), Not(HasSubstr("polygon")));
}

TEST(SvgPicture, RefusesWhatIsNoNumber) {
  SvgPicture picture(100.0, 100.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(picture.circle({nan, 0.0}, 1.0, {}), MisuseError);
  EXPECT_THROW(SvgPicture(0.0, 10.0), MisuseError);
}

}  // namespace
}  // namespace apriltrack
