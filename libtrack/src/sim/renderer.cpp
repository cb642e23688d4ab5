#include "apriltrack/sim/renderer.h"

#include <algorithm>
#include <utility>

#include "apriltrack/base/check.h"
#include "film.h"

namespace apriltrack {
namespace {

void check_scene(const Scene& scene, const RenderOptions& options) {
  APRILTRACK_CHECK(scene.camera.width >= 2 && scene.camera.height >= 2,
                   "a scene's camera needs a resolution");
  APRILTRACK_CHECK(scene.camera.line_delay_s == 0.0,
                   "line_delay_s must be 0: rolling shutters are not rendered");
  APRILTRACK_CHECK(scene.exposure_s >= 0.0, "exposure_s must be 0 or more");
  APRILTRACK_CHECK(scene.rate_hz > 0.0, "rate_hz must be > 0");
  APRILTRACK_CHECK(scene.truth_body < scene.bodies.size(), "truth_body must name one of the scene's bodies");
  APRILTRACK_CHECK(!scene.bodies[scene.truth_body].moves_with_camera,
                   "the truth body must not move with the camera: its pose would tell nothing");
  APRILTRACK_CHECK(options.instants_per_px > 0.0 && options.min_instants >= 1 &&
                       options.instants_factor >= 1 && options.max_instants >= options.min_instants,
                   "render options: numbers of instants must be 1 or more");
  if (scene.room) {
    for (const auto& wall : scene.room->radiance)
      APRILTRACK_CHECK(wall != nullptr, "a room needs six pictured walls");
  }
  scene.formation.check();
}

PreparedPanel prepare(const Panel& panel) {
  PreparedPanel prepared;
  prepared.panel = &panel;
  APRILTRACK_CHECK(!panel.opacity || (!panel.tag && (!panel.picture ||
                                                     panel.picture->texel_m() == panel.opacity->texel_m())),
                   "a panel with an opacity has no tag, and a picture of the same texel_m or none");
  APRILTRACK_CHECK(panel.gloss >= 0.0 && panel.gloss_width_rad > 0.0,
                   "gloss must be 0 or more, gloss_width_rad > 0");
  if (panel.tag) {
    APRILTRACK_CHECK(panel.cell_m > 0.0, "cell_m of a tag must be > 0");
    prepared.cells = std::make_shared<const TagCells>(*panel.tag);
    prepared.unit_m = panel.cell_m;
  } else if (panel.picture) {
    prepared.unit_m = panel.picture->texel_m();
  } else if (panel.opacity) {
    prepared.unit_m = panel.opacity->texel_m();
  }
  return prepared;
}

PreparedScene::PreparedBody prepare(const Body& body) {
  PreparedScene::PreparedBody prepared;
  prepared.body = &body;
  prepared.is_fixed = body.T_world_body.is_fixed();
  prepared.lies_on_walls =
      std::all_of(body.panels.begin(), body.panels.end(), [](const Panel& p) { return p.is_decal; });
  for (const bool is_decal : {false, true}) {  // decals after the sides that they lie on
    for (const Panel& panel : body.panels) {
      if (panel.is_decal == is_decal) prepared.panels.push_back(prepare(panel));
    }
  }
  for (const Panel& panel : body.panels) {
    prepared.centre_body += panel.T_body_panel.translation() / static_cast<double>(body.panels.size());
  }
  return prepared;
}

}  // namespace

PreparedScene::PreparedScene(const Scene& the_scene)
    : scene(&the_scene), grid(the_scene.camera), is_camera_fixed(the_scene.T_world_camera.is_fixed()) {
  for (const Body& body : the_scene.bodies) bodies.push_back(prepare(body));
}

struct Renderer::State {
  State(Scene the_scene, const RenderOptions& the_options)
      : scene(std::move(the_scene)),
        options(the_options),
        prepared(scene),
        lens(scene.formation.lens_blur_sigma_px) {}

  Image<float> film(double middle_s, double exposure_s, const Lens& through) const {
    const Instants instants = choose_instants(prepared, middle_s, exposure_s, options, through.num_looks());
    return apriltrack::film(prepared, instants, through);
  }

  const Scene scene;
  const RenderOptions options;
  const PreparedScene prepared;
  const Lens lens;
};

Renderer::Renderer(Scene scene, const RenderOptions& options) {
  check_scene(scene, options);
  state_ = std::make_unique<const State>(std::move(scene), options);
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Scene& Renderer::scene() const {
  return state_->scene;
}

Image<float> Renderer::radiance(Timestamp middle, double exposure_s) const {
  return state_->film(seconds_between(Timestamp{}, middle), exposure_s, Lens(0.0));
}

Image<float> Renderer::sensor_light(Timestamp middle, double exposure_s) const {
  Image<float> light = state_->film(seconds_between(Timestamp{}, middle), exposure_s, state_->lens);
  expose_sensor(light, state_->scene.formation);
  return light;
}

RenderedFrame Renderer::render(std::size_t index) const {
  const Scene& scene = state_->scene;
  RenderedFrame frame;
  frame.timestamp = scene.timestamp(index);
  frame.exposure_s = scene.exposure_s;
  frame.truth = scene.truth_pose(frame.timestamp);
  const double middle_s = seconds_between(Timestamp{}, frame.timestamp);
  const Instants instants = choose_instants(state_->prepared, middle_s, scene.exposure_s, state_->options,
                                            state_->lens.num_looks());
  frame.num_instants = instants.count;
  frame.light = 0.0;
  for (int i = 0; i < instants.count; ++i) frame.light += scene.flicker.light(instants.at(i));
  frame.light /= instants.count;

  Image<float> light(scene.camera.width, scene.camera.height, 0.0F);
  if (!scene.is_blacked_out(index)) {
    light = film(state_->prepared, instants, state_->lens);
    expose_sensor(light, scene.formation);
  }
  frame.pixels = develop(light, scene.camera.response, scene.formation, state_->options.seed, index);
  return frame;
}

Frame RenderedFrame::frame(double gain) const {
  Frame frame;
  frame.image = pixels.view();
  frame.timestamp = timestamp;
  frame.exposure_s = exposure_s;
  frame.gain = gain;
  return frame;
}

}  // namespace apriltrack
