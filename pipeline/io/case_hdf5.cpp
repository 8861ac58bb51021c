// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/case_hdf5.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "core/error.h"

namespace kinelux::io {

namespace {

using model::Patch;

/// field(item) for each item, as one list.
template <class Value, class Items, class Field>
std::vector<Value> column(const Items& items, Field field) {
    std::vector<Value> values;
    values.reserve(items.size());
    for (const auto& item : items) values.push_back(static_cast<Value>(field(item)));
    return values;
}

/// The list field(item) of each item, end to end, with the offsets where each starts.
template <class Items, class Field>
void put_lists(Hdf5Writer& file, const std::string& name, const Items& items, Field field) {
    std::vector<std::uint64_t> offsets{0};
    std::remove_cvref_t<decltype(field(items.front()))> joined;
    for (const auto& item : items) {
        const auto& list = field(item);
        joined.insert(joined.end(), list.begin(), list.end());
        offsets.push_back(joined.size());
    }
    file.dataset(name + "_offsets", offsets);
    file.dataset(name, joined);
}

/// What put_lists wrote, given the values that were end to end.
template <class Value>
std::vector<std::vector<Value>> split_lists(const Hdf5Reader& file, const std::string& name,
                                            std::size_t lists, const std::vector<Value>& joined) {
    const auto offsets = file.dataset<std::uint64_t>(name + "_offsets", {lists + 1});
    if (offsets.empty() || offsets.front() != 0 || offsets.back() != joined.size())
        throw core::FileError(fmt::format("dataset '{}_offsets' does not fit '{}'", name, name));
    std::vector<std::vector<Value>> result(lists);
    for (std::size_t i = 0; i < lists; ++i) {
        if (offsets[i] > offsets[i + 1] || offsets[i + 1] > joined.size())
            throw core::FileError(fmt::format("dataset '{}_offsets' decreases at {}", name, i));
        result[i].assign(joined.begin() + static_cast<std::ptrdiff_t>(offsets[i]),
                         joined.begin() + static_cast<std::ptrdiff_t>(offsets[i + 1]));
    }
    return result;
}

template <class Value>
std::vector<std::vector<Value>> get_lists(const Hdf5Reader& file, const std::string& name,
                                          std::size_t lists) {
    return split_lists(file, name, lists, file.dataset<Value>(name));
}

// ---- patches

/// A surface's plain numbers: origin, axis_u, axis_v, axis_w, then radius, minor_radius, half_angle, orientation.
constexpr std::size_t surface_numbers = 16;

void append_numbers(std::vector<double>& numbers, const model::Surface& surface) {
    for (const Vec3& v : {surface.origin, surface.axis_u, surface.axis_v, surface.axis_w})
        numbers.insert(numbers.end(), {v.x, v.y, v.z});
    numbers.insert(numbers.end(),
                   {surface.radius, surface.minor_radius, surface.half_angle_rad, surface.orientation});
}

void set_numbers(model::Surface& surface, const double* n) {
    surface.origin = {n[0], n[1], n[2]};
    surface.axis_u = {n[3], n[4], n[5]};
    surface.axis_v = {n[6], n[7], n[8]};
    surface.axis_w = {n[9], n[10], n[11]};
    surface.radius = n[12];
    surface.minor_radius = n[13];
    surface.half_angle_rad = n[14];
    surface.orientation = n[15];
}

/// The corners that matter: none on surfaces of other types.
std::vector<Vec3> own_corners(const model::Surface& surface) {
    if (surface.type != model::SurfaceType::Bilinear) return {};
    return {surface.corners.begin(), surface.corners.end()};
}

void set_corners(model::Surface& surface, const std::vector<Vec3>& corners, std::size_t patch) {
    if (corners.size() != own_corners(surface).size())
        throw core::FileError(fmt::format("patch {} has {} corners of a bilinear surface, not {}", patch,
                                          corners.size(), own_corners(surface).size()));
    std::copy(corners.begin(), corners.end(), surface.corners.begin());
}

void put_surfaces(Hdf5Writer& file, const std::vector<Patch>& patches) {
    std::vector<double> numbers;
    std::vector<std::uint32_t> shape;
    for (const Patch& patch : patches) {
        append_numbers(numbers, patch.surface);
        const model::BSpline& spline = patch.surface.bspline;
        shape.insert(shape.end(), {spline.degree_u, spline.degree_v, spline.count_u, spline.count_v});
    }
    const std::size_t count = patches.size();
    file.dataset("patches/surface_type",
                 column<std::uint8_t>(patches, [](const Patch& p) { return p.surface.type; }));
    file.dataset("patches/surface", std::span<const double>(numbers), {count, surface_numbers});
    put_lists(file, "bilinear/corners", patches, [](const Patch& p) { return own_corners(p.surface); });
    file.dataset("bsplines/shape", std::span<const std::uint32_t>(shape), {count, 4});
    put_lists(
        file, "bsplines/knots_u", patches, [](const Patch& p) -> auto& { return p.surface.bspline.knots_u; });
    put_lists(
        file, "bsplines/knots_v", patches, [](const Patch& p) -> auto& { return p.surface.bspline.knots_v; });
    put_lists(
        file, "bsplines/poles", patches, [](const Patch& p) -> auto& { return p.surface.bspline.poles; });
    put_lists(
        file, "bsplines/weights", patches, [](const Patch& p) -> auto& { return p.surface.bspline.weights; });
}

void get_surfaces(const Hdf5Reader& file, std::vector<Patch>& patches) {
    const std::size_t count = patches.size();
    const auto type = file.dataset<std::uint8_t>("patches/surface_type", {count});
    const auto numbers = file.dataset<double>("patches/surface", {count, surface_numbers});
    const auto shape = file.dataset<std::uint32_t>("bsplines/shape", {count, 4});
    auto knots_u = get_lists<double>(file, "bsplines/knots_u", count);
    auto knots_v = get_lists<double>(file, "bsplines/knots_v", count);
    auto poles = split_lists(file, "bsplines/poles", count, file.points_3d("bsplines/poles"));
    auto weights = get_lists<double>(file, "bsplines/weights", count);
    const auto corners = split_lists(file, "bilinear/corners", count, file.points_3d("bilinear/corners"));
    for (std::size_t p = 0; p < count; ++p) {
        model::Surface& surface = patches[p].surface;
        if (type[p] > static_cast<std::uint8_t>(model::SurfaceType::Bilinear))
            throw core::FileError(fmt::format("patch {} has the unknown surface type {}", p, type[p]));
        surface.type = static_cast<model::SurfaceType>(type[p]);
        set_numbers(surface, numbers.data() + surface_numbers * p);
        set_corners(surface, corners[p], p);
        surface.bspline = {.degree_u = shape[4 * p],
                           .degree_v = shape[4 * p + 1],
                           .count_u = shape[4 * p + 2],
                           .count_v = shape[4 * p + 3],
                           .knots_u = std::move(knots_u[p]),
                           .knots_v = std::move(knots_v[p]),
                           .poles = std::move(poles[p]),
                           .weights = std::move(weights[p])};
    }
}

/// The boundary loops of all patches: lists of lists of vertices.
void put_loops(Hdf5Writer& file, const std::vector<Patch>& patches) {
    std::vector<std::uint64_t> offsets{0};
    std::vector<std::vector<std::uint32_t>> loops;
    for (const Patch& patch : patches) {
        loops.insert(loops.end(), patch.loops.begin(), patch.loops.end());
        offsets.push_back(loops.size());
    }
    file.dataset("patches/loops_offsets", offsets);
    put_lists(
        file, "patches/loop_vertices", loops, [](const auto& loop) -> auto& { return loop; });
}

void get_loops(const Hdf5Reader& file, std::vector<Patch>& patches) {
    const std::size_t loop_count = file.shape("patches/loop_vertices_offsets").front() - 1;
    const auto loops = get_lists<std::uint32_t>(file, "patches/loop_vertices", loop_count);
    auto of_patch = split_lists(file, "patches/loops", patches.size(), loops);
    for (std::size_t p = 0; p < patches.size(); ++p) patches[p].loops = std::move(of_patch[p]);
}

model::SmallTriangles get_small(const Hdf5Reader& file) {
    model::SmallTriangles small;
    small.points = file.points_3d("small/points");
    small.triangles = file.triangles("small/triangles");
    const std::size_t count = small.triangles.size();
    for (const auto id : file.dataset<std::uint32_t>("small/object", {count})) small.objects.emplace_back(id);
    for (const auto id : file.dataset<std::uint32_t>("small/material", {count}))
        small.materials.emplace_back(id);
    return small;
}

// ---- clusters

constexpr std::uint32_t none =
    std::numeric_limits<std::uint32_t>::max(); ///< an element that is of no patch or cluster

template <class Tag>
std::optional<Id<Tag>> optional_id(std::uint32_t value) {
    return value == none ? std::nullopt : std::optional(Id<Tag>(value));
}

void put_elements(Hdf5Writer& file, const std::vector<model::Element>& elements) {
    using model::Element;
    file.dataset("elements/patch", column<std::uint32_t>(elements, [](const Element& e) {
                     return e.patch ? e.patch->value : none;
                 }));
    file.dataset("elements/cluster", column<std::uint32_t>(elements, [](const Element& e) {
                     return e.cluster ? e.cluster->value : none;
                 }));
    file.dataset("elements/object",
                 column<std::uint32_t>(elements, [](const Element& e) { return e.object.value; }));
    file.dataset("elements/material",
                 column<std::uint32_t>(elements, [](const Element& e) { return e.material.value; }));
    file.dataset("elements/first_triangle",
                 column<std::uint32_t>(elements, [](const Element& e) { return e.first_triangle; }));
    file.dataset("elements/triangle_count",
                 column<std::uint32_t>(elements, [](const Element& e) { return e.triangle_count; }));
}

std::vector<model::Element> get_elements(const Hdf5Reader& file) {
    const auto patch = file.dataset<std::uint32_t>("elements/patch");
    const Hdf5Shape shape{patch.size()};
    const auto cluster = file.dataset<std::uint32_t>("elements/cluster", shape);
    const auto object = file.dataset<std::uint32_t>("elements/object", shape);
    const auto material = file.dataset<std::uint32_t>("elements/material", shape);
    const auto first = file.dataset<std::uint32_t>("elements/first_triangle", shape);
    const auto count = file.dataset<std::uint32_t>("elements/triangle_count", shape);
    std::vector<model::Element> elements(patch.size());
    for (std::size_t e = 0; e < elements.size(); ++e)
        elements[e] = {.patch = optional_id<PatchTag>(patch[e]),
                       .cluster = optional_id<ClusterTag>(cluster[e]),
                       .object = ObjectId(object[e]),
                       .material = MaterialId(material[e]),
                       .first_triangle = first[e],
                       .triangle_count = count[e]};
    return elements;
}

// ---- coefficients

void put_pairs(Hdf5Writer& file, const std::string& name, const std::vector<model::ElementPair>& pairs) {
    std::vector<std::uint32_t> flat;
    flat.reserve(2 * pairs.size());
    for (const auto& [i, j] : pairs) flat.insert(flat.end(), {i, j});
    file.dataset(name, std::span<const std::uint32_t>(flat), {pairs.size(), 2});
}

std::vector<model::ElementPair> get_pairs(const Hdf5Reader& file, const std::string& name) {
    const std::size_t count = file.shape(name).front();
    const auto flat = file.dataset<std::uint32_t>(name, {count, 2});
    std::vector<model::ElementPair> pairs(count);
    for (std::size_t k = 0; k < count; ++k) pairs[k] = {flat[2 * k], flat[2 * k + 1]};
    return pairs;
}

void put_blocks(Hdf5Writer& file, const std::string& name, const model::BlockSet& blocks) {
    using model::BlockEntry;
    const auto& [entries, values] = blocks;
    file.dataset(name + "/i", column<std::uint32_t>(entries, [](const BlockEntry& b) { return b.i; }));
    file.dataset(name + "/j", column<std::uint32_t>(entries, [](const BlockEntry& b) { return b.j; }));
    file.dataset(name + "/offset",
                 column<std::uint64_t>(entries, [](const BlockEntry& b) { return b.offset; }));
    file.dataset(name + "/error", column<float>(entries, [](const BlockEntry& b) { return b.error; }));
    file.dataset(name + "/values", values);
}

model::BlockSet get_blocks(const Hdf5Reader& file, const std::string& name) {
    model::BlockSet blocks;
    const auto i = file.dataset<std::uint32_t>(name + "/i");
    const Hdf5Shape shape{i.size()};
    const auto j = file.dataset<std::uint32_t>(name + "/j", shape);
    const auto offset = file.dataset<std::uint64_t>(name + "/offset", shape);
    const auto error = file.dataset<float>(name + "/error", shape);
    blocks.entries.resize(i.size());
    for (std::size_t k = 0; k < i.size(); ++k) blocks.entries[k] = {i[k], j[k], offset[k], error[k]};
    blocks.values = file.dataset<float>(name + "/values");
    return blocks;
}

void put_hierarchy(Hdf5Writer& file, const model::Hierarchy& hierarchy) {
    using model::ElementGroup;
    const auto& groups = hierarchy.groups;
    file.attribute("links_error_estimate", hierarchy.error_estimate);
    file.dataset("hierarchy/layout_offsets", hierarchy.layout.offsets);
    file.dataset("hierarchy/first",
                 column<std::uint32_t>(groups, [](const ElementGroup& g) { return g.first; }));
    file.dataset("hierarchy/second",
                 column<std::uint32_t>(groups, [](const ElementGroup& g) { return g.second; }));
    file.dataset("hierarchy/offset",
                 column<std::uint64_t>(groups, [](const ElementGroup& g) { return g.offset; }));
    file.dataset("hierarchy/restrictions", hierarchy.restrictions);
    put_blocks(file, "links", hierarchy.links);
}

model::Hierarchy get_hierarchy(const Hdf5Reader& file) {
    model::Hierarchy hierarchy;
    hierarchy.error_estimate = file.number("links_error_estimate");
    hierarchy.layout.offsets = file.dataset<std::uint32_t>("hierarchy/layout_offsets");
    const auto first = file.dataset<std::uint32_t>("hierarchy/first");
    const Hdf5Shape shape{first.size()};
    const auto second = file.dataset<std::uint32_t>("hierarchy/second", shape);
    const auto offset = file.dataset<std::uint64_t>("hierarchy/offset", shape);
    for (std::size_t g = 0; g < first.size(); ++g)
        hierarchy.groups.push_back({first[g], second[g], offset[g]});
    hierarchy.restrictions = file.dataset<double>("hierarchy/restrictions");
    hierarchy.links = get_blocks(file, "links");
    return hierarchy;
}

// ---- solution

using model::FrameSolution;

/// One dataset [frames, ...] of a field that every frame has in the same size.
template <class Value>
void put_frames(Hdf5Writer& file, const std::string& name, const model::Solution& solution,
                std::vector<Value> FrameSolution::*field, const Hdf5Shape& frame_shape) {
    std::uint64_t size = 1;
    for (const std::uint64_t length : frame_shape) size *= length;
    Hdf5Shape shape{solution.frames.size()};
    shape.insert(shape.end(), frame_shape.begin(), frame_shape.end());
    std::vector<Value> joined;
    joined.reserve(size * solution.frames.size());
    for (const FrameSolution& frame : solution.frames) {
        if ((frame.*field).size() != size)
            throw std::logic_error(fmt::format("frame {}: {} values in '{}', expected {}", frame.frame,
                                               (frame.*field).size(), name, size));
        joined.insert(joined.end(), (frame.*field).begin(), (frame.*field).end());
    }
    file.dataset(name, std::span<const Value>(joined), shape);
}

template <class Value>
void get_frames(const Hdf5Reader& file, const std::string& name, model::Solution& solution,
                std::vector<Value> FrameSolution::*field, const Hdf5Shape& frame_shape) {
    Hdf5Shape shape{solution.frames.size()};
    shape.insert(shape.end(), frame_shape.begin(), frame_shape.end());
    const auto joined = file.dataset<Value>(name, shape);
    const std::size_t size = solution.frames.empty() ? 0 : joined.size() / solution.frames.size();
    for (std::size_t f = 0; f < solution.frames.size(); ++f) {
        const auto first = joined.begin() + static_cast<std::ptrdiff_t>(f * size);
        (solution.frames[f].*field).assign(first, first + static_cast<std::ptrdiff_t>(size));
    }
}

/// A dataset [frames] of one number a frame.
template <class Stored, class Field>
void put_number(Hdf5Writer& file, const std::string& name, const model::Solution& solution,
                Field FrameSolution::*field) {
    file.dataset(name,
                 column<Stored>(solution.frames, [&](const FrameSolution& frame) { return frame.*field; }));
}

template <class Stored, class Field>
void get_number(const Hdf5Reader& file, const std::string& name, model::Solution& solution,
                Field FrameSolution::*field) {
    const auto values = file.dataset<Stored>(name, {solution.frames.size()});
    for (std::size_t f = 0; f < values.size(); ++f) solution.frames[f].*field = static_cast<Field>(values[f]);
}

void put_rows(Hdf5Writer& file, const model::Coefficients& coefficients) {
    file.attribute("degree", std::int64_t{coefficients.degree});
    file.attribute("pairs_examined", coefficients.pairs_examined);
    file.attribute("rays_cast", coefficients.rays_cast);
    file.dataset("layout/offsets", coefficients.layout.offsets);
    put_blocks(file, "static_blocks", coefficients.static_blocks);
    put_pairs(file, "moving_pairs", coefficients.moving_pairs);
    put_pairs(file, "crossed_pairs", coefficients.crossed_pairs);
}

model::Coefficients get_rows(const Hdf5Reader& file) {
    model::Coefficients coefficients;
    coefficients.degree = static_cast<int>(file.integer("degree"));
    coefficients.pairs_examined = file.number("pairs_examined");
    coefficients.rays_cast = file.number("rays_cast");
    coefficients.layout.offsets = file.dataset<std::uint32_t>("layout/offsets");
    coefficients.static_blocks = get_blocks(file, "static_blocks");
    coefficients.moving_pairs = get_pairs(file, "moving_pairs");
    coefficients.crossed_pairs = get_pairs(file, "crossed_pairs");
    return coefficients;
}

} // namespace

void put_patches(Hdf5Writer& file, const model::PatchSet& set) {
    const auto& patches = set.patches;
    file.dataset("patches/object",
                 column<std::uint32_t>(patches, [](const Patch& p) { return p.object.value; }));
    file.dataset("patches/material",
                 column<std::uint32_t>(patches, [](const Patch& p) { return p.material.value; }));
    file.dataset("patches/deviation_max",
                 column<double>(patches, [](const Patch& p) { return p.deviation_max; }));
    file.dataset("patches/deviation_rms",
                 column<double>(patches, [](const Patch& p) { return p.deviation_rms; }));
    put_surfaces(file, patches);
    put_lists(
        file, "patches/points", patches, [](const Patch& p) -> auto& { return p.points; });
    put_lists(
        file, "patches/triangles", patches, [](const Patch& p) -> auto& { return p.triangles; });
    put_loops(file, patches);

    file.dataset("small/points", set.small.points);
    file.dataset("small/triangles", set.small.triangles);
    file.dataset("small/object",
                 column<std::uint32_t>(set.small.objects, [](ObjectId id) { return id.value; }));
    file.dataset("small/material",
                 column<std::uint32_t>(set.small.materials, [](MaterialId id) { return id.value; }));
}

model::PatchSet get_patches(const Hdf5Reader& file) {
    model::PatchSet set;
    const auto object = file.dataset<std::uint32_t>("patches/object");
    const std::size_t count = object.size();
    const auto material = file.dataset<std::uint32_t>("patches/material", {count});
    const auto deviation_max = file.dataset<double>("patches/deviation_max", {count});
    const auto deviation_rms = file.dataset<double>("patches/deviation_rms", {count});
    auto points = split_lists(file, "patches/points", count, file.points_2d("patches/points"));
    auto triangles = split_lists(file, "patches/triangles", count, file.triangles("patches/triangles"));
    set.patches.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        Patch& patch = set.patches[p];
        patch.object = ObjectId(object[p]);
        patch.material = MaterialId(material[p]);
        patch.deviation_max = deviation_max[p];
        patch.deviation_rms = deviation_rms[p];
        patch.points = std::move(points[p]);
        patch.triangles = std::move(triangles[p]);
    }
    get_surfaces(file, set.patches);
    get_loops(file, set.patches);
    set.small = get_small(file);
    return set;
}

void put_clusters(Hdf5Writer& file, const model::ClusterTree& tree) {
    using model::Cluster;
    file.attribute("element_size_m", tree.element_size);
    const auto& clusters = tree.clusters;
    file.dataset("clusters/object",
                 column<std::uint32_t>(clusters, [](const Cluster& c) { return c.object.value; }));
    file.dataset("clusters/material",
                 column<std::uint32_t>(clusters, [](const Cluster& c) { return c.material.value; }));
    file.dataset("clusters/normal_spread_deg",
                 column<double>(clusters, [](const Cluster& c) { return c.normal_spread_deg; }));
    put_lists(
        file, "clusters/triangles", clusters, [](const Cluster& c) -> auto& { return c.triangles; });
    put_elements(file, tree.elements);
    static_assert(sizeof(model::DomainTriangle) == 6 * sizeof(double));
    const double* corners =
        tree.domain_triangles.empty() ? nullptr : &tree.domain_triangles.front().front().x;
    file.dataset("domain_triangles", std::span(corners, 6 * tree.domain_triangles.size()),
                 {tree.domain_triangles.size(), 3, 2});
}

model::ClusterTree get_clusters(const Hdf5Reader& file) {
    model::ClusterTree tree;
    tree.element_size = file.number("element_size_m");
    const auto object = file.dataset<std::uint32_t>("clusters/object");
    const std::size_t count = object.size();
    const auto material = file.dataset<std::uint32_t>("clusters/material", {count});
    const auto spread = file.dataset<double>("clusters/normal_spread_deg", {count});
    auto triangles = get_lists<std::uint32_t>(file, "clusters/triangles", count);
    for (std::size_t c = 0; c < count; ++c)
        tree.clusters.push_back({.object = ObjectId(object[c]),
                                 .material = MaterialId(material[c]),
                                 .triangles = std::move(triangles[c]),
                                 .normal_spread_deg = spread[c]});
    tree.elements = get_elements(file);
    const std::size_t domain_count = file.shape("domain_triangles").front();
    const auto corners = file.dataset<double>("domain_triangles", {domain_count, 3, 2});
    tree.domain_triangles.resize(domain_count);
    for (std::size_t k = 0; k < 3 * domain_count; ++k)
        tree.domain_triangles[k / 3][k % 3] = {corners[2 * k], corners[2 * k + 1]};
    return tree;
}

void put_coefficients(Hdf5Writer& file, const model::Coefficients& coefficients) {
    put_rows(file, coefficients);
    put_hierarchy(file, coefficients.hierarchy);
}

model::Coefficients get_coefficients(const Hdf5Reader& file) {
    model::Coefficients coefficients = get_rows(file);
    coefficients.hierarchy = get_hierarchy(file);
    return coefficients;
}

void put_coefficients_so_far(Hdf5Writer& file, const model::CoefficientsSoFar& so_far) {
    file.attribute("rows", static_cast<std::int64_t>(so_far.rows));
    put_rows(file, so_far.coefficients);
}

model::CoefficientsSoFar get_coefficients_so_far(const Hdf5Reader& file) {
    model::CoefficientsSoFar so_far{.coefficients = get_rows(file), .rows = 0};
    const std::int64_t rows = file.integer("rows");
    if (rows < 0 || static_cast<std::size_t>(rows) > so_far.coefficients.layout.elements())
        throw core::FileError("more rows are done than there are elements");
    so_far.rows = static_cast<std::uint64_t>(rows);
    return so_far;
}

void put_solution(Hdf5Writer& file, const model::Solution& solution) {
    file.attribute("channels", std::int64_t{solution.channels});
    file.dataset("layout/offsets", solution.layout.offsets);
    put_number<std::uint32_t>(file, "frame", solution, &FrameSolution::frame);
    put_number<double>(file, "time_s", solution, &FrameSolution::time_s);
    put_number<double>(file, "sweeps", solution, &FrameSolution::sweeps);
    put_number<double>(file, "residual", solution, &FrameSolution::residual);
    put_number<double>(file, "unshot", solution, &FrameSolution::unshot);
    put_number<double>(file, "solver_error", solution, &FrameSolution::solver_error);
    put_number<double>(file, "error_estimate", solution, &FrameSolution::error_estimate);
    put_number<std::uint8_t>(file, "converged", solution, &FrameSolution::converged);
    put_number<std::uint32_t>(file, "blocks_recomputed", solution, &FrameSolution::blocks_recomputed);
    const Hdf5Shape field{solution.layout.unknowns(), solution.channels};
    put_frames(file, "radiosity", solution, &FrameSolution::radiosity, field);
    put_frames(file, "irradiance_direct", solution, &FrameSolution::irradiance_direct, field);
    put_frames(file, "irradiance_indirect", solution, &FrameSolution::irradiance_indirect, field);
    put_frames(file, "element_error", solution, &FrameSolution::element_error, {solution.layout.elements()});
}

model::Solution get_solution(const Hdf5Reader& file) {
    model::Solution solution;
    solution.channels = static_cast<std::uint32_t>(file.integer("channels"));
    solution.layout.offsets = file.dataset<std::uint32_t>("layout/offsets");
    solution.frames.resize(file.shape("frame").front());
    get_number<std::uint32_t>(file, "frame", solution, &FrameSolution::frame);
    get_number<double>(file, "time_s", solution, &FrameSolution::time_s);
    get_number<double>(file, "sweeps", solution, &FrameSolution::sweeps);
    get_number<double>(file, "residual", solution, &FrameSolution::residual);
    get_number<double>(file, "unshot", solution, &FrameSolution::unshot);
    get_number<double>(file, "solver_error", solution, &FrameSolution::solver_error);
    get_number<double>(file, "error_estimate", solution, &FrameSolution::error_estimate);
    get_number<std::uint8_t>(file, "converged", solution, &FrameSolution::converged);
    get_number<std::uint32_t>(file, "blocks_recomputed", solution, &FrameSolution::blocks_recomputed);
    const Hdf5Shape field{solution.layout.unknowns(), solution.channels};
    get_frames(file, "radiosity", solution, &FrameSolution::radiosity, field);
    get_frames(file, "irradiance_direct", solution, &FrameSolution::irradiance_direct, field);
    get_frames(file, "irradiance_indirect", solution, &FrameSolution::irradiance_indirect, field);
    get_frames(file, "element_error", solution, &FrameSolution::element_error, {solution.layout.elements()});
    return solution;
}

void put_solution_so_far(Hdf5Writer& file, const model::Solution& solution, const model::SolverState& state) {
    put_solution(file, solution);
    put_number<double>(file, "seconds", solution, &FrameSolution::seconds);
    file.attribute("frames_since_exact", std::int64_t{state.frames_since_exact});
    file.attribute("frames_kept", static_cast<std::int64_t>(state.reflected.size()));
    for (std::size_t f = 0; f < state.reflected.size(); ++f) {
        file.dataset(fmt::format("state/reflected_{}", f), state.reflected[f]);
        file.dataset(fmt::format("state/irradiance_{}", f), state.irradiance[f]);
    }
    file.dataset("state/mode_shape", state.mode.shape);
    file.dataset("state/mode_image", state.mode.image);
    file.dataset("state/mode_margin", state.mode.margin);
    file.dataset("state/mode_second", state.mode.second);
}

model::SolutionSoFar get_solution_so_far(const Hdf5Reader& file) {
    model::SolutionSoFar so_far{.solution = get_solution(file), .state = {}};
    get_number<double>(file, "seconds", so_far.solution, &FrameSolution::seconds);
    model::SolverState& state = so_far.state;
    state.frames_since_exact = static_cast<std::uint32_t>(file.integer("frames_since_exact"));
    const std::int64_t kept = file.integer("frames_kept");
    for (std::int64_t f = 0; f < kept; ++f) {
        state.reflected.push_back(file.dataset<double>(fmt::format("state/reflected_{}", f)));
        state.irradiance.push_back(file.dataset<double>(fmt::format("state/irradiance_{}", f)));
    }
    state.mode = {.shape = file.dataset<double>("state/mode_shape"),
                  .image = file.dataset<double>("state/mode_image"),
                  .margin = file.dataset<double>("state/mode_margin"),
                  .second = file.dataset<double>("state/mode_second")};
    return so_far;
}

} // namespace kinelux::io
