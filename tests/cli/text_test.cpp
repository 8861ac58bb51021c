// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/text.h"

#include <array>

#include <gtest/gtest.h>

namespace kinelux::cli {
namespace {

TEST(Text, nearest_word_finds_slips_and_nothing_else) {
    const std::array<std::string, 3> known{"--accuracy", "--degree", "--frames"};
    EXPECT_EQ(nearest_word("--acuracy", known), "--accuracy");
    EXPECT_EQ(nearest_word("--frame", known), "--frames");
    EXPECT_EQ(nearest_word("--what-else", known), "");
}

TEST(Text, an_error_stays_one_line) { EXPECT_EQ(one_line("a\nb\r\nc"), "a b  c"); }

TEST(Text, csv_fields_are_quoted_where_they_must_be) {
    EXPECT_EQ(csv_field("plain name"), "plain name");
    EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
    EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
}

TEST(Text, columns_align_by_characters_not_bytes) {
    TextTable table({"name", "value"});
    table.row({"m\xc3\xbc", "1"});
    EXPECT_EQ(table.text(), "  name  value\n  m\xc3\xbc    1\n");
}

} // namespace
} // namespace kinelux::cli
