// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/stage.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <span>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/program.h"
#include "cli/text.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/parallel.h"
#include "io/scene_json.h"

namespace kinelux::cli {

namespace fs = std::filesystem;

namespace {

template <class Value>
std::string bytes_hash(const std::vector<Value>& values) {
    static_assert(
        std::is_standard_layout_v<Value>); // numbers without padding: GLM vectors, ids, index arrays
    const auto bytes = std::as_bytes(std::span(values));
    return core::content_hash({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Names and hashes of a file, or of all files of a folder in the order of their names.
void add_hashes(const fs::path& path, std::string& hashes) {
    if (fs::is_regular_file(path)) {
        hashes += path.filename().string() + " " + core::file_hash(path) + "\n";
        return;
    }
    if (!fs::is_directory(path)) return;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) add_hashes(file, hashes);
}

} // namespace

Stage::Stage(StageFiles files)
    : files_(std::move(files)),
      program_("kinelux-" + files_.name),
      options_(program_, files_.summary),
      record_(program_) {
    if (files_.record.empty()) files_.record = files_.name + ".json";
    const bool from_scene = files_.inputs.empty();
    options_.add({.member = &argument_,
                  .flags = from_scene ? "SCENE" : "CASE",
                  .help = from_scene ? "scene file (.toml), or a mesh with emissive materials"
                                     : "folder of the case"});
    add_common_options(options_, threads_, quiet_, verbose_, log_file_);
    options_.add(
        {.member = &if_stale_,
         .flags = "--if-stale",
         .help = "do nothing when the result in the case was made by the same version from the same input "
                 "with the same options",
         .decides = Decides::Manners});
}

std::uint64_t& Stage::add_seed() {
    options_.add({.member = &seed_, .flags = "--seed", .help = "of everything that is sampled"});
    return seed_;
}

std::optional<FrameRange>& Stage::add_frames(const std::string& help, const std::string& unset) {
    options_.add({.member = &frames_, .flags = "--frames", .help = help, .unset = unset});
    return frames_;
}

void Stage::add_resume() {
    resume_ = "yes";
    options_.add({.member = &resume_,
                  .flags = "--resume",
                  .help = "go on from what an interrupted run has saved; compute nothing that is there",
                  .words = {"yes", "no"},
                  .decides = Decides::Manners});
}

int Stage::run(int argc, char** argv, const std::function<core::ExitCode(Stage&)>& work) {
    return run_program(program_, argc, argv, [&](const std::vector<std::string>& arguments) {
        if (options_.parse(arguments) == OptionTable::Parsed::Answered) return 0;
        return work_on(work);
    });
}

int Stage::work_on(const std::function<core::ExitCode(Stage&)>& work) {
    const auto started = std::chrono::steady_clock::now();
    apply_common_options(threads_, quiet_, verbose_, log_file_);
    if (!files_.inputs.empty()) {
        folder_.emplace(argument_);
        case_path_ = argument_;
        std::string inputs;
        for (const std::string& input : files_.inputs) add_hashes(folder_->file(input), inputs);
        if (unchanged(inputs))
            return std::atoi(record_value(record_file(), "exit_code").value_or("0").c_str());
    }
    const core::ExitCode code = work(*this);
    if (unchanged_) return std::atoi(record_value(record_file(), "exit_code").value_or("0").c_str());

    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    record_.set_json("warnings", "[]");
    for (const std::string& warning : core::warnings()) record_.append("warnings", warning);
    record_.set("seconds", seconds);
    record_.set("peak_memory_mib", core::peak_memory_mib());
    record_.set("exit_code", static_cast<int>(code));
    record_.set("key", key_);
    record_.set("outputs_hash", outputs_hash());
    record_.write(record_file());
    core::log_info(fmt::format("{}: {}{}{:.2f} s, {:.0f} MiB", program_, summary_,
                               summary_.empty() ? "" : "; ", seconds, core::peak_memory_mib()));
    return static_cast<int>(code);
}

bool Stage::unchanged(const std::string& input_fingerprint) {
    key_ = core::content_hash(fmt::format("{} {}\n{}\n{}", program_, core::file_hash("/proc/self/exe"),
                                          options_.effective(), input_fingerprint));
    if ((if_stale_ || resumes()) && up_to_date(key_)) {
        core::log_info(fmt::format("{}: up to date", program_));
        return unchanged_ = true;
    }
    if (const std::string options = options_.effective(); !options.empty())
        core::log_info(fmt::format("{}: {}", program_, options));
    options_.write_to(record_);
    for (const std::string& input : files_.inputs)
        if (fs::is_regular_file(folder_->file(input))) record_.add_input(folder_->file(input));
    return false;
}

bool Stage::up_to_date(const std::string& key) const {
    return record_value(record_file(), "key") == "\"" + key + "\"" &&
           record_value(record_file(), "outputs_hash") == "\"" + outputs_hash() + "\"";
}

void Stage::make_folder() { folder_.emplace(case_path_, true); }

std::string Stage::outputs_hash() const {
    std::string hashes;
    for (const std::string& output : files_.outputs) add_hashes(case_path_ / output, hashes);
    return core::content_hash(hashes);
}

fs::path Stage::record_file() const { return case_path_ / files_.record; }

void Stage::throw_if_stopped() {
    if (stop_signal() != 0) throw Interrupted{};
}

void Stage::add_count(const std::string& what, std::uint64_t value) {
    std::string key = "counts/" + what;
    std::replace(key.begin(), key.end(), ' ', '_');
    record_.set(key, value);
    summary_ += fmt::format("{}{} {}", summary_.empty() ? "" : ", ", value, what);
}

void Stage::figure(const std::string& what, double value, const std::string& unit) {
    std::string key = "figures/" + what;
    if (!unit.empty()) key += "_" + unit;
    std::replace(key.begin(), key.end(), ' ', '_');
    record_.set(key, value);
    const bool percent = unit.empty();
    summary_ += fmt::format("{}{} {:.3g} {}", summary_.empty() ? "" : ", ", what,
                            percent ? 100.0 * value : value, percent ? "%" : unit);
}

void add_common_options(OptionTable& table, std::uint64_t& threads, bool& quiet, bool& verbose,
                        fs::path& log_file) {
    table.add({.member = &threads,
               .flags = "-j,--threads",
               .help = "worker threads, 0 = all cores; results do not depend on it",
               .low = 0,
               .high = 4096,
               .decides = Decides::Manners});
    table.add({.member = &quiet,
               .flags = "-q,--quiet",
               .help = "print warnings and errors only",
               .decides = Decides::Manners});
    table.add(
        {.member = &verbose, .flags = "-v,--verbose", .help = "print details", .decides = Decides::Manners});
    table.add({.member = &log_file,
               .flags = "--log-file",
               .help = "append every line that is printed to this file",
               .unset = "none",
               .decides = Decides::Manners});
}

void apply_common_options(std::uint64_t threads, bool quiet, bool verbose, const fs::path& log_file) {
    if (quiet && verbose) throw core::OptionError("--quiet and --verbose exclude each other");
    core::configure_log(quiet     ? core::Verbosity::Quiet
                        : verbose ? core::Verbosity::Verbose
                                  : core::Verbosity::Normal,
                        log_file);
    core::set_thread_count(threads);
}

std::string scene_fingerprint(const model::Scene& scene) {
    std::vector<io::MeshFile> meshes;
    for (const model::Object& object : scene.objects) {
        const model::Mesh& mesh = object.mesh;
        meshes.push_back({.path = bytes_hash(mesh.points) + bytes_hash(mesh.triangles),
                          .hash = bytes_hash(mesh.materials) + bytes_hash(mesh.source_faces)});
    }
    return core::content_hash(io::scene_to_json({.format = "fingerprint", .program = {}}, scene, meshes));
}

std::optional<std::string> record_value(const fs::path& record, std::string_view key) {
    // Records are written with two blanks of indentation a level and no line break inside a value, so that a top-level
    // entry is a line of its own.
    std::ifstream in(record);
    const std::string start = fmt::format("  \"{}\": ", key);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(start)) continue;
        std::string value = line.substr(start.size());
        if (value.ends_with(',')) value.pop_back();
        return value;
    }
    return std::nullopt;
}

double default_memory_limit_mib() {
    const double bytes =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return 0.8 * bytes / (1024.0 * 1024.0);
}

} // namespace kinelux::cli
