// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "cli/driver.h"
#include "cli/plan_table.h"
#include "cli/stage.h"
#include "cli/text.h"
#include "core/error.h"
#include "core/log.h"
#include "io/case_folder.h"
#include "io/case_hdf5.h"
#include "io/read_scene.h"
#include "io/scene_json.h"
#include "io/write_view.h"

namespace kinelux::cli {

namespace fs = std::filesystem;

namespace {

struct Bounds {
    Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const std::vector<Vec3>& points) {
        for (const Vec3& point : points) {
            low = glm::min(low, point);
            high = glm::max(high, point);
        }
    }
};

/// Lines "name  value"; what one command prints.
class Facts {
public:
    void add(const std::string& name, const std::string& value) {
        text_ += fmt::format("  {:<18}{}\n", name, value);
    }
    void add(const std::string& name, std::size_t value) { add(name, std::to_string(value)); }
    void add(const Bounds& bounds) {
        if (bounds.low.x > bounds.high.x) return;
        add("bounds [m]",
            fmt::format("{} {} {} .. {} {} {}", short_number(bounds.low.x), short_number(bounds.low.y),
                        short_number(bounds.low.z), short_number(bounds.high.x), short_number(bounds.high.y),
                        short_number(bounds.high.z)));
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

std::string all_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw core::FileError(fmt::format("{}: cannot be read; is the path right?", file.string()));
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string origin(const io::FileHeader& header) {
    return fmt::format("{}, format version {}, written by Kinelux {}", header.format, header.version,
                       header.program);
}

// ---- what files say

std::string of_scene(const model::Scene& scene, const std::string& what) {
    Facts facts;
    Bounds bounds;
    std::size_t triangles = 0;
    for (const model::Object& object : scene.objects) {
        triangles += object.mesh.triangles.size();
        bounds.add(object.mesh.points);
    }
    facts.add("title", scene.title.empty() ? "(none)" : scene.title);
    facts.add("quantity",
              fmt::format("{}: radiosity in {}, irradiance in {}",
                          scene.quantity == model::Quantity::Photometric ? "photometric" : "radiometric",
                          model::radiosity_unit(scene.quantity), model::irradiance_unit(scene.quantity)));
    facts.add("channels", fmt::format("{}", fmt::join(scene.channels, ", ")));
    facts.add("accuracy", fmt::format("{} %", short_number(100.0 * scene.accuracy.target)));
    facts.add("frames", fmt::format("{} from {} s to {} s", scene.time.frames,
                                    short_number(scene.time.start_s), short_number(scene.time.end_s)));
    facts.add("materials", scene.materials.size());
    facts.add("motions", scene.motions.size());
    facts.add("dimmings", scene.dimmings.size());
    facts.add("grid meters", scene.meters.size());
    facts.add("triangles", triangles);
    facts.add(bounds);
    TextTable objects({"object", "triangles", "area [m2]", "motion", "emits"});
    for (const model::Object& object : scene.objects) {
        const auto& materials = object.mesh.materials;
        const bool emits = std::any_of(materials.begin(), materials.end(),
                                       [&](MaterialId id) { return scene.materials[id.value].emits(); });
        objects.row({object.name, std::to_string(object.mesh.triangles.size()),
                     short_number(model::area(object.mesh)),
                     object.motion ? scene.motions[object.motion->value].name : "-", emits ? "yes" : "no"});
    }
    return what + "\n" + facts.text() + objects.text();
}

std::string of_patches(const io::Hdf5Reader& file) {
    const model::PatchSet set = io::get_patches(file);
    Facts facts;
    Bounds bounds;
    double deviation = 0.0;
    for (const model::Patch& patch : set.patches) deviation = std::max(deviation, patch.deviation_max);
    bounds.add(set.small.points);
    facts.add("patches", set.patches.size());
    facts.add("small triangles", set.small.triangles.size());
    facts.add("deviation [m]", short_number(deviation));
    if (set.patches.empty()) facts.add(bounds);
    return facts.text();
}

std::string of_clusters(const io::Hdf5Reader& file) {
    const model::ClusterTree tree = io::get_clusters(file);
    Facts facts;
    facts.add("elements", tree.elements.size());
    facts.add("clusters", tree.clusters.size());
    facts.add("element size [m]", short_number(tree.element_size));
    return facts.text();
}

std::string of_coefficients(const io::Hdf5Reader& file) {
    const model::Coefficients coefficients = io::get_coefficients(file);
    Facts facts;
    facts.add("elements", coefficients.layout.elements());
    facts.add("unknowns", coefficients.layout.unknowns());
    facts.add("degree", static_cast<std::size_t>(coefficients.degree));
    facts.add("static blocks", coefficients.static_blocks.entries.size());
    if (!coefficients.hierarchy.empty()) facts.add("links", coefficients.hierarchy.links.entries.size());
    facts.add("moving pairs", coefficients.moving_pairs.size());
    facts.add("crossed pairs", coefficients.crossed_pairs.size());
    return facts.text();
}

std::string of_coefficients_so_far(const io::Hdf5Reader& file) {
    const model::CoefficientsSoFar so_far = io::get_coefficients_so_far(file);
    Facts facts;
    facts.add("elements", so_far.coefficients.layout.elements());
    facts.add("rows done", so_far.rows);
    facts.add("static blocks", so_far.coefficients.static_blocks.entries.size());
    return facts.text();
}

std::string of_solution(const io::Hdf5Reader& file) {
    const model::Solution solution = io::get_solution(file);
    Facts facts;
    double residual = 0.0, solver_error = 0.0, error = 0.0;
    bool converged = true;
    for (const model::FrameSolution& frame : solution.frames) {
        residual = std::max(residual, frame.residual);
        solver_error = std::max(solver_error, frame.solver_error);
        error = std::max(error, frame.error_estimate);
        converged = converged && frame.converged;
    }
    facts.add("frames", solution.frames.size());
    facts.add("channels", solution.channels);
    facts.add("unknowns", solution.layout.unknowns());
    facts.add("residual", fmt::format("{:.2g} at most{}", residual, converged ? "" : ", NOT CONVERGED"));
    facts.add("solver error", fmt::format("{:.2g} % at most", 100.0 * solver_error));
    facts.add("error estimate", fmt::format("{:.2g} % at most", 100.0 * error));
    return facts.text();
}

std::string of_hdf5(const fs::path& path) {
    const io::Hdf5Reader file(path);
    const io::FileHeader header{
        .format = file.text("format"), .version = file.integer("version"), .program = file.text("program")};
    using Describe = std::string (*)(const io::Hdf5Reader&);
    static constexpr std::array<std::pair<const char*, Describe>, 6> kinds{
        {{"kinelux-patches", of_patches},
         {"kinelux-clusters", of_clusters},
         {"kinelux-coefficients", of_coefficients},
         {"kinelux-coefficients-so-far", of_coefficients_so_far},
         {"kinelux-solution", of_solution},
         {"kinelux-solution-so-far", of_solution}}};
    for (const auto& [format, describe] : kinds)
        if (header.format == format)
            return fmt::format("{}: {}\n{}", path.string(), origin(header), describe(file));
    throw core::FileError(fmt::format("its format is '{}', which is none of a case", header.format));
}

std::string of_json(const fs::path& path) {
    const std::string text = all_of(path);
    if (const auto program = record_value(path, "program"); program && record_value(path, "steps"))
        return fmt::format("{}: record of a run of {}, version {}\n{}", path.string(), *program,
                           record_value(path, "version").value_or("unknown"), text);
    const io::FileHeader header = io::header_from_json(text);
    const std::string what = fmt::format("{}: {}", path.string(), origin(header));
    if (header.format == "kinelux-plan") return what + "\n" + plan_table(io::plan_from_json(text));
    if (header.format == "kinelux-scene")
        return fs::exists(path.parent_path() / "clean.vtm")
                   ? of_scene(io::CaseFolder(path.parent_path()).read_scene(),
                              what + ", with the meshes beside it")
                   : of_scene(io::scene_from_json(text).scene, what + ", its meshes are not there");
    throw core::FileError("no file of a case");
}

std::string of_frame(const fs::path& path) {
    const auto read = [&] {
        try {
            return io::read_frame(path, model::Quantity::Radiometric);
        } catch (const core::FileError&) {
            return io::read_frame(path, model::Quantity::Photometric);
        }
    };
    const io::ExportedFrame frame = read();
    Facts facts;
    Bounds bounds;
    bounds.add(frame.points);
    facts.add("points", frame.points.size());
    facts.add("triangles", frame.triangles.size());
    facts.add("irradiance",
              fmt::format("{}, {} channels", frame.irradiance.name, frame.irradiance.components));
    facts.add(bounds);
    return fmt::format("{}: an exported frame\n{}", path.string(), facts.text());
}

std::string of_case(const fs::path& path) {
    std::string text = fmt::format("{}: a case\n", path.string());
    for (const char* name :
         {"scene.json", "patches.h5", "clusters.h5", "plan.json", "coefficients.h5", "solution.h5"})
        if (const fs::path file = path / name; fs::exists(file))
            text += file.extension() == ".h5" ? of_hdf5(file) : of_json(file);
        else
            text += fmt::format("{}: not there yet\n", file.string());
    text += fs::exists(path / "view.pvd")
                ? fmt::format("{}: open it in ParaView\n", (path / "view.pvd").string())
                : fmt::format("{}: not there yet\n", (path / "view.pvd").string());
    return text;
}

std::string describe(const fs::path& path, bool allow_outside) {
    if (fs::is_directory(path)) {
        if (!fs::exists(path / "scene.json"))
            throw core::FileError(fmt::format("{}: not a case: there is no scene.json in it", path.string()));
        return of_case(path);
    }
    const std::string extension = path.extension().string();
    try {
        if (extension == ".h5") return of_hdf5(path);
        if (extension == ".json") return of_json(path);
    } catch (const core::FileError& error) {
        throw core::FileError(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (extension == ".vtu") return of_frame(path);
    const model::Scene scene = io::read_scene(path, {.allow_outside = allow_outside});
    return of_scene(scene,
                    fmt::format("{}: {}", path.string(),
                                extension == ".toml" ? "a scene" : "a mesh, as a scene with defaults"));
}

} // namespace

int info_command(const std::vector<std::string>& arguments) {
    OptionTable options("kinelux info",
                        "What a scene, a mesh, a file of a case or a whole case is and holds.");
    fs::path file, log_file;
    bool allow_outside = false, quiet = false, verbose = false;
    std::uint64_t threads = 0;
    options.add(
        {.member = &file, .flags = "FILE", .help = "scene, mesh, file of a case, or folder of a case"});
    options.add({.member = &allow_outside,
                 .flags = "--allow-outside",
                 .help = "meshes may lie outside the scene file's folder tree"});
    add_common_options(options, threads, quiet, verbose, log_file);
    if (options.parse(arguments) == OptionTable::Parsed::Answered) return 0;
    apply_common_options(threads, quiet, verbose, log_file);
    fmt::print("{}", describe(file, allow_outside));
    return 0;
}

} // namespace kinelux::cli
