#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../camera_fields.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {

// The door of this room: a camera file in memory, and what each format makes of it.

struct CameraText {
  std::string name;  ///< What messages call it.
  std::string text;
  std::optional<YamlNode> root = std::nullopt;  ///< Of YAML and JSON: a mapping.
};

/// What a reader is told, and `lost`, which gets what it passes over.
struct CameraReading {
  std::filesystem::path folder;  ///< Of the file: response tables are relative to it.
  BeyondOurLenses beyond = BeyondOurLenses::kRefuse;
  std::vector<std::string>* to_estimate = nullptr;  ///< As of read_kalibr_camchain().
  std::vector<ConversionLoss> lost = {};
};

using CameraReader = CameraRig(const CameraText& file, CameraReading& reading);

/// One format.
struct CameraFormatCode {
  CameraFormatInfo info;
  /// What must be in a file of it: "'cam0' (Kalibr camchain)"; empty where that is told of another format.
  std::string_view marker;
  /// By the content, without a complaint. Files that are `is_plain_text` are no YAML and have no root; they
  /// are recognised first.
  bool (*recognises)(const CameraText& file);
  /// Throws Error(kInvalidInput) with file, line, key and the way out.
  CameraReader* read;
  bool is_plain_text = false;
};

std::span<const CameraFormatCode> camera_format_codes();

bool is_ros_ini(const CameraText& file);
bool is_colmap(const CameraText& file);
/// A Python dictionary, which is YAML's flow style but for the optimization's inputs.
bool is_mrcal(const CameraText& file);
bool is_kalibr_camchain(const CameraText& file);
/// Those of a camera matrix and OpenCV's coefficients, all read by read_matrix_camera().
bool is_ros_camera_info(const CameraText& file);
bool is_opencv(const CameraText& file);
bool is_wpilib(const CameraText& file);
bool is_photonvision(const CameraText& file);
bool is_euroc_sensor(const CameraText& file);
bool is_nerfstudio(const CameraText& file);
bool is_openicc(const CameraText& file);
bool is_basalt(const CameraText& file);
bool is_vins(const CameraText& file);
bool is_orbslam(const CameraText& file);

CameraReader read_ros_ini, read_colmap, read_mrcal, read_matrix_camera, read_euroc_sensor, read_nerfstudio,
    read_openicc, read_basalt, read_vins, read_orbslam;

/// OpenCV FileStorage as XML; read_matrix_camera() reads its tree.
bool is_opencv_xml(const CameraText& file);
YamlNode opencv_xml_tree(const CameraText& file);

/// Files of one camera are read as of cam0: notes that it is called otherwise, by `name`.
void note_name(const std::string& name, std::vector<ConversionLoss>& lost);
/// Notes that `root` states a camera's place by `key`, where it does.
void note_place(const YamlNode& root, std::string_view key, const std::string& camera,
                std::vector<ConversionLoss>& lost);

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
