#pragma once

#include <string>
#include <vector>

#include "../camera_fields.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {

/// The text of a camera file, and what messages call it.
struct CameraText {
  std::string name;
  std::string text;
};

// One reader for each foreign format. is_...: by the content, without a complaint. All readers throw
// Error(kInvalidInput) with file, line, key and the way out; `lost` gets what they pass over.

bool is_ros_ini(const CameraText& file);
CameraRig read_ros_ini(const CameraText& file, std::vector<ConversionLoss>& lost);

bool is_colmap(const CameraText& file);
CameraRig read_colmap(const CameraText& file);

/// A Python dictionary, which is YAML's flow style but for the optimization's inputs.
bool is_mrcal(const CameraText& file);
CameraRig read_mrcal(const CameraText& file, BeyondOurLenses beyond, std::vector<ConversionLoss>& lost);

/// OpenCV FileStorage, ROS camera_info, WPILib and PhotonVision: a camera matrix and OpenCV's coefficients.
bool has_camera_matrix(const YamlNode& root);
CameraFormat format_of_matrix_camera(const YamlNode& root, const CameraText& file);
CameraRig read_matrix_camera(const YamlNode& root, BeyondOurLenses beyond, std::vector<ConversionLoss>& lost);

/// OpenCV FileStorage as XML; read_matrix_camera() reads its tree.
bool is_opencv_xml(const CameraText& file);
YamlNode opencv_xml_tree(const CameraText& file);

bool is_euroc_sensor(const YamlNode& root);
CameraRig read_euroc_sensor(const YamlNode& root);

bool is_nerfstudio(const YamlNode& root);
CameraRig read_nerfstudio(const YamlNode& root);

bool is_openicc(const YamlNode& root);
CameraRig read_openicc(const YamlNode& root, std::vector<ConversionLoss>& lost);

bool is_basalt(const YamlNode& root);
CameraRig read_basalt(const YamlNode& root, std::vector<ConversionLoss>& lost);

bool is_vins(const YamlNode& root);
CameraRig read_vins(const YamlNode& root);

bool is_orbslam(const YamlNode& root);
CameraRig read_orbslam(const YamlNode& root, std::vector<ConversionLoss>& lost);

/// The lens of coefficients of which some after the eighth are not 0: the nearest of ours, told in `lost`, or
/// a failure at `node` that says what is wrong and what to do.
CameraModel lens_of_further_terms(const Pinhole& pinhole, const std::vector<double>& coefficients,
                                  const YamlNode& node, const Resolution& size, BeyondOurLenses beyond,
                                  std::vector<ConversionLoss>& lost);
/// Whether these are such coefficients.
bool has_further_terms(const std::vector<double>& coefficients);

/// A camera cannot hold a skew. Notes one whose greatest effect in the picture is below kMaxSkewEffect_px,
/// and throws of a greater one. node: where the skew stands.
void pass_over_skew(double skew_px, const Camera& camera, const YamlNode& node,
                    std::vector<ConversionLoss>& lost);

/// Of a loss of the kinds kSkew and kLensTerms.
std::string sentence_of_skew(const ConversionLoss& loss);
std::string sentence_of_lens_terms(const ConversionLoss& loss);

}  // namespace apriltrack
