#include <fmt/format.h>

#include <cmath>

#include "bench_setting.h"
#include "scalar_kernels.h"

namespace apriltrack::bench {

/// The kernels of the blur tracker's fit.
void bench_pixels(int repetitions) {
  constexpr std::size_t kNumPixels = 4096;
  const Setting setting(120.0);
  PhotometricWorld world(setting.camera, setting.map, TrackMode::kJoint, kWidth, kHeight);
  ViewPath path(setting.hypotheses[0], setting.frame.exposure_s, world.mode);
  const TagPrediction prediction(world, world.tags[0], path, 0);
  RandomStream random(3);
  std::vector<float> x(kNumPixels), y(kNumPixels), image(kNumPixels, 0.4F), inverse_sigma(kNumPixels, 1.0F);
  for (float* ray : {x.data(), y.data()})
    for (std::size_t i = 0; i < kNumPixels; ++i) ray[i] = static_cast<float>(random.uniform(-0.07, 0.07));
  std::vector<float> light(kNumPixels), presence(kNumPixels);
  const RayColumns rays = {x.data(), y.data(), kNumPixels};
  const ColourFactors colours = {.gain = 0.55F, .black = 0.08F, .background = 0.3F};
  double sink = 0.0;
  std::vector<Way> ways;
  ways.push_back({"predict, definition",
                  0,
                  [&] {
                    for (std::size_t i = 0; i < kNumPixels; ++i)
                      light[i] = prediction.predict({x[i], y[i]}).light;
                  },
                  {}});
  ways.push_back({"linearise, definition (Jacobian only)",
                  0,
                  [&] {
                    PixelJacobian jacobian;
                    for (std::size_t i = 0; i < kNumPixels; ++i)
                      light[i] = prediction.predict({x[i], y[i]}, jacobian).light;
                  },
                  {}});
  const auto add = [&](const std::string& name, std::int64_t set, const auto& predict,
                       const auto& linearise) {
    ways.push_back({"predict, " + name,
                    set,
                    [&, predict] { predict(prediction.texel_path(), rays, light.data(), presence.data()); },
                    {}});
    ways.push_back({"linearise, " + name,
                    set,
                    [&, linearise] {
                      sink += linearise(prediction.texel_path(), rays, image.data(), inverse_sigma.data(),
                                        colours, 14.0F, 2.5F)[0];
                    },
                    {}});
  };
  add("SCALAR (float)", 0, &apriltrack_scalar::predict_pixels, &apriltrack_scalar::linearise_pixels);
  for (const std::int64_t set : instruction_sets())
    add(hwy::TargetName(set), set, &predict_pixels, &linearise_pixels);
  take_turns(ways, repetitions);
  fmt::print("\n### Pixels of a fit, {} instants\n\n| kernel | ns per pixel and instant |\n|---|---|\n",
             prediction.num_instants());
  for (const Way& way : ways)
    fmt::print("| {} | {:.2f} |\n", way.name, way.median_s() * 1e9 / kNumPixels / prediction.num_instants());
  if (std::isnan(sink)) fmt::print("not a number\n");
}

}  // namespace apriltrack::bench
