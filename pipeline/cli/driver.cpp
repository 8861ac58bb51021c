// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/driver.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "cli/program.h"
#include "cli/stage.h"
#include "cli/text.h"
#include "core/error.h"
#include "core/log.h"
#include "core/run_record.h"

namespace kinelux::cli {

namespace fs = std::filesystem;

namespace {

struct StageCall {
    const char* name;
    const char* record;
    const char* summary;
    std::vector<const char*> options;     ///< of `kinelux run` that this stage knows
    bool resumes = false;                 ///< knows --resume
    std::vector<const char*> always = {}; ///< what a run gives it besides
};

const std::array<StageCall, 7>& stage_calls() {
    static const std::array<StageCall, 7> calls{{
        {"clean",
         "clean.json",
         "reads a scene, repairs its meshes",
         {"accuracy", "degree", "element-size", "allow-outside"}},
        {"fit", "fit.json", "fits patches to the meshes", {}},
        {"cluster", "cluster.json", "cuts patches into elements, gathers small triangles into clusters", {}},
        {"plan",
         "plan-record.json",
         "decides which effects the scene calls for",
         {},
         false,
         {"--prediction", "no"}},
        {"coefficients", "coefficients.json", "computes the transport blocks", {"seed", "memory-limit"}},
        {"solve", "solve.json", "solves for the light of every frame", {"seed", "frames", "engine"}, true},
        {"export", "export.json", "writes fields, meters and the ParaView script", {"seed", "frames"}},
    }};
    return calls;
}

std::string file_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

double number_in(const fs::path& record, std::string_view key) {
    return std::strtod(record_value(record, key).value_or("0").c_str(), nullptr);
}

} // namespace

RunTable::RunTable(const std::string& program, const std::string& summary, const std::string& argument_help)
    : RunTable(program, summary, argument_help, AccuracyRow{}) {
    stages_take_accuracy_ = true;
}

RunTable::RunTable(const std::string& program, const std::string& summary, const std::string& argument_help,
                   const AccuracyRow& accuracy_row)
    : options_(program, summary), stages_take_accuracy_(false) {
    options_.add({.member = &argument_, .flags = "SCENE", .help = argument_help});
    overrides_.emplace(options_, accuracy_row);
    options_.add({.member = &frames_,
                  .flags = "--frames",
                  .help = "first and last frame that are solved and exported",
                  .unset = "all"});
    options_.add({.member = &seed_, .flags = "--seed", .help = "of everything that is sampled"});
    options_.add({.member = &memory_limit_,
                  .flags = "--memory-limit",
                  .help = "refuse work that would need more",
                  .unit = "MiB",
                  .low = 1e-3,
                  .high = 1e9,
                  .unset = "4/5 of the machine's"});
    options_.add({.member = &force_, .flags = "--force", .help = "run every stage, up to date or not"});
    add_common_options(options_, threads_, quiet_, verbose_, log_file_);
}

fs::path RunTable::case_path() const { return overrides_->case_path(argument_); }

std::optional<double> RunTable::accuracy() const {
    return overrides_->accuracy ? std::optional(overrides_->accuracy->value) : std::nullopt;
}

void RunTable::apply() const { apply_common_options(threads_, quiet_, verbose_, log_file_); }

std::vector<std::string> RunTable::stage_arguments(const std::string& stage) const {
    const auto& calls = stage_calls();
    const auto call =
        std::find_if(calls.begin(), calls.end(), [&](const StageCall& c) { return c.name == stage; });
    std::vector<std::string> arguments;
    if (stage == "clean")
        arguments = {argument_.string(), "--output", case_path().string()};
    else
        arguments = {case_path().string()};
    std::vector<const char*> passed{"threads", "quiet", "verbose", "log-file"};
    passed.insert(passed.end(), call->options.begin(), call->options.end());
    for (const char* name : passed)
        if (stages_take_accuracy_ || std::string_view(name) != "accuracy")
            for (std::string& word : options_.given(name)) arguments.push_back(std::move(word));
    return arguments;
}

int RunTable::run_stage(const std::string& stage) const {
    return call_program("kinelux-" + stage, stage_arguments(stage));
}

int RunTable::run_until(const std::string& last) const {
    int result = 0;
    for (const StageCall& stage : stage_calls()) {
        Stage::throw_if_stopped();
        std::vector<std::string> arguments = stage_arguments(stage.name);
        if (!force_)
            arguments.emplace_back("--if-stale");
        else if (stage.resumes)
            arguments.insert(arguments.end(), {"--resume", "no"});
        arguments.insert(arguments.end(), stage.always.begin(), stage.always.end());
        const int code = call_program(fmt::format("kinelux-{}", stage.name), arguments);
        if (code != 0 && code != static_cast<int>(core::ExitCode::NotConverged)) return code;
        result = std::max(result, code);
        if (stage.name == last) break;
    }
    return result;
}

void RunTable::write_record() const {
    core::RunRecord record("kinelux run");
    double seconds = 0.0, memory = 0.0;
    for (const StageCall& stage : stage_calls()) {
        const fs::path file = case_path() / stage.record;
        record.set_json(fmt::format("stages/{}", stage.name), file_text(file));
        seconds += number_in(file, "seconds");
        memory = std::max(memory, number_in(file, "peak_memory_mib"));
    }
    record.set("totals/seconds", seconds);
    record.set("totals/peak_memory_mib", memory);
    record.write(case_path() / "run.json");
    core::log_info(fmt::format("kinelux run: {:.1f} s in all stages, {:.0f} MiB at most; {}", seconds, memory,
                               (case_path() / "view.pvd").string()));
}

int run_command(const std::vector<std::string>& arguments) {
    RunTable run("kinelux run", "From a scene to light on surfaces: all stages, only what is stale.",
                 "scene file (.toml), or a mesh with emissive materials");
    bool dry_run = false;
    std::string engine = "auto";
    run.options().add({.member = &engine,
                       .flags = "--engine",
                       .help = "of motion; see kinelux-solve",
                       .words = {"auto", "exact", "online", "offline", "paper"}});
    run.options().add(
        {.member = &dry_run,
         .flags = "--dry-run",
         .help = "stop after the plan and print it: effects, sizes, memory; nothing is solved"});
    if (run.options().parse(arguments) == OptionTable::Parsed::Answered) return 0;
    run.apply();

    if (dry_run) {
        const int code = run.run_until("cluster");
        return code != 0 ? code : run.run_stage("plan");
    }
    // The newest record tells whether any stage had something to do: run.json is written only then.
    const auto newest_record = [&] {
        fs::file_time_type newest = fs::file_time_type::min();
        for (const StageCall& stage : stage_calls())
            if (const fs::path file = run.case_path() / stage.record; fs::exists(file))
                newest = std::max(newest, fs::last_write_time(file));
        return newest;
    };
    const auto before = newest_record();
    const int code = run.run_until("export");
    if (code != 0 && code != static_cast<int>(core::ExitCode::NotConverged)) return code;
    if (newest_record() != before || !fs::exists(run.case_path() / "run.json")) run.write_record();
    return code;
}

int drive(const std::vector<std::string>& arguments, std::span<const Command> commands) {
    std::vector<std::pair<std::string, std::string>> described;
    for (const Command& command : commands) described.emplace_back(command.name, command.summary);
    for (const StageCall& stage : stage_calls())
        described.emplace_back(stage.name, fmt::format("kinelux-{}: {}", stage.name, stage.summary));
    for (const auto& [name, summary] :
         {std::pair("reference", "measures the exported irradiance against path tracing"),
          std::pair("study", "what accuracy costs on a scene, with measured errors"),
          std::pair("report", "one page of a case: pictures, plan, errors, times, meters, warnings")})
        described.emplace_back(name, fmt::format("kinelux-{}: {}", name, summary));
    std::vector<std::string> known;
    TextTable table({"", ""});
    for (const auto& [name, summary] : described) {
        known.push_back(name);
        table.row({name, summary});
    }

    if (arguments.empty()) throw core::OptionError("a command is missing; see kinelux --help");
    const std::string& word = arguments.front();
    const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
    if (word == "--help" || word == "-h") {
        fmt::print("kinelux COMMAND [options]\nDiffuse global illumination of scenes with moving bodies.\n{}"
                   "\nkinelux COMMAND --help lists the options of a command.\n",
                   table.text());
        return 0;
    }
    if (word == "--help-man") {
        fmt::print(".TH kinelux 1 \"\" \"Kinelux {}\"\n.SH NAME\nkinelux \\- diffuse global illumination of "
                   "scenes with moving "
                   "bodies\n.SH SYNOPSIS\nkinelux COMMAND [options]\n.SH COMMANDS\n",
                   core::version());
        for (const auto& [name, summary] : described) fmt::print(".TP\n.B {}\n{}\n", name, summary);
        fmt::print(".SH SEE ALSO\nEach command has a page of its own, as kinelux\\-run(1).\n");
        return 0;
    }
    if (word == "--version") {
        fmt::print("kinelux {}\n", core::version());
        return 0;
    }
    for (const Command& command : commands)
        if (command.name == word) return command.run(rest);
    if (std::find(known.begin(), known.end(), word) != known.end()) become_program("kinelux-" + word, rest);
    const std::string nearest = nearest_word(word, known);
    throw core::OptionError(
        fmt::format("there is no command '{}'; {}", word,
                    nearest.empty() ? "see kinelux --help" : fmt::format("did you mean {}?", nearest)));
}

} // namespace kinelux::cli
