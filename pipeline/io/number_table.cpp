// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "core/error.h"
#include "io/mesh_import.h"

namespace kinelux::io {

namespace {

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) {
        const std::size_t first = cell.find_first_not_of(" \t\r");
        const std::size_t last = cell.find_last_not_of(" \t\r");
        result.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    return result;
}

std::vector<double> numbers(const NumberTable& table, int line, const std::vector<std::string>& row) {
    std::vector<double> values;
    for (const std::string& cell : row) {
        double value = 0.0;
        const char* end = cell.data() + cell.size();
        const auto [rest, error] = std::from_chars(cell.data(), end, value);
        if (error != std::errc{} || rest != end || !std::isfinite(value))
            table.fail(line, "'" + cell + "' is not a number");
        values.push_back(value);
    }
    return values;
}

} // namespace

void NumberTable::fail(int line, const std::string& what) const {
    throw core::FileError(fmt::format("{}:{}: {}", name, line, what));
}

NumberTable read_number_table(const std::filesystem::path& file,
                              const std::vector<std::vector<std::string>>& headers) {
    NumberTable table{file.string(), {}};
    std::istringstream stream(read_bytes(file));
    std::size_t columns = 0;
    int line = 0;
    for (std::string text; std::getline(stream, text);) {
        ++line;
        const std::vector<std::string> row = cells(text);
        if (text.starts_with('#') || row.empty() || (row.size() == 1 && row.front().empty())) continue;
        if (columns == 0) {
            if (std::find(headers.begin(), headers.end(), row) == headers.end()) {
                std::vector<std::string> known;
                known.reserve(headers.size());
                for (const auto& header : headers) known.push_back(fmt::format("{}", fmt::join(header, ",")));
                table.fail(line, fmt::format("expected the column names {}", fmt::join(known, " or ")));
            }
            columns = row.size();
            continue;
        }
        if (row.size() != columns)
            table.fail(line, fmt::format("expected {} numbers, found {}", columns, row.size()));
        table.rows.push_back({line, numbers(table, line, row)});
        if (table.rows.size() > 1 &&
            !(table.rows.back().values[0] > table.rows[table.rows.size() - 2].values[0]))
            table.fail(line, "time_s does not increase");
    }
    if (table.rows.empty()) table.fail(line, "holds no rows of numbers");
    return table;
}

} // namespace kinelux::io
