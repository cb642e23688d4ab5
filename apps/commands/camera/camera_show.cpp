#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/eval/statistics.h"
#include "camera_command.h"
#include "cli/command_help.h"
#include "cli/console.h"
#include "files/inputs.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

struct ShowOptions {
  std::string file;
  std::string topic;
  Console console;
};

/// Angles from one edge of the picture to the other, through the principal point and from corner to corner;
/// nullopt where the lens model ends before, or the size is not known.
struct FieldOfView {
  std::optional<double> horizontal_deg;
  std::optional<double> vertical_deg;
  std::optional<double> diagonal_deg;
};

std::optional<double> angle_from_axis_deg(const Camera& camera, double x, double y) {
  const auto ray = camera.model.unproject({x, y});
  if (!ray) return std::nullopt;
  return kDegPerRad * std::atan2(ray->head<2>().norm(), ray->z());
}

/// Two pixels on opposite sides of the axis; for a fisheye the sum may be above 180.
std::optional<double> angle_between_deg(const Camera& camera, const Eigen::Vector2d& a,
                                        const Eigen::Vector2d& b) {
  const auto angle_a = angle_from_axis_deg(camera, a.x(), a.y());
  const auto angle_b = angle_from_axis_deg(camera, b.x(), b.y());
  if (!angle_a || !angle_b) return std::nullopt;
  return *angle_a + *angle_b;
}

FieldOfView field_of_view(const Camera& camera) {
  if (camera.width == 0) return {};
  const Pinhole& lens = camera.model.pinhole();
  const double right = camera.width - 0.5;  // pixel (0, 0) is a centre: the picture begins at -0.5
  const double bottom = camera.height - 0.5;
  return {angle_between_deg(camera, {-0.5, lens.cy}, {right, lens.cy}),
          angle_between_deg(camera, {lens.cx, -0.5}, {lens.cx, bottom}),
          angle_between_deg(camera, {-0.5, -0.5}, {right, bottom})};
}

std::vector<double> coefficients_of(const Camera& camera) {
  return std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion());
}

std::string response_text(const Camera& camera) {
  return camera.response_origin == ResponseOrigin::kAssumed ? "not stated" : camera.response.name();
}

/// factor: of degrees.
json angles_json(const FieldOfView& view, double factor, int decimals) {
  const auto angle = [&](const std::optional<double>& angle_deg) {
    return angle_deg ? json(round_to_decimals(factor * *angle_deg, decimals)) : json(nullptr);
  };
  return {{"horizontal", angle(view.horizontal_deg)},
          {"vertical", angle(view.vertical_deg)},
          {"diagonal", angle(view.diagonal_deg)}};
}

json to_json(const Camera& camera) {
  const Pinhole& lens = camera.model.pinhole();
  const FieldOfView view = field_of_view(camera);
  json out = {{"name", camera.name},
              {"fx", lens.fx},
              {"fy", lens.fy},
              {"cx", lens.cx},
              {"cy", lens.cy},
              {"distortion_model", camera.model.distortion_name()},
              {"distortion_coeffs", coefficients_of(camera)},
              {"resolution", camera.width > 0 ? json{camera.width, camera.height} : json(nullptr)},
              {"field_of_view_rad", angles_json(view, 1.0 / kDegPerRad, 6)},
              {"field_of_view_deg", angles_json(view, 1.0, 3)},  // until 0.3
              {"exposure_s", camera.exposure_s ? json(*camera.exposure_s) : json(nullptr)},
              {"line_delay_s", camera.line_delay_s},
              {"response", camera.response_origin == ResponseOrigin::kAssumed ? json(nullptr)
                                                                              : json(camera.response.name())},
              {"T_this_previous", nullptr}};
  if (camera.T_this_previous) {
    const Eigen::Quaterniond& q = camera.T_this_previous->rotation();
    const Eigen::Vector3d& t = camera.T_this_previous->translation();
    out["T_this_previous"] = {{"position_m", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},
                              {"position", {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},  // until 0.3
                              {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
  }
  return out;
}

std::string angle_text(const std::optional<double>& angle_deg) {
  return angle_deg ? fmt::format("{:.1f}", *angle_deg) : "-";
}

std::string to_text(const Camera& camera) {
  const Pinhole& lens = camera.model.pinhole();
  const FieldOfView view = field_of_view(camera);
  const std::vector<double> coefficients = coefficients_of(camera);
  std::string text = fmt::format("{}\n", camera.name);
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  row("resolution", camera.width > 0 ? fmt::format("{} x {} px", camera.width, camera.height) : "not stated");
  row("fx fy cx cy", fmt::format("{} {} {} {} px", lens.fx, lens.fy, lens.cx, lens.cy));
  row("distortion", fmt::format("{}{}{}", camera.model.distortion_name(), coefficients.empty() ? "" : " ",
                                fmt::join(coefficients, " ")));
  row("field of view",
      fmt::format("{} horizontal, {} vertical, {} diagonal, in degrees", angle_text(view.horizontal_deg),
                  angle_text(view.vertical_deg), angle_text(view.diagonal_deg)));
  row("exposure", camera.exposure_s ? fmt::format("{:g} ms", 1e3 * *camera.exposure_s) : "not stated");
  row("line delay", fmt::format("{:g} us", 1e6 * camera.line_delay_s));
  row("response", response_text(camera));
  if (camera.T_this_previous) {
    const Eigen::Vector3d t = camera.T_this_previous->inverse().translation();
    row("place",
        fmt::format("{:.4f} {:.4f} {:.4f} m in the camera before, turned by {:.2f} deg", t.x(), t.y(), t.z(),
                    kDegPerRad * rotation_angle_rad(camera.T_this_previous->rotation(),
                                                    Eigen::Quaterniond::Identity())));
  }
  return text;
}

void run_show(const ShowOptions& options) {
  const CameraFile file = read_camera_input(options.file, options.topic, options.console);
  json out = {{"format", info_of(file.format).name}, {"cameras", json::array()}};
  std::string text = fmt::format("{}: {}\n", options.file, info_of(file.format).title);
  for (const Camera& camera : file.rig.cameras) {
    out["cameras"].push_back(to_json(camera));
    text += to_text(camera);
  }
  text.pop_back();
  options.console.finish(out, text);
}

}  // namespace

void add_camera_show(CLI::App& camera_command) {
  CLI::App& verb = add_command(camera_command, "show",
                               {"Lists a camera file's cameras: format, lens, resolution, field of view.",
                                "apriltrack camera show camera.yaml", ""});
  auto options = std::make_shared<ShowOptions>();
  verb.add_option("FILE", options->file, "Camera file of any known format, or a bag with CameraInfo")
      ->required();
  verb.add_option("--topic", options->topic, kTopicOfCamera);
  options->console.add_options(verb);
  verb.callback([options] { run_show(*options); });
}

}  // namespace apriltrack::app
