#include "camera_fields.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

double positive_focal_length(double focal, const char* name, const YamlNode& node) {
  if (!(focal > 0.0)) node.fail(fmt::format("{} must be > 0 pixels (is {})", name, focal));
  return focal;
}

Distortion read_radtan(const YamlNode& node, std::string_view model) {
  const std::vector<double> values = without_zero_tail(read_matrix_data(node), node);
  if (values.size() != 4 && values.size() != 5 && values.size() != 8) {
    node.fail(fmt::format("{} takes 4, 5 or 8 coefficients, k1 k2 p1 p2 [k3 [k4 k5 k6]] (there are {})",
                          model, values.size()));
  }
  return RadtanDistortion(values);
}

Distortion read_equidistant(const YamlNode& node, std::string_view model) {
  const std::vector<double> values = read_matrix_data(node);
  if (values.size() != 4) {
    node.fail(fmt::format("{} takes 4 coefficients, k1 k2 k3 k4 (there are {})", model, values.size()));
  }
  return EquidistantDistortion(values);
}

Distortion read_none(const YamlNode* node) {
  if (node && !node->is_null() && !read_matrix_data(*node).empty()) {
    node->fail("must be empty for a lens without distortion; name the lens's model (radtan or equidistant)");
  }
  return NoDistortion();
}

}  // namespace

Pinhole checked_pinhole(double fx, double fy, double cx, double cy, const YamlNode& node) {
  return {positive_focal_length(fx, "fx", node), positive_focal_length(fy, "fy", node), cx, cy};
}

Pinhole read_pinhole_list(const YamlNode& node) {
  const std::vector<double> values = node.as_doubles();
  if (values.size() != 4)
    node.fail(fmt::format("must be [fx, fy, cx, cy], 4 numbers (there are {})", values.size()));
  return checked_pinhole(values[0], values[1], values[2], values[3], node);
}

std::vector<double> read_matrix_values(const YamlNode& node) {
  const bool is_nested = node.is_list() && !node.items().empty() && node.items().front().is_list();
  if (!is_nested) return read_matrix_data(node);
  std::vector<double> values;
  const std::size_t num_columns = node.items().front().items().size();
  for (const YamlNode& row : node.items()) {
    for (const double value : row.as_doubles(num_columns)) values.push_back(value);
  }
  return values;
}

SkewedPinhole read_pinhole_matrix(const YamlNode& node) {
  const std::vector<double> k = read_matrix_values(node);
  if (k.size() != 9) node.fail(fmt::format("must be a 3x3 matrix, 9 numbers (there are {})", k.size()));
  if (k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    node.fail(fmt::format("must be fx 0 cx / 0 fy cy / 0 0 1, row by row (is {})", fmt::join(k, " ")));
  }
  return {checked_pinhole(k[0], k[4], k[2], k[5], node), k[1]};
}

std::vector<double> read_matrix_data(const YamlNode& node) {
  if (!node.is_map()) return node.as_doubles();
  const std::vector<double> values = node.at("data").as_doubles();
  const auto rows = node.find("rows");
  const auto cols = node.find("cols");
  if (!rows || !cols) return values;
  const long long expected = static_cast<long long>(rows->as_int()) * cols->as_int();
  if (expected != static_cast<long long>(values.size())) {
    node.fail(fmt::format("rows x cols is {}, but data has {} numbers", expected, values.size()));
  }
  return values;
}

std::vector<double> without_zero_tail(std::vector<double> values, const YamlNode& node) {
  if (values.size() != 12 && values.size() != 14) return values;
  if (std::any_of(values.begin() + 8, values.end(), [](double value) { return value != 0.0; })) {
    node.fail(fmt::format(
        "has {} coefficients, and those after the eighth (thin prism s1..s4, tilted sensor tau_x tau_y) are "
        "not zero; supported are k1 k2 p1 p2 [k3 [k4 k5 k6]]: calibrate without these terms (OpenCV: "
        "CALIB_RATIONAL_MODEL alone){}",
        values.size(),
        values.size() == 12 ? ", or fit eight: mrcal-convert-lensmodel LENSMODEL_OPENCV8" : ""));
  }
  values.resize(8);
  return values;
}

Distortion read_distortion(const std::string& model, const YamlNode* coefficients, const YamlNode& node) {
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), model) != names.end();
  };
  if (is_one_of({"none", ""})) return read_none(coefficients);
  const bool is_fisheye = is_one_of({"equidistant", "equi", "fisheye"});
  if (!is_fisheye && !is_one_of({"radtan", "radial-tangential", "plumb_bob", "rational_polynomial"})) {
    node.fail(
        fmt::format("'{}' is not supported; supported are none, radtan (also plumb_bob, rational_polynomial, "
                    "radial-tangential) and equidistant (also fisheye): calibrate with one of these",
                    model));
  }
  if (!coefficients)
    node.fail("the distortion coefficients are missing; write zeros for a lens without distortion");
  return is_fisheye ? read_equidistant(*coefficients, model) : read_radtan(*coefficients, model);
}

Resolution read_resolution(const YamlNode& width, const YamlNode& height) {
  const auto side = [](const YamlNode& node, const char* name) {
    const int pixels = node.as_int();
    if (pixels < 1 || pixels > kMaxResolution) {
      node.fail(fmt::format("{} must lie in [1, {}] pixels (is {})", name, kMaxResolution, pixels));
    }
    return pixels;
  };
  return {side(width, "width"), side(height, "height")};
}

Resolution read_resolution_list(const YamlNode& node) {
  node.as_doubles(2);
  const auto sides = node.items();
  return read_resolution(sides[0], sides[1]);
}

void require_resolution(const Camera& camera, const std::filesystem::path& path) {
  if (camera.width > 0 && camera.height > 0) return;
  throw invalid_input(
      path.string(), fmt::format("camera '{}' has no resolution, which this format needs: give its width and "
                                 "height (`camera convert --resolution WIDTHxHEIGHT`)",
                                 camera.name));
}

std::optional<std::string> fault_of_camera_name(std::string_view name) {
  if (name.empty()) return "must not be empty";
  const auto is_wrong = [](char c) {
    return (c >= 0 && c < 0x20) || c == 0x7f || std::string_view(",=/\"\\").find(c) != std::string_view::npos;
  };
  if (std::none_of(name.begin(), name.end(), is_wrong)) return std::nullopt;
  return "must not hold any of , = / \" \\ or a control character";
}

}  // namespace apriltrack
