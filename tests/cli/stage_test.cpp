// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/stage.h"

#include <fstream>

#include <gtest/gtest.h>

#include "cli/program.h"

namespace kinelux::cli {
namespace {

namespace fs = std::filesystem;

class Case : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / (std::string("kinelux-cli-") +
                                              testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder);
        fs::create_directories(folder);
        write("in.txt", "input");
    }
    void TearDown() override { fs::remove_all(folder); }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name) << text;
    }

    /// Runs a stage that writes out.txt. @return  exit code; works counts how often it really worked
    int run(const std::string& extra = "") {
        Stage stage({.name = "test", .summary = "", .inputs = {"in.txt"}, .outputs = {"out.txt"}});
        std::uint32_t amount = 1;
        stage.options().add({.member = &amount, .flags = "--amount", .help = "of it"});
        std::vector<std::string> words{"kinelux-test", folder.string(), "--quiet", "--if-stale"};
        if (!extra.empty()) words.push_back(extra);
        std::vector<char*> argv;
        argv.reserve(words.size());
        for (std::string& word : words) argv.push_back(word.data());
        return stage.run(static_cast<int>(argv.size()), argv.data(), [&](Stage& self) {
            ++works;
            self.step("write", [&] { write("out.txt", std::to_string(amount)); });
            self.count("things", 3);
            return code;
        });
    }

    fs::path folder;
    int works = 0;
    core::ExitCode code = core::ExitCode::Ok;
};

TEST_F(Case, a_stage_works_only_when_version_input_options_or_output_changed) {
    EXPECT_EQ(run(), 0);
    EXPECT_EQ(run(), 0);
    EXPECT_EQ(works, 1);
    run("-j2"); // how it is computed is not what is computed
    EXPECT_EQ(works, 1);
    run("--amount=2");
    EXPECT_EQ(works, 2);
    write("in.txt", "other");
    run("--amount=2");
    EXPECT_EQ(works, 3);
    write("out.txt", "damaged");
    run("--amount=2");
    EXPECT_EQ(works, 4);
}

TEST_F(Case, a_result_short_of_its_accuracy_stays_so) {
    code = core::ExitCode::NotConverged;
    EXPECT_EQ(run(), 5);
    EXPECT_EQ(run(), 5);
    EXPECT_EQ(works, 1);
}

TEST_F(Case, top_level_values_of_a_record_are_found) {
    run();
    EXPECT_EQ(record_value(folder / "test.json", "program"), "\"kinelux-test\"");
    EXPECT_EQ(record_value(folder / "test.json", "exit_code"), "0");
    EXPECT_EQ(record_value(folder / "test.json", "things"), std::nullopt); // not at the top
    EXPECT_EQ(record_value(folder / "absent.json", "program"), std::nullopt);
}

TEST(Program, exceptions_become_exit_codes) {
    char name[] = "test";
    char* argv[] = {name};
    const auto code_of = [&](auto raise) {
        return run_program("test", 1, argv, [&](const std::vector<std::string>&) -> int {
            raise();
            return 0;
        });
    };
    EXPECT_EQ(code_of([] {}), 0);
    EXPECT_EQ(code_of([] { throw core::OptionError("x"); }), 2);
    EXPECT_EQ(code_of([] { throw core::FileError("x"); }), 3);
    EXPECT_EQ(code_of([] { throw core::GeometryError("x"); }), 4);
    EXPECT_EQ(code_of([] { throw core::SolverError("x"); }), 5);
    EXPECT_EQ(code_of([] { throw core::ResourceError("x"); }), 6);
    EXPECT_EQ(code_of([] { throw std::bad_alloc(); }), 6);
    EXPECT_EQ(code_of([] { throw std::logic_error("x"); }), 1);
    EXPECT_EQ(code_of([] { throw 1; }), 1);
}

TEST(SceneFingerprint, changes_with_anything_a_scene_says) {
    model::Scene scene;
    scene.channels = {"grey"};
    model::Object object;
    object.name = "a";
    object.mesh.points = {Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0)};
    object.mesh.triangles = {{0, 1, 2}};
    scene.objects = {object};
    const std::string before = scene_fingerprint(scene);
    EXPECT_EQ(scene_fingerprint(scene), before);
    scene.objects[0].mesh.points[2].y = 2.0;
    const std::string moved = scene_fingerprint(scene);
    EXPECT_NE(moved, before);
    scene.accuracy.target = 0.5;
    EXPECT_NE(scene_fingerprint(scene), moved);
}

} // namespace
} // namespace kinelux::cli
