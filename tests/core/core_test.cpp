// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/parallel.h"
#include "core/run_record.h"
#include "core/sequence.h"

namespace kinelux::core {
namespace {

TEST(Sobol, every_power_of_two_block_fills_every_elementary_interval) {
    for (const std::uint64_t seed : {1ull, 77ull, 123456789ull}) {
        constexpr std::uint32_t count = 64;
        for (std::uint32_t columns = 1; columns <= count; columns *= 2) {
            std::set<std::pair<int, int>> cells;
            for (std::uint32_t k = 0; k < count; ++k) {
                const Vec2 p = sobol_2d(k, seed);
                ASSERT_GE(std::min(p.x, p.y), 0.0);
                ASSERT_LT(std::max(p.x, p.y), 1.0);
                const std::uint32_t rows = count / columns;
                cells.emplace(static_cast<int>(p.x * columns), static_cast<int>(p.y * rows));
            }
            EXPECT_EQ(cells.size(), count) << columns << " columns, seed " << seed;
        }
    }
}

TEST(Random, has_mean_one_half_and_differs_between_seeds) {
    Random a(1), b(2);
    double sum = 0.0;
    for (int k = 0; k < 10000; ++k) sum += a.next();
    EXPECT_NEAR(sum / 10000.0, 0.5, 5.0 / std::sqrt(12.0 * 10000.0)); // five standard deviations
    EXPECT_NE(a.next(), b.next());
}

TEST(ContentHash, depends_on_every_byte) {
    EXPECT_EQ(content_hash("kinelux"), content_hash("kinelux"));
    EXPECT_NE(content_hash("kinelux"), content_hash("kinelux "));
    EXPECT_EQ(content_hash("").size(), 32u);
    EXPECT_THROW(file_hash("/nowhere/at/all"), FileError);
}

TEST(WholeFile, replaces_the_old_one_and_leaves_no_part) {
    const auto file = std::filesystem::temp_directory_path() / "kinelux_whole_file_test";
    write_whole_file(file, "old");
    write_whole_file(file, "new text");
    std::ifstream in(file);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_EQ(text, "new text");
    EXPECT_EQ(file_hash(file), content_hash("new text"));
    EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
    EXPECT_THROW(write_whole_file("/nowhere/at/all", "x"), FileError);
}

TEST(RunRecord, nests_keys_and_measures_steps) {
    RunRecord record("kinelux-test");
    record.set("counts/patches", 7);
    { const StepTimer timer(record, "read"); }
    const std::string json = record.to_json();
    EXPECT_NE(json.find("\"patches\": 7"), std::string::npos);
    EXPECT_NE(json.find("\"peak_memory_mib\""), std::string::npos);
    EXPECT_NE(json.find("\"version\""), std::string::npos);
}

TEST(RunRecord, writes_bytes_that_are_no_text_as_replacement_characters) {
    RunRecord record("test");
    record.append("warnings", "room\xff.obj: empty");
    EXPECT_NE(record.to_json().find("room\xef\xbf\xbd.obj: empty"), std::string::npos);
}

TEST(Log, keeps_warnings_in_order) {
    const std::size_t before = warnings().size();
    log_warning("one");
    log_info("no warning");
    log_warning("another");
    const std::vector<std::string> all = warnings();
    ASSERT_EQ(all.size(), before + 2);
    EXPECT_EQ(all[before], "one");
    EXPECT_EQ(all[before + 1], "another");
}

TEST(ParallelFor, visits_every_index_once_and_hands_on_exceptions) {
    std::vector<std::atomic<int>> visits(1000);
    parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
    for (const auto& count : visits) EXPECT_EQ(count.load(), 1);
    EXPECT_THROW(parallel_for(10,
                              [](std::size_t i) {
                                  if (i == 3) throw GeometryError("face 3");
                              }),
                 GeometryError);
}

} // namespace
} // namespace kinelux::core
