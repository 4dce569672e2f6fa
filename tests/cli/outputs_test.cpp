// SPDX-License-Identifier: BSD-3-Clause
// Commands replace only files of the kind that they write themselves, and never a file of the input.
#include <gmock/gmock.h>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
namespace fs = std::filesystem;

class OutputsOfCommands : public SmallScene {
 protected:
  /// The command must end with 2 and one line, and leave every file as it is.
  void refuses(const ProgramRun& run, const std::string& part) const {
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(part));
  }
};

TEST_F(OutputsOfCommands, AFileOfTheInputIsNeverReplaced) {
  const std::string photograph = contentOf(radiance(3)), scene = contentOf(folder_ / "scene.json");
  const std::string kInput = "is an input file";
  refuses(on("reconstruct", "-o " + inQuotes(radiance(3))), kInput);
  refuses(on("reconstruct", "-o " + out("scene.json")), kInput);
  refuses(on("evaluate", "--json " + inQuotes(radiance(3))), kInput);
  refuses(on("evaluate", "--html " + out("scene.json")), kInput);
  refuses(on("evaluate", "--csv " + inQuotes(radiance(3))), kInput);
  refuses(on("info", "--json " + out("scene.json")), kInput);
  refuses(on("detect", "--json " + inQuotes(radiance(3))), kInput);
  refuses(on("convert", "-o " + out("scene.json")), kInput);
  refuses(on("tradeoff", "--json " + inQuotes(radiance(3))), kInput);
  refuses(on("render", "-o " + inQuotes(radiance(3))), kInput);
  // Through a link and a roundabout path it is the same file.
  fs::create_symlink(radiance(3), folder_ / "link.json");
  refuses(on("evaluate", "--json " + out("link.json")), kInput);
  refuses(on("evaluate", "--json " + inQuotes(folder_ / "radiance/../radiance/0003.tiff")), kInput);
  EXPECT_EQ(contentOf(radiance(3)), photograph);
  EXPECT_EQ(contentOf(folder_ / "scene.json"), scene);
}

TEST_F(OutputsOfCommands, ASessionFoundThroughItsFolderIsNeverReplaced) {
  fs::create_directories(folder_ / "kept");
  const ProgramRun saved = on("reconstruct", "--model limit-angle -o " + out("kept/a.glint"));
  ASSERT_EQ(saved.code, 0) << saved.err;
  const std::string session = contentOf(folder_ / "kept/a.glint");
  for (const std::string& input : {out("kept"), out("kept/")})
    refuses(runGlint("reconstruct " + input + " --model canonical -o " + out("kept/a.glint")),
            "a.glint: --out: is an input file");
  EXPECT_EQ(contentOf(folder_ / "kept/a.glint"), session);
  // A session beside a scene file is not part of the input: the folder means the scene file.
  ASSERT_EQ(on("reconstruct", "--model limit-angle -o " + out("b.glint")).code, 0);
  const ProgramRun again = on("reconstruct", "--model limit-angle -o " + out("b.glint"));
  EXPECT_EQ(again.code, 0) << again.err;
}

TEST_F(OutputsOfCommands, AFileOfAnotherKindStaysAsItIs) {
  folder_.write("notes.txt", "a person's notes\n");
  folder_.write("other.json", R"({"glint_scene": 1})");
  refuses(on("evaluate", "--json " + out("notes.txt")),
          "notes.txt: --json: already exists and is not a JSON file with \"glint_evaluation\"");
  refuses(on("evaluate", "--json " + out("other.json")), "other.json: --json: already exists and is not a JSON file");
  refuses(on("evaluate", "--html " + out("notes.txt")), "notes.txt: --html: already exists and is not a page");
  refuses(on("evaluate", "--csv " + out("notes.txt")), "notes.txt: --csv: already exists and is not a table");
  refuses(on("reconstruct", "-o " + out("other.json")), "already exists and is not a JSON file with \"glint_session\"");
  refuses(on("render", "-o " + out("notes.txt")), "notes.txt");
  EXPECT_EQ(contentOf(folder_ / "notes.txt"), "a person's notes\n");
  EXPECT_EQ(contentOf(folder_ / "other.json"), R"({"glint_scene": 1})");
}

TEST_F(OutputsOfCommands, AnEndingOfAnotherFormatIsRefused) {
  const std::string kMust = "the file's name must end in ";
  refuses(on("render", "--view plots -o " + out("r.svg")), kMust + ".png");
  refuses(on("render", "--view plots -o " + out("r.jpg")), kMust + ".png");
  refuses(on("reconstruct", "--model limit-angle -o " + out("r.json")), kMust + ".glint");
  refuses(on("evaluate", "--json " + out("r.csv")), kMust + ".json");
  refuses(on("evaluate", "--csv " + out("r.json")), kMust + ".csv");
  refuses(on("evaluate", "--html " + out("r.pdf")), kMust + ".html");
  refuses(on("info", "--json " + out("r.html")), kMust + ".json");
  refuses(on("tradeoff", "-o " + out("r.json")), kMust + ".glint");
  refuses(on("share", "-o " + out("r.svg")), kMust + ".html");
  for (const char* name : {"r.svg", "r.jpg", "r.json", "r.csv", "r.pdf", "r.html"})
    EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(on("info", "--json " + out("r.JSON")).code, 0);
  EXPECT_EQ(on("info", "--json " + out("r.report")).code, 0) << "no format's ending";
}

TEST_F(OutputsOfCommands, EveryOtherOutputRefusesAnotherKind) {
  saveSession("--model limit-angle");
  const std::string session = out("run.glint"), tradeoff = "tradeoff " + out("scene.json"),
                    notWritten = "was not written by this command";
  struct Row {
    std::string arguments, flag, file, words;
  };
  const Row rows[] = {
      {"movie " + session + " --size 320x240 -o " + out("m.mp4"), "--out", "m.mp4", "is not a movie"},
      {"movie " + session + " --size 320x240 --frames 0,1 -o " + out("p.png"), "--out", "p_0001.png", "is not a PNG"},
      {"compare " + session + " " + session + " --json " + out("c.json"), "--json", "c.json",
       "is not a JSON file with \"glint_comparison\""},
      {tradeoff + " -o " + out("t.glint"), "--out", "t.glint", "is not a JSON file with \"glint_session\""},
      {tradeoff + " --json " + out("t.json"), "--json", "t.json", "is not a JSON file with \"glint_tradeoff\""},
      {tradeoff + " --html " + out("t.html"), "--html", "t.html", "is not a page"},
      {tradeoff + " --json " + out("n.json") + " --work " + out("w"), "--work", "w",
       "is not a JSON file with \"glint_tradeoff_work\""},
      {tradeoff + " --json " + out("n.json"), "--work", "n.json.work", "is not a JSON file with \"glint_tradeoff_work\""},
      {"predict " + session + " --json " + out("q.json"), "--json", "q.json", "is not a JSON file with \"glint_predictions\""},
      {"predict " + session + " --out " + out("made"), "--out", "made/predictions.json", notWritten},
      {"predict " + session + " --out " + out("made"), "--out", "made/0003.png", notWritten},
      {"predict " + session + " --out " + out("made"), "--out", "made/labels_limit-angle.json", notWritten},
  };
  const std::string other = R"({"glint_scene": 1})";  // a document of this program, but of none of these kinds
  for (const Row& row : rows) {
    SCOPED_TRACE(row.arguments);
    folder_.write(row.file, other);
    const ProgramRun run = runGlint(row.arguments);
    refuses(run, row.file + ": " + row.flag + ": already exists");
    EXPECT_THAT(run.err, HasSubstr(row.words));
    EXPECT_EQ(contentOf(folder_ / row.file), other);
    fs::remove(folder_ / row.file);
  }
  for (const char* name : {"p.png", "p_0000.png", "n.json"}) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  EXPECT_TRUE(fs::is_empty(folder_ / "made"));
}

TEST_F(OutputsOfCommands, TheirOwnKindIsReplaced) {
  withHighlights();
  writeScene();
  const std::string files = "--json " + out("e.json") + " --csv " + out("e.csv") + " --html " + out("e.html");
  for (int twice = 0; twice < 2; ++twice) {
    const ProgramRun run = on("evaluate", files);
    EXPECT_EQ(run.code, 0) << run.err;
    saveSession();
  }
  refuses(on("evaluate", "--json " + out("same.json") + " --csv " + out("same.json")), "is already used for another output");
  EXPECT_FALSE(fs::exists(folder_ / "same.json"));
}

TEST_F(OutputsOfCommands, AFolderWithFilesOfOthersIsNotWrittenInto) {
  fs::create_directories(folder_ / "mine");
  folder_.write("mine/0000.png", "a photograph");
  refuses(on("detect", "--out " + out("mine")), "0000.png: --out: already exists and was not written by this command");
  EXPECT_EQ(contentOf(folder_ / "mine/0000.png"), "a photograph");
  for (int twice = 0; twice < 2; ++twice) {
    const ProgramRun run = on("detect", "--out " + out("found"));
    EXPECT_EQ(run.code, 0) << run.err;
  }
}

}  // namespace
}  // namespace glint
