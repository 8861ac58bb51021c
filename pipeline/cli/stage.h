// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cli/option_table.h"
#include "core/error.h"
#include "core/run_record.h"
#include "io/case_folder.h"
#include "model/scene.h"

namespace kinelux::cli {

/// What a stage is called and which files of a case it turns into which.
struct StageFiles {
    std::string name;    ///< "fit": the executable is kinelux-fit
    std::string summary; ///< one sentence for --help
    std::vector<std::string>
        inputs; ///< files that decide the result; empty: the scene, which is no file of the case
    std::vector<std::string> outputs; ///< files, or folders with all they hold
    std::string record = {};          ///< file name of the run record; empty: <name>.json
};

/// What every stage does around its one library call: options, log, threads, the record with its key, steps that are
/// timed, and the check whether there is anything to do.
class Stage {
public:
    explicit Stage(StageFiles files);

    OptionTable& options() { return options_; }
    std::uint64_t& add_seed(); ///< adds --seed
    std::optional<FrameRange>& add_frames(const std::string& help,
                                          const std::string& unset = "all"); ///< adds --frames
    /// Adds --resume for a stage that saves what it has done. With it the stage does nothing when its result is there.
    void add_resume();

    /// The whole program: parses, prints the options, works, writes the record, reports. @return  exit code
    int run(int argc, char** argv, const std::function<core::ExitCode(Stage&)>& work);

    const std::filesystem::path& argument() const { return argument_; } ///< CASE, or SCENE
    const io::CaseFolder& folder() const { return *folder_; }
    core::RunRecord& record() { return record_; }
    bool quiet() const { return quiet_; }
    bool resumes() const { return resume_ == "yes"; }
    /// A hash of the executable, of all options that decide the result, and of the content of the input.
    const std::string& key() const { return key_; }

    // For stages that start from a scene.
    /// Whether the case at `path` holds the result of these inputs and --if-stale was given; finish() is then all
    /// there is to do. Without, makes the folder.
    void use_case(const std::filesystem::path& path) { case_path_ = path; }
    bool unchanged(const std::string& input_fingerprint);
    void make_folder();

    /// One timed step. @throws Interrupted  before it starts, when the user asked to stop
    template <class Work>
    auto step(const std::string& name, Work work) {
        throw_if_stopped();
        const core::StepTimer timer(record_, name);
        return work();
    }
    static void throw_if_stopped();

    /// A result for the record ("counts/<key>") and the summary line.
    template <std::integral Count>
    void count(const std::string& what, Count value) {
        add_count(what, static_cast<std::uint64_t>(value));
    }
    /// A result for the record ("figures/<what>_<unit>") and the summary line.
    void figure(const std::string& what, double value, const std::string& unit = "");

private:
    int work_on(const std::function<core::ExitCode(Stage&)>& work);
    void add_count(const std::string& what, std::uint64_t value);
    bool up_to_date(const std::string& key) const;
    std::string outputs_hash() const;
    std::filesystem::path record_file() const;

    StageFiles files_;
    std::string program_;
    OptionTable options_;
    core::RunRecord record_;
    std::filesystem::path argument_, case_path_, log_file_;
    std::optional<io::CaseFolder> folder_;
    std::uint64_t threads_ = 0, seed_ = 1;
    std::optional<FrameRange> frames_;
    bool quiet_ = false, verbose_ = false, if_stale_ = false, unchanged_ = false;
    std::string summary_, key_, resume_ = "no";
};

/// The options that every program has: --threads, --quiet, --verbose, --log-file.
void add_common_options(OptionTable& table, std::uint64_t& threads, bool& quiet, bool& verbose,
                        std::filesystem::path& log_file);
void apply_common_options(std::uint64_t threads, bool quiet, bool verbose,
                          const std::filesystem::path& log_file);

/// A hash of everything a scene says, meshes included: equal for equal content, wherever it was read from.
std::string scene_fingerprint(const model::Scene& scene);

/// The value of a top-level key of a run record as JSON text, or nothing: no record, or no such key.
std::optional<std::string> record_value(const std::filesystem::path& record, std::string_view key);

/// Memory that work may take when the user names no limit: four fifths of the machine's [MiB].
double default_memory_limit_mib();

} // namespace kinelux::cli
