#include "apriltrack/io/yaml_reader.h"

#include <gmock/gmock.h>

#include "apriltrack/base/error.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

YamlNode parse(const std::string& text) {
  return YamlNode::read_text(text, "lab.yaml");
}

constexpr const char* kMap = R"(# a comment
frame: world
tags:
  - id: 3
    size: 0.16
  - id: 4
    size: -0.16
    pose: {x: 1.5, y: -2e-3}
empty:
quoted: "12"
flags: [true, False]
)";

TEST(YamlReader, GivesValuesWithLineAndKeyPath) {
  const YamlNode root = parse(kMap);
  EXPECT_TRUE(root.is_map());
  EXPECT_EQ(root.key_path(), "");
  EXPECT_EQ(root.at("frame").as_string(), "world");
  const YamlNode size = root.at("tags").items()[1].at("size");
  EXPECT_EQ(size.as_double(), -0.16);
  EXPECT_EQ(size.key_path(), "tags[1].size");
  EXPECT_EQ(size.where(), "lab.yaml:7");
  EXPECT_EQ(message_of([&] { size.fail("must be > 0 (is -0.16)"); }),
            "lab.yaml:7: tags[1].size: must be > 0 (is -0.16)");
  EXPECT_EQ(root.at("tags").items()[1].at("pose").at("y").as_double(), -0.002);
  EXPECT_EQ(root.at("tags").items()[0].at("id").as_int(), 3);
  EXPECT_TRUE(root.at("empty").is_null());
  EXPECT_EQ(root.at("empty").where(), "lab.yaml:9");
  EXPECT_EQ(root.at("quoted").as_string(), "12");
  EXPECT_TRUE(root.at("flags").items()[0].as_bool());
  EXPECT_FALSE(root.at("flags").items()[1].as_bool());
  EXPECT_FALSE(root.find("nothing"));
}

TEST(YamlReader, KeepsTheOrderOfKeys) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : parse("z: 1\na: 2\nm: 3\n").entries()) keys.push_back(key);
  EXPECT_THAT(keys, ElementsAre("z", "a", "m"));
}

TEST(YamlReader, RefusesDuplicateKeysAtAnyDepth) {
  EXPECT_THAT(message_of([] { parse("a: 1\nb: 2\na: 3\n"); }),
              AllOf(HasSubstr("lab.yaml:3: a: "), HasSubstr("line 1")));
  EXPECT_THAT(message_of([] { parse("t:\n- {id: 1,\n   id: 2}\n"); }), HasSubstr("lab.yaml:3: t[0].id: "));
  EXPECT_NO_THROW(parse("- a: 1\n- a: 2\n"));
}

TEST(YamlReader, MissingAndUnknownKeysNameTheirPlace) {
  const YamlNode root = parse("cam0:\n  a: 1\n  x_mine: {b: 2}\n  typo: 3\n");
  EXPECT_EQ(message_of([&] { root.at("cam0").at("resolution"); }),
            "lab.yaml:1: cam0: 'resolution' is missing");
  EXPECT_THAT(
      message_of([&] {
        root.at("cam0").expect_keys({"a", "b"});
      }),
      AllOf(HasSubstr("lab.yaml:4: cam0.typo: unknown key"), HasSubstr("a, b"), Not(HasSubstr("x_mine"))));
  EXPECT_NO_THROW(root.at("cam0").expect_keys({"a", "typo"}));
  EXPECT_THAT(message_of([&] { root.at("cam0").at("a").find("b"); }),
              HasSubstr("lab.yaml:2: cam0.a: must be a mapping"));
}

TEST(YamlReader, ReadsDecimalNumbersOnly) {
  const auto as_int = [](const std::string& text) { return parse("v: " + text).at("v").as_int(); };
  EXPECT_EQ(as_int("10"), 10);
  EXPECT_EQ(as_int("-7"), -7);
  EXPECT_EQ(as_int("+7"), 7);
  EXPECT_EQ(as_int("0"), 0);
  for (const std::string text :
       {"010", "-010", "0x10", "0o17", "1_000", "1.0", "1e3", "ten", "''", "[1]", "", "12 13"}) {
    EXPECT_THAT(message_of([&] { as_int(text); }), HasSubstr("lab.yaml:1: v: must be")) << text;
  }
  EXPECT_THAT(message_of([&] { as_int("010"); }), AllOf(HasSubstr("leading zeros"), HasSubstr("'010'")));
  EXPECT_THAT(message_of([&] { as_int("3000000000"); }), HasSubstr("2147483647] (is 3000000000)"));
  EXPECT_THAT(message_of([&] { as_int("99999999999999999999999"); }), HasSubstr("v: must be"));
}

TEST(YamlReader, ReadsFiniteNumbersOnly) {
  const auto as_double = [](const std::string& text) { return parse("v: " + text).at("v").as_double(); };
  EXPECT_EQ(as_double("1."), 1.0);
  EXPECT_EQ(as_double("-.5"), -0.5);
  EXPECT_EQ(as_double("2.5e-3"), 0.0025);
  EXPECT_EQ(as_double("0.1"), 0.1);
  EXPECT_EQ(as_double("0"), 0.0);
  for (const std::string text : {".nan", ".NaN", ".inf", "-.Inf", "+.INF", "nan", "inf", "-infinity"}) {
    EXPECT_THAT(message_of([&] { as_double(text); }), AllOf(HasSubstr("finite"), HasSubstr("'" + text + "'")))
        << text;
  }
  for (const std::string text : {"1,5", "010", "abc", "1.0.0", "~", "1e999", "{a: 1}"}) {
    EXPECT_THAT(message_of([&] { as_double(text); }), HasSubstr("lab.yaml:1: v: must be a ")) << text;
  }
}

TEST(YamlReader, ReadsListsOfNumbers) {
  const YamlNode root = parse("v: [1, 2.5,\n  x]\nw: [1, 2.5]\n");
  EXPECT_THAT(root.at("w").as_doubles(), ElementsAre(1.0, 2.5));
  EXPECT_THAT(root.at("w").as_doubles(2), ElementsAre(1.0, 2.5));
  EXPECT_THAT(message_of([&] { root.at("v").as_doubles(); }),
              HasSubstr("lab.yaml:2: v[2]: must be a number (is 'x')"));
  EXPECT_THAT(message_of([&] { root.at("w").as_doubles(3); }),
              HasSubstr("lab.yaml:3: w: must be a list of 3 numbers (is a list of 2)"));
}

TEST(YamlReader, BoolsAreTrueOrFalse) {
  EXPECT_THAT(message_of([] { parse("v: yes").at("v").as_bool(); }),
              HasSubstr("v: must be true or false (is 'yes')"));
}

TEST(YamlReader, ReadsOpenCvsHeadingWithoutShiftingLines) {
  const YamlNode root = parse(
      "%YAML:1.0\n---\nK: !!opencv-matrix\n   rows: 1\n   dt: d\n   data: [ 1., -2.e-01,\n       3. ]\n");
  EXPECT_THAT(root.at("K").at("data").as_doubles(), ElementsAre(1.0, -0.2, 3.0));
  EXPECT_EQ(root.at("K").at("rows").where(), "lab.yaml:4");
  EXPECT_EQ(parse("%YAML:1.0\nv: 2\n").at("v").where(), "lab.yaml:2");
  EXPECT_EQ(parse("%YAML 1.2\n---\nv: 2\n").at("v").as_int(), 2);
}

TEST(YamlReader, EmptyTextIsNull) {
  for (const std::string text : {"", "\n\n", "# only a comment\n", "---\n"}) {
    EXPECT_TRUE(parse(text).is_null()) << text;
    EXPECT_THAT(message_of([&] { parse(text).at("cam0"); }),
                HasSubstr(": must be a mapping with a key 'cam0' (is empty)"));
  }
}

TEST(YamlReader, RefusesWhatIsNoYaml) {
  EXPECT_THAT(message_of([] { parse("a: 1\nb: [1, 2\nc: 3\n"); }),
              AllOf(HasSubstr("lab.yaml:"), HasSubstr("is no valid YAML")));
  EXPECT_THAT(message_of([] { parse("a:\n\tb: 1\n"); }), AllOf(HasSubstr("lab.yaml:2"), HasSubstr("tab")));
  EXPECT_THAT(message_of([] { parse("a: *nowhere\n"); }), HasSubstr("lab.yaml:1"));
  EXPECT_THAT(message_of([] { parse("a: 1\n---\nb: 2\n"); }), HasSubstr("second YAML document"));
  EXPECT_THAT(message_of([] { parse("a: 1\n---\n---\nb: 2\n"); }), HasSubstr("second YAML document"));
  EXPECT_THAT(message_of([] { parse("? [1, 2]\n: 3\n"); }), HasSubstr("a key must be"));
  // Found by fuzzing: the parser never came to an end.
  for (const char* text : {"a: 1}, {b: 2}\n", "{a: 1}\n, {b: 2}\n", ", a\n", "[1]\n,\n,"})
    EXPECT_THAT(message_of([&] { parse(text); }), HasSubstr("is no valid YAML")) << text;
  EXPECT_THAT(message_of([] { parse("{a: 1}\n, {b: 2}\n"); }),
              HasSubstr("lab.yaml:2: is no valid YAML: a comma stands where none may (column 1)"));
  EXPECT_THAT(message_of([] { parse(std::string("\x89PNG\r\n\0\0", 8)); }), HasSubstr("no text file"));
}

TEST(YamlReader, SurvivesHostileText) {
  // Each ends in an Error, none in a crash or in gigabytes.
  EXPECT_THAT(message_of([] { parse(std::string(200'000, '[')); }), HasSubstr("lab.yaml:1"));
  EXPECT_THAT(message_of([] { parse(std::string(200'000, '{')); }), HasSubstr("lab.yaml:1"));
  std::string dashes;
  for (int i = 0; i < 50'000; ++i) dashes += "- ";
  EXPECT_THAT(message_of([&] { parse(dashes); }), HasSubstr("nested more than 64 deep"));
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) bomb += last + " ,";
    bomb += "]\n";
  }
  EXPECT_THAT(message_of([&] { parse(bomb); }), HasSubstr("aliases"));
  EXPECT_THAT(message_of([] { parse("a: &x [1, *x]\n"); }), HasSubstr("an alias stands inside"));
  // An alias of a key stood for the value before it, or for nothing.
  EXPECT_THAT(message_of([] { parse("&x b: *x\n"); }),
              HasSubstr("an anchor cannot stand before a key ('b')"));
  EXPECT_THAT(message_of([] { parse("a: 1\n&x b: 2\nc: *x\n"); }), HasSubstr("an anchor cannot stand"));
}

TEST(YamlReader, ReadsHonestAliases) {
  const YamlNode root = parse("a: &k [1, 2]\nb: *k\n");
  EXPECT_THAT(root.at("b").as_doubles(), ElementsAre(1.0, 2.0));
}

TEST(YamlReader, ReadsLargeFiles) {
  std::string text = "tags:\n";
  for (int i = 0; i < 20'000; ++i) text += "- {id: " + std::to_string(i) + ", size: 0.16}\n";
  const auto tags = parse(text).at("tags").items();
  ASSERT_EQ(tags.size(), 20'000U);
  EXPECT_EQ(tags.back().at("id").as_int(), 19'999);
  EXPECT_EQ(tags.back().where(), "lab.yaml:20001");
}

TEST(YamlReader, SeesThroughByteOrderMarkAndCarriageReturns) {
  const YamlNode root = parse(
      "\xEF\xBB\xBF"
      "a: 1\r\nb: text\r\n");
  EXPECT_EQ(root.at("a").as_int(), 1);
  EXPECT_EQ(root.at("b").as_string(), "text");
  EXPECT_EQ(root.at("b").where(), "lab.yaml:2");
}

TEST(YamlReader, KeepsWhatItDoesNotUnderstandAsYaml) {
  const std::vector<std::string> texts = {
      "{a: 1, b: [1, 2.5, null, true], c: {d: {}, e: []}}",
      "{note: \"with, comma: and {braces} # and \\\"quotes\\\" \\\\ \"}",
      "{a: \"12\", b: 12, \"key, odd\": 2026-01-01 10:00:00}",
      "{text: \"line\\nbreak\", empty: \"\", minus: -0.5, dash: \"-\"}",
  };
  for (const std::string& text : texts) {
    const std::string kept = parse("x_: " + text).at("x_").as_yaml();
    EXPECT_EQ(kept, text);
    EXPECT_EQ(parse("x_: " + kept).at("x_").as_yaml(), kept);
  }
  const YamlNode block = parse("x_: # comment\n  - a, b\n  - |\n    two\n    lines\n  - 'it''s'\n");
  EXPECT_EQ(block.at("x_").as_yaml(), "[\"a, b\", \"two\\nlines\\n\", \"it's\"]");
}

TEST(YamlReader, OutlivesItsRoot) {
  std::optional<YamlNode> leaf;
  { leaf = parse("a:\n  b: [1, 2]\n").at("a").at("b"); }
  EXPECT_EQ(leaf->key_path(), "a.b");
  EXPECT_THAT(leaf->as_doubles(), ElementsAre(1.0, 2.0));
}

TEST(YamlReader, FilesThatCannotBeReadAreIoErrors) {
  for (const auto& path : {test::temporary_folder() / "nowhere.yaml", test::temporary_folder()}) {
    try {
      YamlNode::read_file(path);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kIo);
      EXPECT_THAT(error.what(), HasSubstr(path.string() + ": cannot be read: "));
    }
  }
}

TEST(JsonReader, GivesTheSameTreeWithLines) {
  const YamlNode root = YamlNode::read_json_text(
      "{\"tags\":[\n {\"ID\": 1, \"pose\": {\"x\": -1.5e-3}},\n {\"ID\": 2\n}], \"ok\": true,\n\"none\": "
      "null, \"s\": \"0\"}",
      "c.json");
  const auto tags = root.at("tags").items();
  EXPECT_EQ(tags[0].at("pose").at("x").as_double(), -0.0015);
  EXPECT_EQ(tags[1].at("ID").as_int(), 2);
  EXPECT_EQ(tags[1].at("ID").where(), "c.json:3") << "the number ends at a line's end";
  EXPECT_EQ(tags[1].key_path(), "tags[1]");
  EXPECT_EQ(root.at("none").where(), "c.json:5");
  EXPECT_TRUE(root.at("none").is_null());
  EXPECT_TRUE(root.at("ok").as_bool());
  EXPECT_EQ(root.at("s").as_string(), "0");
}

TEST(JsonReader, ReadsNumbersToTheLastDigit) {
  const auto values =
      YamlNode::read_json_text("[0.1, 1706.8743420144017, -1e-300, 123456789012345678, 1.0]", "c.json")
          .as_doubles();
  EXPECT_THAT(values, ElementsAre(0.1, 1706.8743420144017, -1e-300, 123456789012345678.0, 1.0));
}

TEST(JsonReader, RefusesWhatIsNoJson) {
  const auto message = [](const std::string& text) {
    return message_of([&] { YamlNode::read_json_text(text, "c.json"); });
  };
  EXPECT_THAT(message("{\"a\": 1,\n \"b\": }"),
              AllOf(HasSubstr("c.json:2: is no valid JSON"), HasSubstr("column")));
  EXPECT_THAT(message("{\"a\": 1,\n \"a\": 2}"), HasSubstr("c.json:2: a: this key stands twice"));
  EXPECT_THAT(message(""), HasSubstr("c.json:1: is no valid JSON"));
  EXPECT_THAT(message("[1e999]"), HasSubstr("c.json:1"));
  EXPECT_THAT(message("[NaN]"), HasSubstr("c.json:1"));
  EXPECT_THAT(message(std::string(200'000, '[')), HasSubstr("nested more than 64 deep"));
  EXPECT_THAT(message("{} trailing"), HasSubstr("c.json:1"));
}

TEST(YamlReader, PassesOverEmptyDocumentsAtTheEnd) {
  for (const char* end : {"---", "---\n", "---\n---\n", "---\n# nothing\n", "...\n", "...\n---\n"}) {
    EXPECT_EQ(parse(std::string("a: 1\nb: [2, 3]\n") + end).at("b").as_doubles(), (std::vector<double>{2, 3}))
        << end;
  }
}

}  // namespace
}  // namespace apriltrack
