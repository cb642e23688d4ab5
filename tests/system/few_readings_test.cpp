// Where a film's tags are of another family, or too blurred, all that is read may be read by mistake.

#include <gtest/gtest.h>

#include <filesystem>

#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// A tag is read in the first of some frames, and nothing in the others.
class FewReadings : public ::testing::Test {
 protected:
  FewReadings() {
    run_for_json({"simulate", "--scene", "single", "--frames", "1", "--speed", "0", "--output", film_});
    TagMap map = read_tag_map(film_ + "/map.yaml");
    map.tags[0].key.id += 100;
    write_tag_map(other_map_, map);
  }

  void add_empty_frames(int count) const {
    std::string pixels = std::string(1280 * 360, '\x60') + std::string(1280 * 360, '\x70');
    for (int i = 0; i < count; ++i) {
      pixels[static_cast<std::size_t>(i)] = '\x61';  // no copy of the one before
      write_text(film_ + "/frames/" + std::to_string(2'000'000'000 + 33'333'333LL * i) + ".pgm",
                 "P5\n1280 720\n255\n" + pixels);
    }
  }
  ProgramRun track(const std::string& map) const {
    return run_program({"track", film_, "--mode", "joint", "--method", "pnp", "--map", map, "--output",
                        folder_ / "out.tum", "--json"});
  }

  const fs::path folder_ = temporary_folder();
  const std::string film_ = folder_ / "film", own_map_ = film_ + "/map.yaml",
                    other_map_ = folder_ / "other.yaml";
};

TEST_F(FewReadings, AreDoubtedWhereTheyGiveNoPose) {
  EXPECT_THAT(track(other_map_), EndsWith(1, "no tag of the map in any of 1 frames"));
  add_empty_frames(19);
  EXPECT_THAT(track(other_map_),
              EndsWith(1, "tags of family tag36h11 were read in 1 of 20 frames only (tag36h11/"));
  EXPECT_THAT(track(other_map_),
              EndsWith(1, "perhaps where there are none; is this the family that is printed?"));
}

TEST_F(FewReadings, AreDoubtedWhereAllPosesRestOnThem) {
  add_empty_frames(18);
  EXPECT_EQ(nlohmann::json::parse(track(own_map_).out)["warnings"].size(), 0U);
  add_empty_frames(19);
  const ProgramRun run = track(own_map_);
  EXPECT_THAT(run,
              EndsWith(0, "warning: tags of family tag36h11 were read in 1 of 20 frames only (tag36h11/"));
  EXPECT_EQ(nlohmann::json::parse(run.out)["warnings"].size(), 1U);
}

TEST(TagsWithoutAPose, AreToldApartFromThoseThatTheMapHasNot) {
  const fs::path folder = temporary_folder();
  const std::string film = folder / "film", map_file = folder / "map.yaml";
  run_for_json({"simulate", "--scene", "wall", "--frames", "1", "--speed", "0", "--output", film});
  TagMap map = read_tag_map(film + "/map.yaml");
  const TagKey first = map.tags[0].key, second = map.tags[1].key;
  map.tags.resize(2);
  map.tags[1].T_map_tag = Pose(map.tags[1].T_map_tag.rotation(),
                               map.tags[1].T_map_tag.translation() + Eigen::Vector3d(0.5, 0.5, 0.5));
  write_tag_map(map_file, map);
  const ProgramRun run =
      run_program({"track", film, "--method", "pnp", "--map", map_file, "--output", folder / "out.tum"});
  EXPECT_THAT(run, EndsWith(1, "tags of the map are seen (" + to_string(first) + " to " +
                                   std::to_string(second.id) + "), and others (" + first.family + "/"));
  EXPECT_THAT(run, EndsWith(1, "is this the family that is printed, and the map of this place?"));
}

}  // namespace
}  // namespace apriltrack::test
