// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace kinelux::core {

/// What a run was and what it cost, written as <stage>.json beside the results: program version, effective options,
/// seed, input hashes, seconds and peak memory per step, counts and errors. The keys are documented in
/// docs/formats.md and are stable: scripts read them.
class RunRecord {
public:
    explicit RunRecord(std::string_view program);
    ~RunRecord();
    RunRecord(RunRecord&&) noexcept;
    RunRecord& operator=(RunRecord&&) noexcept;

    /// Sets `key`, a path with '/' between levels (e.g. "counts/patches"), to a value.
    void set(std::string_view key, double value);
    void set(std::string_view key, std::int64_t value);
    void set(std::string_view key, std::uint64_t value) { set(key, static_cast<std::int64_t>(value)); }
    void set(std::string_view key, int value) { set(key, static_cast<std::int64_t>(value)); }
    void set(std::string_view key, bool value);
    void set(std::string_view key, std::string_view value);
    void set(std::string_view key, const char* value) { set(key, std::string_view(value)); }
    /// Appends a value to the list at `key`.
    void append(std::string_view key, double value);
    void append(std::string_view key, std::string_view value);
    /// Sets `key` to a ready-made piece of JSON.
    void set_json(std::string_view key, std::string_view json);

    /// Records an input file and its content hash under "inputs". @throws FileError  it cannot be read
    void add_input(const std::filesystem::path& file);

    /// The record as indented JSON.
    std::string to_json() const;
    /// Writes to_json() aside and renames it. @throws FileError
    void write(const std::filesystem::path& file) const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Measures one step and puts "steps/<name>/{seconds,peak_memory_mib}" into the record when it ends.
class StepTimer {
public:
    StepTimer(RunRecord& record, std::string name);
    ~StepTimer();
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

private:
    RunRecord& record_;
    std::string name_;
    std::chrono::steady_clock::time_point started_;
};

/// Peak resident memory of this process so far [MiB].
double peak_memory_mib();

/// Writes bytes to `file`.part, then renames it to `file`: never a half-written result. @throws FileError
void write_whole_file(const std::filesystem::path& file, std::string_view bytes);

/// The program's version, e.g. "0.1.0".
std::string_view version();

} // namespace kinelux::core
