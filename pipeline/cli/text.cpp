// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/text.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

namespace kinelux::cli {

namespace {

/// Levenshtein's distance: insertions, deletions and substitutions that lead from a to b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// Characters, not bytes, of a UTF-8 text: what a terminal shows.
std::size_t shown_width(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xc0') != '\x80'; }));
}

} // namespace

std::string short_number(double value) { return fmt::format("{:.6g}", value); }

std::string nearest_word(std::string_view word, std::span<const std::string> known) {
    std::string nearest;
    std::size_t least = word.size() / 3 + 2; // as many slips of the finger as are taken for the same word
    for (const std::string& candidate : known)
        if (const std::size_t distance = edit_distance(word, candidate); distance < least) {
            least = distance;
            nearest = candidate;
        }
    return nearest;
}

std::string one_line(std::string_view text) {
    std::string line(text);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return line;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string TextTable::text() const {
    const std::size_t columns = rows_.front().size();
    std::vector<std::size_t> widths(columns, 0);
    for (const auto& row : rows_)
        for (std::size_t c = 0; c < columns; ++c) widths[c] = std::max(widths[c], shown_width(row[c]));
    std::string text;
    for (const auto& row : rows_) {
        std::string line = " ";
        for (std::size_t c = 0; c < columns; ++c) {
            line += " " + row[c];
            if (c + 1 < columns) line += std::string(widths[c] - shown_width(row[c]) + 1, ' ');
        }
        text += line + "\n";
    }
    return text;
}

} // namespace kinelux::cli
