// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/text.h"
#include "core/error.h"

namespace kinelux::cli {

namespace {

// ---- text -> value. Each throws OptionError saying what was expected; the caller adds which option it was.

template <class Number>
Number number_from(std::string_view text, const char* expected) {
    Number value{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end != text.data() + text.size())
        throw core::OptionError(fmt::format("'{}' is not {}", text, expected));
    return value;
}

double real_from(std::string_view text) {
    const auto value = number_from<double>(text, "a number");
    if (!std::isfinite(value)) throw core::OptionError(fmt::format("'{}' is not a finite number", text));
    return value;
}

Share share_from(std::string_view text) {
    const bool percent = text.ends_with('%');
    if (percent) text.remove_suffix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
    return {real_from(text) / (percent ? 100.0 : 1.0)};
}

FrameRange frames_from(std::string_view text) {
    const auto comma = text.find(',');
    const auto first = number_from<std::uint32_t>(text.substr(0, comma), "two frame numbers as in 0,9");
    if (comma == std::string_view::npos) return {first, first};
    const auto last = number_from<std::uint32_t>(text.substr(comma + 1), "two frame numbers as in 0,9");
    if (last < first) throw core::OptionError(fmt::format("'{}' ends before it starts", text));
    return {first, last};
}

/// " m"; nothing for plain numbers.
std::string shown_unit(const OptionRow& row) {
    return row.unit.empty() || row.unit == "1" ? "" : " " + row.unit;
}

void check_range(const OptionRow& row, double value) {
    if (value < row.low || value > row.high)
        throw core::OptionError(fmt::format("{} is outside {}..{}{}", short_number(value),
                                            short_number(row.low), short_number(row.high), shown_unit(row)));
}

struct Assign {
    const OptionRow& row;
    const std::string& text;

    void operator()(bool* member) const { *member = true; }
    void operator()(std::string* member) const {
        if (!row.words.empty() && std::find(row.words.begin(), row.words.end(), text) == row.words.end())
            throw core::OptionError(fmt::format("'{}' is none of: {}", text, fmt::join(row.words, ", ")));
        *member = text;
    }
    void operator()(std::filesystem::path* member) const { *member = text; }
    void operator()(std::optional<FrameRange>* member) const { *member = frames_from(text); }
    void operator()(std::optional<Share>* member) const {
        const Share share = share_from(text);
        check_range(row, share.value);
        *member = share;
    }
    template <class Number>
    void operator()(Number* member) const {
        *member = checked<Number>();
    }
    template <class Number>
    void operator()(std::optional<Number>* member) const {
        *member = checked<Number>();
    }

private:
    template <class Number>
    Number checked() const {
        Number value{};
        if constexpr (std::is_same_v<Number, double>)
            value = real_from(text);
        else
            value = number_from<Number>(text,
                                        std::is_signed_v<Number> ? "a whole number" : "a whole number >= 0");
        check_range(row, static_cast<double>(value));
        return value;
    }
};

// ---- value -> text

struct Print {
    const OptionRow& row;

    std::string operator()(const bool* value) const { return *value ? "yes" : "no"; }
    std::string operator()(const std::string* value) const { return *value; }
    std::string operator()(const std::filesystem::path* value) const {
        return value->empty() ? row.unset : value->string();
    }
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    template <class Integer>
    std::string operator()(const Integer* value) const {
        return std::to_string(*value);
    }
    std::string operator()(const std::optional<Share>* value) const {
        return *value ? fmt::format("{}", (*value)->value) : row.unset;
    }
    std::string operator()(const std::optional<FrameRange>* value) const {
        return *value ? fmt::format("{},{}", (*value)->first, (*value)->last) : row.unset;
    }
    template <class Number>
    std::string operator()(const std::optional<Number>* value) const {
        return *value ? fmt::format("{}", **value) : row.unset;
    }
};

struct Record {
    core::RunRecord& record;
    const std::string& key;

    void operator()(const std::filesystem::path* value) const { record.set(key, value->string()); }
    void operator()(const std::optional<FrameRange>* value) const {
        if (!*value) return record.set_json(key, "null");
        record.append(key, static_cast<double>((*value)->first));
        record.append(key, static_cast<double>((*value)->last));
    }
    void operator()(const std::optional<Share>* value) const {
        if (*value)
            record.set(key, (*value)->value);
        else
            record.set_json(key, "null");
    }
    template <class Value>
    void operator()(const std::optional<Value>* value) const {
        if (*value)
            record.set(key, **value);
        else
            record.set_json(key, "null");
    }
    template <class Value>
    void operator()(const Value* value) const {
        if constexpr (std::is_same_v<Value, std::uint32_t>)
            record.set(key, static_cast<std::uint64_t>(*value));
        else if constexpr (std::is_same_v<Value, std::string>)
            record.set(key, std::string_view(*value));
        else
            record.set(key, *value);
    }
};

// ---- descriptions

bool is_switch(const OptionRow& row) { return std::holds_alternative<bool*>(row.member); }

std::string value_word(const OptionRow& row) {
    if (is_switch(row)) return "";
    if (!row.words.empty()) return fmt::format("{}", fmt::join(row.words, "|"));
    if (!row.unit.empty() && row.unit != "1") return row.unit;
    if (std::holds_alternative<std::filesystem::path*>(row.member)) return "PATH";
    if (std::holds_alternative<std::optional<FrameRange>*>(row.member)) return "FIRST,LAST";
    if (std::holds_alternative<std::optional<Share>*>(row.member)) return "SHARE";
    return "NUMBER";
}

std::string range_text(const OptionRow& row) {
    if (std::isinf(row.low) && std::isinf(row.high)) return "";
    if (std::isinf(row.high)) return fmt::format(">= {}", short_number(row.low));
    return fmt::format("{}..{}", short_number(row.low), short_number(row.high));
}

/// An unknown option with the nearest known one.
core::OptionError unknown_option(const std::string& text, const std::vector<std::string>& known) {
    const std::string flag = text.substr(0, text.find('='));
    const std::string nearest = nearest_word(flag, known);
    const std::string hint = nearest.empty() ? "see --help" : fmt::format("did you mean {}?", nearest);
    if (!text.starts_with('-'))
        return core::OptionError(fmt::format("one argument too many: '{}'; {}", text, hint));
    return core::OptionError(fmt::format("unknown option {}; {}", flag, hint));
}

} // namespace

OptionTable::OptionTable(std::string program, std::string summary)
    : program_(std::move(program)), summary_(std::move(summary)) {}

void OptionTable::add(OptionRow row) {
    Entry entry{.row = std::move(row), .name = {}, .default_text = {}, .given = {}};
    entry.positional = !entry.row.flags.starts_with('-');
    const auto dashes = entry.row.flags.rfind("--");
    entry.name = dashes == std::string::npos ? entry.row.flags : entry.row.flags.substr(dashes + 2);
    entry.default_text = std::visit(Print{entry.row}, entry.row.member);
    entries_.push_back(std::move(entry));
}

OptionTable::Parsed OptionTable::parse(const std::vector<std::string>& arguments) {
    CLI::App app;
    app.set_help_flag();
    app.allow_extras();
    bool help_wanted = false, markdown_wanted = false, man_wanted = false, version_wanted = false;
    app.add_flag("-h,--help", help_wanted);
    app.add_flag("--help-markdown", markdown_wanted);
    app.add_flag("--help-man", man_wanted);
    app.add_flag("--version", version_wanted);
    std::vector<std::string> known{"--help", "--version"};
    for (Entry& entry : entries_) {
        if (!entry.positional) known.push_back("--" + entry.name);
        if (is_switch(entry.row))
            app.add_flag_callback(entry.row.flags, [&entry] { entry.given = ""; });
        else
            app.add_option_function<std::string>(entry.row.flags,
                                                 [&entry](const std::string& text) { entry.given = text; });
    }
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        throw core::OptionError(one_line(error.what()) + "; see --help");
    }
    if (help_wanted || markdown_wanted || man_wanted || version_wanted) {
        if (version_wanted)
            fmt::print("{} {}\n", program_, core::version());
        else
            fmt::print("{}", markdown_wanted ? markdown() : man_wanted ? man() : help());
        return Parsed::Answered;
    }
    if (const auto extras = app.remaining(); !extras.empty()) throw unknown_option(extras.front(), known);
    for (Entry& entry : entries_) {
        if (entry.positional && !entry.given)
            throw core::OptionError(fmt::format("{} is missing; usage: {}", entry.name, usage()));
        if (!entry.given) continue;
        try {
            std::visit(Assign{entry.row, *entry.given}, entry.row.member);
        } catch (const core::OptionError& error) {
            throw core::OptionError(
                fmt::format("{}{}: {}", entry.positional ? "" : "--", entry.name, error.what()));
        }
    }
    return Parsed::Go;
}

std::string OptionTable::usage() const {
    std::string text = program_;
    for (const Entry& entry : entries_)
        if (entry.positional) text += " " + entry.name;
    return text + " [options]";
}

std::vector<std::pair<std::string, std::string>> OptionTable::described() const {
    std::vector<std::pair<std::string, std::string>> rows;
    for (const Entry& entry : entries_) {
        const OptionRow& row = entry.row;
        const std::string range = range_text(row);
        std::string help = row.help;
        if (!range.empty()) help += fmt::format(" [{}{}]", range, shown_unit(row));
        if (!entry.positional && !is_switch(row) && !entry.default_text.empty())
            help += fmt::format(" (default: {})", entry.default_text);
        std::string flags = row.flags;
        if (const auto comma = flags.find(','); comma != std::string::npos) flags.replace(comma, 1, ", ");
        rows.emplace_back(
            entry.positional ? entry.name : flags + (is_switch(row) ? "" : " " + value_word(row)), help);
    }
    rows.emplace_back("-h, --help", "this text");
    rows.emplace_back("--version", "the program's version");
    return rows;
}

std::string OptionTable::man() const {
    const auto escaped = [](const std::string& text) {
        std::string result;
        for (const char c : text) {
            if (c == '-' || c == '\\') result += '\\';
            result += c;
        }
        return result;
    };
    std::string page_name = program_; // "kinelux run" has the page kinelux-run
    std::replace(page_name.begin(), page_name.end(), ' ', '-');
    std::string text =
        fmt::format(".TH {0} 1 \"\" \"Kinelux {1}\"\n.SH NAME\n{0} \\- {2}\n.SH SYNOPSIS\n{3}\n.SH OPTIONS\n",
                    escaped(page_name), core::version(), escaped(summary_), escaped(usage()));
    for (const auto& [flags, meaning] : described())
        text += fmt::format(".TP\n.B {}\n{}\n", escaped(flags), escaped(meaning));
    return text + ".SH SEE ALSO\nkinelux(1)\n";
}

std::string OptionTable::help() const {
    TextTable table({"", ""});
    for (const auto& [flags, meaning] : described()) table.row({flags, meaning});
    const std::string rows = table.text();
    return fmt::format("{}\n{}\n\n{}", usage(), summary_, rows.substr(rows.find('\n') + 1));
}

std::string OptionTable::markdown() const {
    std::string text = "| option | unit | range | default | meaning |\n|---|---|---|---|---|\n";
    for (const Entry& entry : entries_) {
        const OptionRow& row = entry.row;
        const std::string choices =
            row.words.empty() ? range_text(row) : fmt::format("{}", fmt::join(row.words, ", "));
        text += fmt::format("| `{}` | {} | {} | {} | {} |\n", row.flags, row.unit, choices,
                            entry.positional ? "(required)" : entry.default_text, row.help);
    }
    return text;
}

std::string OptionTable::effective() const {
    std::string text;
    for (const Entry& entry : entries_) {
        if (entry.positional || entry.row.decides == Decides::Manners) continue;
        const std::string value = std::visit(Print{entry.row}, entry.row.member);
        text += fmt::format("{}{} = {}{}", text.empty() ? "" : ", ", entry.name, value,
                            value == entry.row.unset ? "" : shown_unit(entry.row));
    }
    return text;
}

void OptionTable::write_to(core::RunRecord& record) const {
    for (const Entry& entry : entries_) {
        std::string key = "options/" + entry.name;
        std::replace(key.begin(), key.end(), '-', '_');
        std::visit(Record{record, key}, entry.row.member);
    }
}

std::vector<std::string> OptionTable::given(std::string_view name) const {
    for (const Entry& entry : entries_) {
        if (entry.name != name || !entry.given) continue;
        if (is_switch(entry.row)) return {"--" + entry.name};
        return {"--" + entry.name, *entry.given};
    }
    return {};
}

} // namespace kinelux::cli
