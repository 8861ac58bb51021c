// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/run_record.h"

#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "core/error.h"
#include "core/hash.h"

namespace kinelux::core {

using Json = nlohmann::ordered_json;

struct RunRecord::Data {
    Json root;

    Json& at(std::string_view key) { return root[Json::json_pointer("/" + std::string(key))]; }
};

RunRecord::RunRecord(std::string_view program) : data_(std::make_unique<Data>()) {
    set("program", program);
    set("version", version());
}

RunRecord::~RunRecord() = default;
RunRecord::RunRecord(RunRecord&&) noexcept = default;
RunRecord& RunRecord::operator=(RunRecord&&) noexcept = default;

void RunRecord::set(std::string_view key, double value) { data_->at(key) = value; }
void RunRecord::set(std::string_view key, std::int64_t value) { data_->at(key) = value; }
void RunRecord::set(std::string_view key, bool value) { data_->at(key) = value; }
void RunRecord::set(std::string_view key, std::string_view value) { data_->at(key) = value; }
void RunRecord::append(std::string_view key, double value) { data_->at(key).push_back(value); }
void RunRecord::append(std::string_view key, std::string_view value) { data_->at(key).push_back(value); }
void RunRecord::set_json(std::string_view key, std::string_view json) { data_->at(key) = Json::parse(json); }

void RunRecord::add_input(const std::filesystem::path& file) {
    data_->root["inputs"].push_back({{"file", file.string()}, {"hash", file_hash(file)}});
}

std::string RunRecord::to_json() const {
    return data_->root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void RunRecord::write(const std::filesystem::path& file) const { write_whole_file(file, to_json()); }

StepTimer::StepTimer(RunRecord& record, std::string name)
    : record_(record), name_(std::move(name)), started_(std::chrono::steady_clock::now()) {}

StepTimer::~StepTimer() {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    record_.set("steps/" + name_ + "/seconds", seconds);
    record_.set("steps/" + name_ + "/peak_memory_mib", peak_memory_mib());
}

double peak_memory_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void write_whole_file(const std::filesystem::path& file, std::string_view bytes) {
    auto part = file;
    part += ".part";
    {
        std::ofstream out(part, std::ios::binary);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        out.close();
        if (!out)
            throw FileError(fmt::format("{}: cannot be written; is the folder there, writable and not full?",
                                        file.string()));
    }
    std::error_code failure;
    std::filesystem::rename(part, file, failure);
    if (failure) throw FileError(fmt::format("{}: cannot be replaced: {}", file.string(), failure.message()));
}

std::string_view version() { return KINELUX_VERSION; }

} // namespace kinelux::core
