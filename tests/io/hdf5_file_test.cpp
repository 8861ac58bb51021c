// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5_file.h"

#include <numeric>

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/temporary_folder.h"

namespace kinelux::io {

namespace {

class Hdf5FileTest : public testing::Test {
protected:
    support::TemporaryFolder temporary;
    const std::filesystem::path file = temporary.path() / "numbers.h5";
};

} // namespace

TEST_F(Hdf5FileTest, values_larger_than_a_chunk_come_back) {
    std::vector<double> values(3 * 1000 * 70);
    std::iota(values.begin(), values.end(), 0.125);
    Hdf5Writer writer(file);
    writer.dataset("deep/in/groups", std::span<const double>(values), {3, 1000, 70});
    writer.attribute("text", std::string("\xC3\xA4 text"));
    writer.attribute("number", 0.1);
    writer.attribute("integer", std::int64_t{-7});
    writer.finish();
    const Hdf5Reader reader(file);
    EXPECT_EQ(reader.shape("deep/in/groups"), (Hdf5Shape{3, 1000, 70}));
    EXPECT_EQ(reader.dataset<double>("deep/in/groups", {3, 1000, 70}), values);
    EXPECT_EQ(reader.text("text"), "\xC3\xA4 text");
    EXPECT_EQ(reader.number("number"), 0.1);
    EXPECT_EQ(reader.integer("integer"), -7);
}

TEST_F(Hdf5FileTest, nothing_lies_under_the_final_name_before_finish) {
    {
        Hdf5Writer writer(file);
        writer.dataset("a", std::vector<float>{1.0f});
        EXPECT_FALSE(std::filesystem::exists(file));
    }
    EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
}

TEST_F(Hdf5FileTest, another_shape_type_or_name_is_refused) {
    Hdf5Writer writer(file);
    writer.dataset("a", std::vector<float>{1.0f, 2.0f});
    writer.attribute("number", 1.0);
    writer.finish();
    const Hdf5Reader reader(file);
    EXPECT_THROW(reader.dataset<float>("a", {3}), core::FileError);
    EXPECT_THROW(reader.dataset<float>("a", {2, 1}), core::FileError);
    EXPECT_THROW(reader.dataset<double>("a"), core::FileError);
    EXPECT_THROW(reader.dataset<float>("b"), core::FileError);
    EXPECT_THROW(reader.text("number"), core::FileError);
    EXPECT_THROW(reader.integer("number"), core::FileError);
    EXPECT_THROW(reader.number("nothing"), core::FileError);
}

TEST_F(Hdf5FileTest, folder_that_is_not_there_is_an_error) {
    EXPECT_THROW(Hdf5Writer(temporary.path() / "nothing" / "numbers.h5"), core::FileError);
    EXPECT_THROW(Hdf5Reader(temporary.path() / "numbers.h5"), core::FileError);
}

TEST_F(Hdf5FileTest, shape_that_does_not_fit_the_values_is_our_own_mistake) {
    Hdf5Writer writer(file);
    EXPECT_THROW(writer.dataset("a", std::span<const double>(), {2}), std::logic_error);
}

} // namespace kinelux::io
