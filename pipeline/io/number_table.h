// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

// Tables of numbers beside a scene file. Private to io.
namespace kinelux::io {

/// A CSV file: one line of column names, then lines of as many numbers. Empty lines and those that begin with # are
/// skipped.
struct NumberTable {
    struct Row {
        int line = 0;
        std::vector<double> values;
    };
    std::string name;      ///< of the file, for messages
    std::vector<Row> rows; ///< at least one; the first column increases

    [[noreturn]] void fail(int line, const std::string& what) const; ///< FileError "name:line: what"
};

/// @param headers  lists of column names, one of which the file must begin with
/// @throws FileError  missing, another header, a cell that is not a number, a first column that does not increase, no row
NumberTable read_number_table(const std::filesystem::path& file,
                              const std::vector<std::vector<std::string>>& headers);

} // namespace kinelux::io
