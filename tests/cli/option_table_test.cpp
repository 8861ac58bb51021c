// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/option_table.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::cli {
namespace {

struct Values {
    std::filesystem::path input;
    double size = 0.5;
    std::optional<Share> accuracy;
    std::optional<FrameRange> frames;
    std::uint32_t points = 7;
    std::string method = "fast";
    bool force = false;
};

OptionTable table_of(Values& values) {
    OptionTable table("kinelux-test", "Tests.");
    table.add({.member = &values.input, .flags = "INPUT", .help = "what is read"});
    table.add({.member = &values.size,
               .flags = "-s,--size",
               .help = "edge length",
               .unit = "m",
               .low = 0.0,
               .high = 2.0});
    table.add({.member = &values.accuracy, .flags = "--accuracy", .help = "asked for", .low = 0, .high = 1});
    table.add({.member = &values.frames, .flags = "--frames", .help = "first and last", .unset = "all"});
    table.add({.member = &values.points, .flags = "--points", .help = "how many"});
    table.add({.member = &values.method, .flags = "--method", .help = "how", .words = {"fast", "exact"}});
    table.add({.member = &values.force, .flags = "--force", .help = "always", .decides = Decides::Manners});
    return table;
}

std::string error_of(const std::vector<std::string>& arguments) {
    Values values;
    OptionTable table = table_of(values);
    try {
        table.parse(arguments);
    } catch (const core::OptionError& error) {
        return error.what();
    }
    return "";
}

TEST(OptionTable, values_arrive_in_their_members) {
    Values values;
    OptionTable table = table_of(values);
    EXPECT_EQ(table.parse({"--size=1.25", "in.obj", "--frames", "2,5", "--points", "9", "--method", "exact",
                           "--force"}),
              OptionTable::Parsed::Go);
    EXPECT_EQ(values.input, "in.obj");
    EXPECT_EQ(values.size, 1.25);
    EXPECT_EQ(values.points, 9u);
    EXPECT_EQ(values.method, "exact");
    EXPECT_TRUE(values.force);
    ASSERT_TRUE(values.frames);
    EXPECT_EQ(values.frames->first, 2u);
    EXPECT_EQ(values.frames->last, 5u);
    EXPECT_FALSE(values.accuracy);
}

TEST(OptionTable, a_share_is_a_percentage_or_a_number) {
    for (const char* text : {"1%", "0.01", "1e-2", "1 %"}) {
        Values values;
        OptionTable table = table_of(values);
        table.parse({"in", "--accuracy", text});
        ASSERT_TRUE(values.accuracy) << text;
        EXPECT_DOUBLE_EQ(values.accuracy->value, 0.01) << text;
    }
}

TEST(OptionTable, what_is_wrong_names_the_option_and_what_was_expected) {
    EXPECT_EQ(error_of({"in", "--size", "3"}), "--size: 3 is outside 0..2 m");
    EXPECT_EQ(error_of({"in", "--size", "big"}), "--size: 'big' is not a number");
    EXPECT_EQ(error_of({"in", "--size", "1x"}), "--size: '1x' is not a number");
    EXPECT_EQ(error_of({"in", "--size", "nan"}), "--size: 'nan' is not a finite number");
    EXPECT_EQ(error_of({"in", "--points", "1.5"}), "--points: '1.5' is not a whole number >= 0");
    EXPECT_EQ(error_of({"in", "--frames", "5,2"}), "--frames: '5,2' ends before it starts");
    EXPECT_EQ(error_of({"in", "--method", "slow"}), "--method: 'slow' is none of: fast, exact");
    EXPECT_EQ(error_of({"in", "--sise", "1"}), "unknown option --sise; did you mean --size?");
    EXPECT_EQ(error_of({}), "INPUT is missing; usage: kinelux-test INPUT [options]");
    EXPECT_NE(error_of({"in", "--size"}), "");
}

TEST(OptionTable, effective_options_are_those_that_decide_the_result) {
    Values values;
    OptionTable table = table_of(values);
    table.parse({"in", "--force", "--points", "3"});
    EXPECT_EQ(table.effective(), "size = 0.5 m, accuracy = , frames = all, points = 3, method = fast");
    EXPECT_EQ(table.given("points"), (std::vector<std::string>{"--points", "3"}));
    EXPECT_EQ(table.given("force"), std::vector<std::string>{"--force"});
    EXPECT_TRUE(table.given("size").empty());
}

TEST(OptionTable, help_and_table_state_unit_range_and_default) {
    Values values;
    const OptionTable table = table_of(values);
    EXPECT_NE(table.help().find("-s, --size m"), std::string::npos);
    EXPECT_NE(table.help().find("edge length [0..2 m] (default: 0.5)"), std::string::npos);
    EXPECT_NE(table.markdown().find("| `-s,--size` | m | 0..2 | 0.5 | edge length |"), std::string::npos);
}

TEST(OptionTable, record_holds_every_value) {
    Values values;
    OptionTable table = table_of(values);
    table.parse({"in", "--accuracy", "3%", "--frames", "0,4"});
    core::RunRecord record("test");
    table.write_to(record);
    const std::string json = record.to_json();
    EXPECT_NE(json.find("\"accuracy\": 0.03"), std::string::npos) << json;
    EXPECT_NE(json.find("\"points\": 7"), std::string::npos) << json;
    EXPECT_NE(json.find("\"force\": false"), std::string::npos) << json;
}

} // namespace
} // namespace kinelux::cli
