// What a run may replace, and what not.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;

class Outputs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    room_ = folder_ / "room";
    run_for_json({"simulate", "--scene", "room-gentle", "--frames", "6", "--seed", "3", "--output", room_});
  }

  std::vector<std::string> track(const std::string& output) const {
    return {"track", room_, "--output", output, "--quiet"};
  }

  fs::path folder_;
  std::string room_;
};

TEST_F(Outputs, NoPictureOfTheInputIsReplaced) {
  const fs::path picture = fs::directory_iterator(fs::path(room_) / "frames")->path();
  const std::string before = read_text(picture);
  EXPECT_THAT(run_program(track(picture)), EndsWith(2, "is a picture"));
  EXPECT_THAT(run_program({"detect", room_, "--output", picture, "--quiet"}), EndsWith(2, "is a picture"));
  EXPECT_THAT(run_program({"calibrate", room_, "--tag-size", "0.16", "--output", picture, "--quiet"}),
              EndsWith(2, "is a picture"));
  EXPECT_EQ(read_text(picture), before);
}

TEST_F(Outputs, NoFileOfTheRecordingIsReplaced) {
  for (const char* name : {"truth.tum", "camera.yaml", "map.yaml", "frames.csv"}) {
    const fs::path file = fs::path(room_) / name;
    if (!fs::exists(file)) write_text(file, "timestamp_ns,exposure_s,gain\n");
    const std::string before = read_text(file);
    EXPECT_THAT(run_program(track(file)), EndsWith(2, "is a recording's own file")) << name;
    EXPECT_EQ(read_text(file), before);
  }
  const fs::path older = fs::path(room_) / "older.tum";
  write_text(older, "of an earlier run\n");
  EXPECT_EQ(run_program(track(older)).status, 0);
}

TEST_F(Outputs, NamesThatARecordingGivesMeaningToAreRefusedEvenWhereNoneIsThere) {
  for (const char* name : {"truth.tum", "frames.csv", "camera.yaml"}) {
    const fs::path file = fs::path(room_) / name;
    fs::remove(file);
    std::vector<std::string> words = track(file);
    if (std::string(name) == "camera.yaml") words.insert(words.end(), {"--camera", folder_ / "own.yaml"});
    if (std::string(name) != "camera.yaml" && !fs::exists(folder_ / "own.yaml"))
      fs::copy(fs::path(room_) / "camera.yaml", folder_ / "own.yaml");
    EXPECT_THAT(run_program(words), EndsWith(2, "is a recording's own file")) << name;
    EXPECT_FALSE(fs::exists(file)) << name;
  }
  const fs::path euroc = folder_ / "mav0" / "cam0";
  fs::create_directories(euroc / "data");
  for (const char* name : {"data.csv", "sensor.yaml"}) {
    EXPECT_THAT(run_program({"detect", room_, "--output", euroc / name}),
                EndsWith(2, "is a recording's own file"));
    EXPECT_FALSE(fs::exists(euroc / name)) << name;
  }
}

TEST_F(Outputs, ARecordingWithoutAMapMayGetOne) {
  const fs::path map = fs::path(room_) / "map.yaml";
  fs::remove(map);
  const std::vector<std::string> words = {"calibrate", room_,         "--tag-size", "0.16",   "--output",
                                          map,         "--min-views", "2",          "--quiet"};
  EXPECT_EQ(run_program(words).status, 0);
  const std::string before = read_text(map);
  EXPECT_FALSE(before.empty());
  EXPECT_THAT(run_program(words), EndsWith(2, "is a recording's own file"));
  EXPECT_EQ(read_text(map), before);
}

TEST_F(Outputs, AResponseTableOfTheCameraIsAnInput) {
  const fs::path table = folder_ / "light.txt";
  std::string text;
  for (int i = 0; i < 256; ++i) text += std::to_string(i) + "\n";
  write_text(table, text);
  const fs::path camera = folder_ / "camera.yaml";
  write_text(camera, read_text(fs::path(room_) / "camera.yaml"));
  std::string lines = read_text(camera);
  lines.replace(lines.find("response: srgb"), 14, "response: light.txt");
  write_text(camera, lines);
  const std::vector<std::vector<std::string>> runs = {
      {"track", room_, "--camera", camera, "--output", table},
      {"track", room_, "--camera", camera, "--output", folder_ / "o.tum", "--frames-csv", table},
      {"detect", room_, "--camera", camera, "--output", table},
      {"calibrate", room_, "--camera", camera, "--tag-size", "0.16", "--output", table}};
  for (const auto& words : runs) {
    EXPECT_THAT(run_program(words), EndsWith(2, "is an input of this run")) << words[0];
    EXPECT_EQ(read_text(table), text);
  }
  // The recording's own camera file, which is read where none is given.
  write_text(fs::path(room_) / "camera.yaml", lines);
  write_text(fs::path(room_) / "light.txt", text);
  EXPECT_THAT(run_program({"detect", room_, "--output", fs::path(room_) / "light.txt"}),
              EndsWith(2, "is an input of this run"));
}

TEST_F(Outputs, ForceReplacesOnlyWhatSimulateMade) {
  const auto simulate = [](const fs::path& folder) {
    return run_program(
        {"simulate", "--scene", "single", "--frames", "1", "--output", folder, "--force", "--quiet"});
  };
  const fs::path own = folder_ / "own";
  for (const char* name : {"frames/1000000000.png", "camera.yaml", "map.yaml", "frames.csv", "truth.tum"}) {
    write_text(own / name, "keep\n");
    EXPECT_THAT(simulate(own),
                EndsWith(2, "--force: '" + own.string() + "' holds a recording that simulate did not make"));
    EXPECT_EQ(read_text(own / name), "keep\n") << name;
    fs::remove_all(own);
  }
  write_text(own / "notes.txt", "keep\n");
  EXPECT_EQ(simulate(own).status, 0) << "nothing to lose";
  EXPECT_EQ(simulate(own).status, 0) << "what simulate made";
  EXPECT_EQ(read_text(own / "notes.txt"), "keep\n");
}

TEST_F(Outputs, AFolderThatCannotBeWrittenIsToldBeforeTheWork) {
  const fs::path locked = folder_ / "locked";
  fs::create_directories(locked);
  write_text(locked / "there.tum", "keep\n");
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  write_text(fs::path(room_) / "frames" / "0.png", "no picture");  // the work would tell of it
  const std::vector<std::vector<std::string>> runs = {
      track(locked / "o.tum"),
      track(locked / "there.tum"),
      {"track", room_, "--output", folder_ / "o.tum", "--frames-csv", locked / "log.csv"},
      {"detect", room_, "--output", locked / "o.csv"},
      {"calibrate", room_, "--tag-size", "0.16", "--output", locked / "o.yaml"},
      {"calibrate", room_, "--tag-size", "0.16", "--output", folder_ / "o.yaml", "--parts", locked},
      {"calibrate", room_, "--tag-size", "0.16", "--output", folder_ / "o.yaml", "--parts",
       locked / "a" / "b"}};
  for (const auto& words : runs) {
    const ProgramRun run = run_program_bound_by_permissions(words);
    EXPECT_THAT(run, EndsWith(3, "nothing can be made in '" + locked.string() + "'")) << words[0];
    EXPECT_EQ(run.err.find("0.png"), std::string::npos) << run.err;
  }
  fs::permissions(locked, fs::perms::owner_all);
  EXPECT_EQ(read_text(locked / "there.tum"), "keep\n");
  write_text(folder_ / "file", "keep\n");
  EXPECT_THAT(run_program({"calibrate", room_, "--tag-size", "0.16", "--output", folder_ / "o.yaml",
                           "--parts", folder_ / "file" / "parts"}),
              EndsWith(3, "is no folder"));
}

TEST_F(Outputs, NoFileOfARecordingIsReplacedByARunOfOtherThings) {
  const fs::path map = fs::path(room_) / "map.yaml";
  fs::copy(map, folder_ / "other.yaml");
  EXPECT_THAT(run_program({"map", "align", folder_ / "other.yaml", folder_ / "other.yaml", "--output", map}),
              EndsWith(2, "is a recording's own file"));
  EXPECT_THAT(run_program({"map", "merge", folder_ / "other.yaml", map, "--output", folder_ / "other.yaml"}),
              EndsWith(2, "is an input of this run"));
  const fs::path euroc = folder_ / "mav0" / "cam0";
  fs::create_directories(euroc / "data");
  write_text(euroc / "data.csv", "#timestamp [ns],filename\n");
  EXPECT_THAT(run_program({"detect", room_, "--output", euroc / "data.csv"}),
              EndsWith(2, "is a recording's own file"));
  EXPECT_EQ(read_text(euroc / "data.csv"), "#timestamp [ns],filename\n");
}

TEST_F(Outputs, StandardOutputIsAddedToAndLinksStay) {
  const fs::path log = folder_ / "all.tum";
  write_text(log, "earlier\n");
  const std::string words = "track '" + room_ + "' --output /dev/stdout --quiet";
  ASSERT_EQ(
      std::system((std::string("'" APRILTRACK_PROGRAM "' ") + words + " >> '" + log.string() + "'").c_str()),
      0);
  const std::string text = read_text(log);
  EXPECT_EQ(text.substr(0, 8), "earlier\n");
  EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(text.find("frames"), std::string::npos) << "the summary is no part of the trajectory: " << text;

  fs::create_symlink("later.tum", folder_ / "link.tum");
  EXPECT_EQ(run_program(track(folder_ / "link.tum")).status, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.tum"));
  EXPECT_TRUE(fs::is_regular_file(folder_ / "later.tum"));
}

TEST_F(Outputs, PartsAreRefusedBeforeTheWork) {
  const auto calibrate = [&](const std::string& output, const std::string& parts) {
    return run_program({"calibrate", room_, "--tag-size", "0.16", "--output", output, "--parts", parts});
  };
  const std::string parts = folder_ / "parts";
  fs::create_directories(parts);
  EXPECT_THAT(calibrate(parts + "/part_1.yaml", parts), EndsWith(2, "has the name of a part"));
  EXPECT_THAT(calibrate(parts + "/part_2.yaml", parts + "/"), EndsWith(2, "has the name of a part"));
  write_text(folder_ / "file", "keep\n");
  EXPECT_THAT(calibrate(folder_ / "map.yaml", folder_ / "file"), EndsWith(2, "--parts"));
  EXPECT_TRUE(fs::is_empty(parts));
}

TEST_F(Outputs, AFailedRunReplacesNoneOfItsFiles) {
  const fs::path tum = folder_ / "camera.tum";
  write_text(tum, "keep\n");
  std::vector<std::string> words = track(tum);
  words.insert(words.end(), {"--frames-csv", "/dev/full"});
  EXPECT_THAT(run_program(words), EndsWith(3, "/dev/full"));
  EXPECT_EQ(read_text(tum), "keep\n");

  const fs::path part = folder_ / "parts" / "part_1.yaml";
  fs::create_directories(part.parent_path());
  write_text(part, "keep\n");
  EXPECT_THAT(run_program({"calibrate", room_, "--tag-size", "0.16", "--output", "/dev/full", "--parts",
                           part.parent_path(), "--min-views", "2", "--quiet"}),
              EndsWith(3, "/dev/full"));
  EXPECT_EQ(read_text(part), "keep\n");
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".new") << entry.path();
}

TEST_F(Outputs, OfOneRunAreDifferentFilesButMayBeOneDevice) {
  const fs::path tum = folder_ / "camera.tum";
  std::vector<std::string> words = track(tum);
  words.insert(words.end(), {"--frames-csv", folder_ / "." / "camera.tum"});
  EXPECT_THAT(run_program(words), EndsWith(2, "--frames-csv: is the file of --output"));
  write_text(tum, "keep\n");
  EXPECT_THAT(run_program(words), EndsWith(2, "--frames-csv: is the file of --output"));
  EXPECT_EQ(read_text(tum), "keep\n");
  words = track("/dev/null");
  words.insert(words.end(), {"--frames-csv", "/dev/null"});
  const ProgramRun run = run_program(words);
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST_F(Outputs, OneFileByTwoNamesIsToldBeforeTheWork) {
  write_text(fs::path(room_) / "frames" / "0.png", "no picture");  // the work would tell of it
  const fs::path file = folder_ / "a.tum";
  fs::create_symlink("a.tum", folder_ / "link.tum");  // to nothing yet
  fs::create_directory_symlink(".", folder_ / "here");
  const std::vector<fs::path> others = {fs::relative(file), fs::path(".") / fs::relative(file),
                                        folder_ / "link.tum", folder_ / "here" / "a.tum"};
  for (const fs::path& other : others) {
    for (const char* option : {"--frames-csv", "--report", "--video"}) {
      for (const auto& [first, second] : {std::pair(file, other), std::pair(other, file)}) {
        std::vector<std::string> words = track(first);
        words.insert(words.end(), {option, second});
        const ProgramRun run = run_program(words);
        EXPECT_THAT(run, EndsWith(2, std::string(option) + ": is the file of --output")) << first << second;
        EXPECT_EQ(run.err.find("0.png"), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(file));
      }
    }
  }
}

TEST_F(Outputs, AnInputOfTheRunIsToldBeforeTheWork) {
  const auto own = [&](const char* name) { return fs::path(room_) / name; };
  fs::copy(own("map.yaml"), folder_ / "map.yaml");
  fs::copy(own("camera.yaml"), folder_ / "camera.yaml");
  fs::create_symlink("map.yaml", folder_ / "link.yaml");
  const std::string map = read_text(folder_ / "map.yaml");
  for (const char* option : {"--output", "--frames-csv", "--report"}) {
    for (const char* input : {"map.yaml", "camera.yaml", "link.yaml"}) {
      std::vector<std::string> words = {
          "track", room_,          "--map", folder_ / "map.yaml", "--camera", folder_ / "camera.yaml",
          option,  folder_ / input};
      if (std::string(option) != "--output") words.insert(words.end(), {"--output", folder_ / "o.tum"});
      const std::string told = std::string(option) + ": '" + (folder_ / input).string() + "' is an input";
      EXPECT_THAT(run_program(words), EndsWith(2, told));
    }
  }
  EXPECT_EQ(read_text(folder_ / "map.yaml"), map);
}

TEST_F(Outputs, WhatCannotBeWrittenIsNamedAsItWasGiven) {
  const fs::path tum = folder_ / "o.tum";
  const auto track_to = [&](const char* option, const std::string& file) {
    std::vector<std::string> words = track(std::string(option) == "--output" ? file : tum.string());
    if (std::string(option) != "--output") words.insert(words.end(), {option, file});
    return run_program(words);
  };
  for (const char* option : {"--output", "--frames-csv", "--report"}) {
    EXPECT_THAT(track_to(option, "/dev/full"),
                EndsWith(3, "error: /dev/full: cannot be written: No space left on device"))
        << option;
  }
  EXPECT_FALSE(fs::exists(tum));
  write_text(fs::path(room_) / "frames" / "0.png", "no picture");  // the work would tell of it
  const fs::path dangling = folder_ / "dangling.tum";
  fs::create_symlink("nowhere/o.tum", dangling);
  const std::vector<std::pair<std::string, std::string>> early = {
      {"/proc/x.html", "nothing can be made in '/proc'"},
      {folder_ / "nowhere" / "x.html", "there is no folder '" + (folder_ / "nowhere").string() + "'"},
      {dangling, "there is no folder '" + (folder_ / "nowhere").string() + "'"}};
  for (const char* option : {"--output", "--frames-csv", "--report"}) {
    for (const auto& [file, cause] : early) {
      const ProgramRun run = track_to(option, file);
      EXPECT_THAT(run, EndsWith(3, "error: " + file + ": cannot be written: " + cause)) << option;
      EXPECT_EQ(run.err.find("0.png"), std::string::npos) << run.err;
    }
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    EXPECT_EQ(entry.path().filename().string().find(".apriltrack"), std::string::npos) << "left behind";
}

TEST_F(Outputs, OfADiskThatBecomesFullIsNamedAsItWasGiven) {
  constexpr std::size_t kPageDoesNotFit = 20'000;
  const std::string report = folder_ / "report.html";
  std::vector<std::string> words = track(folder_ / "o.tum");
  words.insert(words.end(), {"--report", report});
  EXPECT_THAT(run_program_on_full_disk(words, kPageDoesNotFit),
              EndsWith(3, "error: " + report + ": cannot be written: File too large"));
  EXPECT_FALSE(fs::exists(report));
  EXPECT_FALSE(fs::exists(folder_ / "o.tum"));
}

TEST_F(Outputs, ADemoReplacesOnlyWhatADemoMade) {
  const fs::path own = folder_ / "own";
  fs::create_directories(own);
  for (const char* name : {"gentle", "map.yaml", "pnp.tum", "blindness.png"}) {
    write_text(own / name, "keep\n");
    EXPECT_THAT(run_program({"demo", "--output", own, "--quiet"}), EndsWith(2, "no demo made")) << name;
    EXPECT_EQ(read_text(own / name), "keep\n");
    fs::remove(own / name);
  }
}

TEST_F(Outputs, AMissingInputIsStatus3WhateverElseIsMissing) {
  EXPECT_THAT(run_program({"track", folder_ / "nope", "--output", folder_ / "o.tum"}), EndsWith(3, "nope"));
  EXPECT_THAT(
      run_program({"calibrate", folder_ / "nope", "--tag-size", "0.16", "--output", folder_ / "o.yaml"}),
      EndsWith(3, "nope"));
  EXPECT_THAT(run_program({"calibrate", "cam0=" + (folder_ / "nope").string(), "--tag-size", "0.16",
                           "--output", folder_ / "o.yaml"}),
              EndsWith(3, "nope"));
}

TEST_F(Outputs, TheMapOfAnotherPlaceIsToldOf) {
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", "20", "--speed", "8", "--seed", "3",
                "--output", room_, "--force"});
  TagMap map = read_tag_map(fs::path(room_) / "map.yaml");
  // Every tag moved another way: single ones still fit and give poses by `pnp`, two hardly ever.
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    Vector6d move = Vector6d::Zero();
    move.head<3>() = Eigen::Vector3d(i % 2 ? 2.0 : -2.0, i % 3 ? 1.0 : -1.0, 0.5 * static_cast<double>(i));
    map.tags[i].T_map_tag = Pose::exp(move) * map.tags[i].T_map_tag;
  }
  const fs::path wrong = folder_ / "wrong.yaml";
  write_tag_map(wrong, map);
  std::vector<std::string> words = track(folder_ / "o.tum");
  EXPECT_EQ(run_program(words).err, "") << "with the right map there is nothing to tell";
  words.insert(words.end(), {"--map", wrong});
  const std::string contradiction = "frames with several tags these do not agree on a pose";
  EXPECT_THAT(run_program(words), EndsWith(1, contradiction)) << "no pose is claimed";
  words.insert(words.end(), {"--method", "pnp", "--json"});
  const ProgramRun run = run_program(words);
  EXPECT_THAT(run, EndsWith(0, contradiction));
  const auto summary = nlohmann::json::parse(run.out);
  ASSERT_EQ(summary["warnings"].size(), 1U);
  EXPECT_THAT(summary["warnings"][0].get<std::string>(), ::testing::HasSubstr(contradiction));
  EXPECT_THAT(
      run_program({"map", "align", fs::path(room_) / "map.yaml", wrong, "--output", folder_ / "a.yaml"}),
      EndsWith(0, "are they of one place?"));
}

}  // namespace
}  // namespace apriltrack::test
