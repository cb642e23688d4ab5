#pragma once

#include "patch_kernels.h"

/// The library's kernels for one sample at a time.
namespace apriltrack_scalar {

apriltrack::PatchSums sum_patch(const apriltrack::PairedRows& image, const apriltrack::LensFactors& lens,
                                const apriltrack::PatchPlacement& placement,
                                const apriltrack::SampleColumns& samples,
                                const apriltrack::TemplateColumns& expected);
void cast_patch(const std::array<float, 9>& camera_from_plane, const apriltrack::SampleColumns& samples,
                float* ray_x, float* ray_y);
void predict_pixels(const apriltrack::TexelPath& path, const apriltrack::RayColumns& rays, float* light,
                    float* presence);
apriltrack::GramMatrix linearise_pixels(const apriltrack::TexelPath& path, const apriltrack::RayColumns& rays,
                                        const float* image, const float* inverse_sigma,
                                        const apriltrack::ColourFactors& colours, float inverse_scale,
                                        float reach);

}  // namespace apriltrack_scalar
