// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/run_record.h"

namespace kinelux::cli {

/// A share of one, written "1%" or "0.01" at the command line.
struct Share {
    double value = 0.0; ///< [1]
};

/// Frames first..last, both included, written "2,5" at the command line.
struct FrameRange {
    std::uint32_t first = 0, last = 0;
    bool contains(std::uint32_t frame) const { return first <= frame && frame <= last; }
};

/// Where a row's value goes. Optionals stay unset when the option is not given.
using OptionMember = std::variant<bool*, int*, std::uint32_t*, std::uint64_t*, double*, std::string*,
                                  std::filesystem::path*, std::optional<int>*, std::optional<double>*,
                                  std::optional<Share>*, std::optional<FrameRange>*>;

/// Whether an option decides what is computed, or only how the program behaves meanwhile.
enum class Decides : std::uint8_t { Result, Manners };

/// One option: parses, prints, documents and records itself.
struct OptionRow {
    OptionMember member;
    std::string flags; ///< "-j,--threads"; a name in capitals is a required positional argument
    std::string help;  ///< one sentence without full stop
    std::string unit = {};
    double low = -std::numeric_limits<double>::infinity(); ///< smallest value allowed
    double high = std::numeric_limits<double>::infinity(); ///< largest value allowed
    std::string unset = {};                                ///< what holds when an optional is not given
    std::vector<std::string> words = {};                   ///< the values a text may have; empty: any
    Decides decides = Decides::Result;
};

/// The options of one executable.
class OptionTable {
public:
    OptionTable(std::string program, std::string summary);

    /// The member must outlive the table; its value at this moment is the default.
    void add(OptionRow row);

    enum class Parsed : std::uint8_t { Go, Answered }; ///< Answered: --help or --version was printed
    /// @param arguments  without the program's name
    /// @throws OptionError  unknown (with the nearest known one), missing, not a value of its kind, out of range
    Parsed parse(const std::vector<std::string>& arguments);

    std::string help() const;
    /// The rows as a Markdown table: option, unit, range, default, meaning.
    std::string markdown() const;
    /// A manual page for man(1).
    std::string man() const;
    /// "name value unit, ..." of all options that decide the result.
    std::string effective() const;
    /// Puts all values under "options/<name>" of a record.
    void write_to(core::RunRecord& record) const;
    /// "--flag", "value" as given at the command line; empty when the option was not given.
    std::vector<std::string> given(std::string_view name) const;
    const std::string& program() const { return program_; }

private:
    /// Each option as it is written, and what it means; --help and --version last.
    std::vector<std::pair<std::string, std::string>> described() const;

    struct Entry {
        OptionRow row;
        std::string name;         ///< "threads" of "-j,--threads"
        std::string default_text; ///< value before parsing
        std::optional<std::string> given;
        bool positional = false;
    };
    std::string usage() const;

    std::string program_, summary_;
    std::vector<Entry> entries_;
};

} // namespace kinelux::cli
