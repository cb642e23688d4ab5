#include <gmock/gmock.h>

#include <fstream>
#include <type_traits>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/io/staged_files.h"
#include "lens_models.h"
#include "support/error_message.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

/// One camera per lens of the property suite, with every optional field in use somewhere.
CameraRig rig_of_all_lenses() {
  CameraRig rig;
  for (const auto& lens : test::all_lenses()) {
    const auto i = rig.cameras.size();
    Camera camera{.name = "cam" + std::to_string(i), .model = lens.model};
    camera.width = 640 + static_cast<int>(i);
    camera.height = 480;
    if (i % 2 == 1) camera.exposure_s = 0.1 / 3.0 / static_cast<double>(i);
    camera.line_delay_s = 1e-5 / 7.0 * static_cast<double>(i);
    if (i % 3 == 1) camera.response = ResponseCurve::gamma(2.2 + 1.0 / 3.0);
    if (i % 3 == 2) camera.response = ResponseCurve::linear();
    if (i > 0) {
      Vector6d xi;
      xi << 0.1, -0.2, 0.3 / static_cast<double>(i), 0.4, 0.5, -0.6 * static_cast<double>(i);
      camera.T_this_previous = Pose::exp(xi);
    }
    rig.cameras.push_back(camera);
  }
  return rig;
}

TEST(WriteCameras, LeavesOutAResponseThatWasAssumed) {
  const auto path = test::temporary_folder() / "camera.yaml";
  CameraRig rig = rig_of_all_lenses();
  rig.cameras[0].response_origin = ResponseOrigin::kAssumed;
  rig.cameras[1].response_origin = ResponseOrigin::kEstimated;
  write_cameras(path, rig);
  const CameraRig again = read_cameras(path);
  EXPECT_EQ(again.cameras[0].response_origin, ResponseOrigin::kAssumed);
  EXPECT_EQ(again.cameras[0].response.name(), "srgb");
  EXPECT_EQ(again.cameras[1].response_origin, ResponseOrigin::kStated);
  EXPECT_EQ(again.cameras[1].response.name(), rig.cameras[1].response.name());
}

TEST(WriteCameras, ReadsBackTheSameNumbers) {
  const auto path = test::temporary_folder() / "camera.yaml";
  const CameraRig rig = rig_of_all_lenses();
  write_cameras(path, rig);
  const CameraRig again = read_cameras(path);
  ASSERT_EQ(again.cameras.size(), rig.cameras.size());
  ASSERT_GT(rig.cameras.size(), 10U);
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const Camera& a = rig.cameras[i];
    const Camera& b = again.cameras[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.model.pinhole().fx, b.model.pinhole().fx);
    EXPECT_EQ(a.model.pinhole().fy, b.model.pinhole().fy);
    EXPECT_EQ(a.model.pinhole().cx, b.model.pinhole().cx);
    EXPECT_EQ(a.model.pinhole().cy, b.model.pinhole().cy);
    EXPECT_EQ(a.model.distortion_name(), b.model.distortion_name());
    const auto coefficients = [](const auto& lens) { return lens.coefficients(); };
    EXPECT_EQ(std::visit(coefficients, a.model.distortion()), std::visit(coefficients, b.model.distortion()));
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.exposure_s, b.exposure_s);
    EXPECT_EQ(a.line_delay_s, b.line_delay_s);
    EXPECT_EQ(a.response.name(), b.response.name());
    EXPECT_EQ(a.response.linear_light(), b.response.linear_light());
    ASSERT_EQ(a.T_this_previous.has_value(), b.T_this_previous.has_value());
    if (!a.T_this_previous) continue;
    EXPECT_EQ(a.T_this_previous->translation(), b.T_this_previous->translation());
    EXPECT_THAT(*b.T_this_previous, test::PoseNear(*a.T_this_previous, 1e-15, 4e-15));
  }
}

TEST(WriteCameras, KeepsAResponseTableBesideTheFile) {
  const auto path = test::temporary_folder() / "camera.yaml";
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float code = static_cast<float>(i) / 255.0F;
    table[i] = 0.3F * code + 0.7F * code * code * code;
  }
  CameraRig rig;
  rig.cameras.push_back(Camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion())});
  rig.cameras[0].width = 640;
  rig.cameras[0].height = 480;
  rig.cameras[0].response = ResponseCurve(table);
  write_cameras(path, rig);
  EXPECT_EQ(read_cameras(path).cameras[0].response.linear_light(), table);
}

/// A camera whose response is a table, all of it times `scale`.
CameraRig with_table(float scale) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = scale * static_cast<float>(i * i) / 65025.0F;
  CameraRig rig{
      {Camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion()), .width = 640, .height = 480}}};
  rig.cameras[0].response = ResponseCurve(table);
  return rig;
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

TEST(WriteCameras, AResponseTableIsFoundAgainWhateverTheFileIsCalled) {
  // To YAML, " #" begins a comment and ": " a value; to the reader, gamma: a curve.
  for (const char* stem : {"lab #2", "a: b", "gamma:2", "it's \"here\"", "- x", "srgb", "é"}) {
    const auto folder = test::temporary_folder() / "named";
    std::filesystem::create_directory(folder);
    const auto path = folder / (std::string(stem) + ".yaml");
    const CameraRig rig = with_table(0.75F);
    write_cameras(path, rig);
    EXPECT_EQ(read_cameras(path).cameras[0].response.linear_light(), rig.cameras[0].response.linear_light())
        << stem;
    const auto table = folder / (std::string(stem) + "_cam0_response.txt");
    EXPECT_THAT(response_tables_to_write(path, rig), ::testing::ElementsAre(table));
    EXPECT_THAT(names_in(folder),
                ::testing::UnorderedElementsAre(path.filename().string(), table.filename().string()));
    std::filesystem::remove_all(folder);
  }
}

TEST(WriteCameras, TablesAreReplacedWithTheCameraFileOrNotAtAll) {
  const auto folder = test::temporary_folder();
  const auto path = folder / "camera.yaml";
  write_cameras(path, with_table(0.75F));
  const auto now = [&] { return read_cameras(path).cameras[0].response.linear_light(); };
  const auto before = now();
  {
    StagedFiles files;
    write_cameras(files, path, with_table(0.5F));
    EXPECT_EQ(now(), before);
  }
  EXPECT_EQ(now(), before) << "the run failed later";
  EXPECT_THAT(names_in(folder), ::testing::UnorderedElementsAre("camera.yaml", "camera_cam0_response.txt"));
  StagedFiles files;
  write_cameras(files, path, with_table(0.5F));
  files.commit();
  EXPECT_NE(now(), before);
  EXPECT_THAT(names_in(folder), ::testing::UnorderedElementsAre("camera.yaml", "camera_cam0_response.txt"));
}

TEST(WriteCameras, NothingGoesBesideADevice) {
  CameraRig rig{
      {Camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion()), .width = 640, .height = 480}}};
  rig.cameras[0].response = ResponseCurve(ResponseCurve::linear().linear_light());
  EXPECT_THAT(test::message_of([&] { write_cameras("/dev/null", rig); }),
              HasSubstr("/dev/null: the response table of camera 'cam0'"));
  EXPECT_FALSE(std::filesystem::exists("/dev/null_cam0_response.txt"));
}

TEST(WriteCameras, ATableThatEqualsANamedCurveStaysATable) {
  // The file must say what the camera holds: a curve's name is not for the caller to choose.
  static_assert(!std::is_constructible_v<ResponseCurve, const std::array<float, 256>&, std::string>);
  const auto path = test::temporary_folder() / "camera.yaml";
  CameraRig rig;
  rig.cameras.push_back(Camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion())});
  rig.cameras[0].width = 640;
  rig.cameras[0].height = 480;
  rig.cameras[0].response = ResponseCurve(ResponseCurve::linear().linear_light());
  EXPECT_EQ(rig.cameras[0].response.name(), "table");
  EXPECT_FALSE(rig.cameras[0].response.is_linear());
  write_cameras(path, rig);
  const ResponseCurve read = read_cameras(path).cameras[0].response;
  EXPECT_EQ(read.name(), "table");
  EXPECT_EQ(read.linear_light(), ResponseCurve::linear().linear_light());
}

class ResponseTable : public ::testing::Test {
 protected:
  /// Reads a camera whose response is a file with this text.
  ResponseCurve read(const std::string& text) {
    std::ofstream(folder_ / "table.txt") << text;
    std::ofstream(folder_ / "c.yaml")
        << "cam0: {camera_model: pinhole, intrinsics: [5, 5, 3, 2], distortion_model: "
           "none, resolution: [6, 4], response: table.txt}\n";
    return read_cameras(folder_ / "c.yaml").cameras[0].response;
  }
  std::string message(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "was read";
  }
  static std::string numbers(int count, double scale, const std::string& between) {
    std::string text;
    for (int i = 0; i < count; ++i) text += std::to_string(scale * i) + between;
    return text;
  }
  std::filesystem::path folder_ = test::temporary_folder();
};

TEST_F(ResponseTable, IsFoundBesideTheCameraFileAndScaledToOne) {
  const ResponseCurve response = read("# light of the grey levels\n" + numbers(256, 1.0, " ") + "\n");
  EXPECT_EQ(response.to_linear(255), 1.0F);
  EXPECT_FLOAT_EQ(response.to_linear(51), 0.2F);
}

TEST_F(ResponseTable, IsRefusedWithThePlaceAndTheCause) {
  EXPECT_THAT(message(numbers(255, 0.001, "\n")), HasSubstr("holds 256 numbers"));
  EXPECT_THAT(message(numbers(255, 0.001, "\n") + "0.1\n"),
              HasSubstr("table.txt:256: a response table must never decrease"));
  EXPECT_THAT(message(numbers(200, 0.001, "\n") + "nan\n"), HasSubstr("table.txt:201: "));
  EXPECT_THAT(message(numbers(256, 0.0, ",")), HasSubstr("must rise"));
}

TEST(WriteCameras, FailsWithThePathWhenTheFolderIsMissing) {
  CameraRig rig;
  rig.cameras.push_back(Camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion())});
  rig.cameras[0].width = 640;
  rig.cameras[0].height = 480;
  try {
    write_cameras(test::temporary_folder() / "missing" / "camera.yaml", rig);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_THAT(error.what(), HasSubstr("missing/camera.yaml"));
  }
}

Camera named(const std::string& name) {
  return {
      .name = name, .model = CameraModel({500, 510, 320, 240}, NoDistortion()), .width = 640, .height = 480};
}

TEST(WriteCameras, KeepsNamesThatAreNotThoseOfKalibr) {
  const auto path = test::temporary_folder() / "rig.yaml";
  CameraRig rig{{named("front"), named("cam1"), named("right: #2")}};
  rig.cameras[1].T_this_previous = rig.cameras[2].T_this_previous = Pose();
  write_cameras(path, rig);
  const CameraRig again = read_cameras(path);
  ASSERT_EQ(again.cameras.size(), 3U);
  EXPECT_EQ(again.cameras[0].name, "front");
  EXPECT_EQ(again.cameras[1].name, "cam1");
  EXPECT_EQ(again.cameras[2].name, "right: #2");
  EXPECT_EQ(&again.find("front"), &again.cameras[0]);
}

TEST(WriteCameras, RefusesWhatNoFileCanHoldAndKeepsTheFileThatIsThere) {
  const auto path = test::temporary_folder() / "rig.yaml";
  std::ofstream(path) << "of before";
  const auto message_for = [&](const CameraRig& rig) {
    return test::message_of([&] { write_cameras(path, rig); });
  };
  EXPECT_EQ(message_for({}), path.string() + ": there is no camera to write");
  EXPECT_EQ(message_for({{named("left"), named("left")}}), path.string() + ": two cameras are called 'left'");
  EXPECT_THAT(message_for({{named("a=b")}}), HasSubstr("name 'a=b' must not hold any of , = /"));
  EXPECT_THAT(message_for({{named("")}}), HasSubstr("name '' must not be empty"));
  Camera without_size = named("left");
  without_size.width = without_size.height = 0;
  EXPECT_THAT(message_for({{without_size}}), HasSubstr("camera 'left' has no resolution"));
  std::string kept;
  std::getline(std::ifstream(path), kept);
  EXPECT_EQ(kept, "of before");
}

}  // namespace
}  // namespace apriltrack
