// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kinelux::cli {

/// A number as short as it can be read back without harm: six digits, no trailing zeros.
std::string short_number(double value);

/// The known word that is the fewest letters away from `word`, or empty when none is near.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// Several lines as one: line breaks become blanks, so that an error stays one line.
std::string one_line(std::string_view text);

/// A field of a CSV file: in quotes when it holds a comma, a quote or a line break.
std::string csv_field(const std::string& text);

/// Columns of text for the terminal, each as wide as its longest entry; the last one is not padded.
class TextTable {
public:
    explicit TextTable(std::vector<std::string> heading) { rows_.push_back(std::move(heading)); }
    /// @param cells  as many as the heading has
    void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
    std::string text() const;

private:
    std::vector<std::vector<std::string>> rows_;
};

} // namespace kinelux::cli
