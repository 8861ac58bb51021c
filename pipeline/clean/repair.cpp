// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "clean/caps.h"
#include "clean/merge_points.h"
#include "clean/stitch.h"
#include "clean/work_mesh.h"
#include "core/error.h"

namespace kinelux::clean {

namespace {

// A face lower than this share of the object's size has no area.
constexpr double flat_share = 1e-9;
// Merging points may change an object's area by this share; else a tenth of the tolerance is tried.
constexpr double area_share = 1e-6;
constexpr int merge_attempts = 4;

void check_coordinates(const model::Object& object) {
    const model::Mesh& mesh = object.mesh;
    if (mesh.triangles.empty())
        throw core::GeometryError(fmt::format("object '{}' has no faces", object.name));
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const std::size_t source = f < mesh.source_faces.size() ? mesh.source_faces[f] : f;
        for (const std::uint32_t corner : mesh.triangles[f]) {
            if (corner >= mesh.points.size()) {
                throw core::GeometryError(fmt::format("object '{}', face {}: names point {} of {}",
                                                      object.name, source, corner, mesh.points.size()));
            }
            const Vec3& x = mesh.points[corner];
            if (std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z)) continue;
            throw core::GeometryError(fmt::format("object '{}', face {}: a coordinate is not a finite number",
                                                  object.name, source));
        }
    }
}

double area(const std::vector<Vec3>& points, const model::Triangle& t) {
    return 0.5 * glm::length(glm::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]));
}

double size_of(const model::Mesh& mesh) {
    Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    for (const model::Triangle& t : mesh.triangles) {
        for (const std::uint32_t corner : t) {
            low = glm::min(low, mesh.points[corner]);
            high = glm::max(high, mesh.points[corner]);
        }
    }
    return glm::length(high - low);
}

double area_after(const model::Mesh& mesh, const MergedPoints& merged) {
    double sum = 0.0;
    for (const model::Triangle& t : mesh.triangles) {
        sum += area(merged.points, {merged.number[t[0]], merged.number[t[1]], merged.number[t[2]]});
    }
    return sum;
}

std::vector<std::uint8_t> used_points(const model::Mesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    for (const model::Triangle& t : mesh.triangles) {
        for (const std::uint32_t corner : t) used[corner] = 1;
    }
    return used;
}

// Points that no face uses do not count.
MergedPoints merge_used(const model::Mesh& mesh, double tolerance) {
    const std::vector<std::uint8_t> used = used_points(mesh);
    std::vector<Vec3> points;
    std::vector<std::uint32_t> place(mesh.points.size(), 0);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        if (used[p] == 0) continue;
        place[p] = static_cast<std::uint32_t>(points.size());
        points.push_back(mesh.points[p]);
    }
    MergedPoints merged = merge_points(points, tolerance);
    std::vector<std::uint32_t> number(mesh.points.size(), 0);
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (used[p] != 0) number[p] = merged.number[place[p]];
    }
    merged.number = std::move(number);
    return merged;
}

// Merges with the largest tolerance up to the one asked for that leaves the area as it is.
MergedPoints merge_gently(const model::Mesh& mesh, double size, const CleanOptions& options,
                          CleanReport& report) {
    double share = options.merge_tolerance;
    for (int attempt = 0; attempt < merge_attempts; ++attempt, share *= 0.1) {
        MergedPoints merged = merge_used(mesh, share * size);
        if (std::abs(area_after(mesh, merged) - report.area_in) > area_share * report.area_in) continue;
        if (attempt > 0) {
            report.notes.push_back(fmt::format(
                "points were merged within {:.0e} of the size only: more would have changed the area",
                share));
        }
        return merged;
    }
    report.notes.push_back("only equal points were merged: more would have changed the area");
    return merge_used(mesh, 0.0);
}

// Closes cracks and T-junctions, unless that would change the area by more than strips as wide as the tolerance can.
Stitched stitch_gently(const std::vector<Vec3>& points, const std::vector<model::Triangle>& triangles,
                       double size, const CleanOptions& options, CleanReport& report) {
    constexpr double strips = 10.0;
    const auto sum = [&](const std::vector<model::Triangle>& all) {
        double result = 0.0;
        for (const model::Triangle& t : all) result += area(points, t);
        return result;
    };
    Stitched stitched = stitch_borders(points, triangles, options.stitch_tolerance * size);
    const double before = sum(triangles);
    if (std::abs(sum(stitched.triangles) - before) > strips * options.stitch_tolerance * before) {
        report.notes.push_back("cracks were not stitched: that would have changed the area");
        return stitch_borders(points, triangles, 0.0);
    }
    report.degenerate_faces += stitched.dropped;
    report.joined_points = stitched.joined_points;
    report.divided_edges = stitched.divided_edges;
    report.stitched_within = stitched.largest_move;
    if (stitched.joined_points + stitched.divided_edges > 0)
        report.notes.push_back(
            fmt::format("cracks and T-junctions closed: {} border points joined, border edges divided {} "
                        "times; nothing moved more than {:.3g} m",
                        stitched.joined_points, stitched.divided_edges, stitched.largest_move));
    return stitched;
}

// Corners in ascending order, and whether it took an odd number of exchanges to sort them.
std::pair<std::array<std::uint32_t, 3>, bool> sorted_corners(const model::Triangle& t) {
    std::array<std::uint32_t, 3> corners{t[0], t[1], t[2]};
    bool odd = false;
    const auto order = [&](std::size_t i, std::size_t j) {
        if (corners[i] <= corners[j]) return;
        std::swap(corners[i], corners[j]);
        odd = !odd;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return {corners, odd};
}

// What is left of the faces so far, by their corners: at most one face for each direction.
class SeenFaces {
public:
    enum class Verdict { Fresh, Duplicate, MadeTwoSided, OtherSide };

    Verdict take(const model::Triangle& t, MaterialId material, WorkMesh& work) {
        const auto [corners, odd] = sorted_corners(t);
        std::array<std::int64_t, 2>& sides =
            seen_.try_emplace(corners, std::array<std::int64_t, 2>{-1, -1}).first->second;
        const std::size_t side = odd ? 1 : 0;
        if (sides[side] >= 0) return Verdict::Duplicate;
        const std::int64_t opposite = sides[1 - side];
        sides[side] = static_cast<std::int64_t>(work.mesh.triangles.size());
        if (opposite < 0) return Verdict::Fresh;
        const auto partner = static_cast<std::size_t>(opposite);
        if (work.mesh.materials[partner] == material) {
            work.mesh.two_sided[partner] = 1;
            sides[side] = opposite;
            return Verdict::MadeTwoSided;
        }
        work.pinned[partner] = 1;
        return Verdict::OtherSide;
    }

private:
    std::map<std::array<std::uint32_t, 3>, std::array<std::int64_t, 2>> seen_;
};

void add_face(const model::Mesh& in, std::size_t f, const model::Triangle& t, bool pinned, WorkMesh& work) {
    work.mesh.triangles.push_back(t);
    work.mesh.materials.push_back(in.materials[f]);
    work.mesh.two_sided.push_back(0);
    work.mesh.source_faces.push_back(f < in.source_faces.size() ? in.source_faces[f]
                                                                : static_cast<std::uint32_t>(f));
    work.pinned.push_back(pinned ? 1 : 0);
    work.flipped.push_back(0);
}

} // namespace

WorkMesh repair(const model::Object& object, const CleanOptions& options, CleanReport& report) {
    check_coordinates(object);
    const model::Mesh& in = object.mesh;
    report.object = object.name;
    report.faces_in = in.triangles.size();
    report.points_in = in.points.size();
    for (const model::Triangle& t : in.triangles) report.area_in += area(in.points, t);
    const double size = size_of(in);

    const MergedPoints merged = merge_gently(in, size, options, report);
    const std::vector<std::uint8_t> used = used_points(in);
    report.merged_points =
        static_cast<std::size_t>(std::count(used.begin(), used.end(), 1)) - merged.points.size();
    WorkMesh work;
    work.mesh.points = merged.points;
    SeenFaces seen;
    std::uint64_t two_materials = 0;
    std::vector<model::Triangle> triangles;
    for (const model::Triangle& t : in.triangles) {
        triangles.push_back({merged.number[t[0]], merged.number[t[1]], merged.number[t[2]]});
    }
    const DividedCaps divided = divide_at_caps(merged.points, triangles, flat_share * size);
    report.degenerate_faces = divided.dropped;
    const Stitched stitched = stitch_gently(merged.points, divided.triangles, size, options, report);
    for (std::size_t i = 0; i < stitched.triangles.size(); ++i) {
        const model::Triangle& t = stitched.triangles[i];
        const std::size_t f = divided.source[stitched.source[i]];
        switch (seen.take(t, in.materials[f], work)) {
        case SeenFaces::Verdict::Fresh: add_face(in, f, t, false, work); break;
        case SeenFaces::Verdict::OtherSide:
            add_face(in, f, t, true, work);
            ++two_materials;
            break;
        case SeenFaces::Verdict::Duplicate: ++report.duplicate_faces; break;
        case SeenFaces::Verdict::MadeTwoSided: ++report.opposite_faces; break;
        }
    }
    if (two_materials > 0) {
        report.notes.push_back(fmt::format(
            "{} faces lie back to back with a face of another material: both are kept, each shows its front",
            two_materials));
    }
    if (work.mesh.triangles.empty()) {
        throw core::GeometryError(
            fmt::format("object '{}' ({} faces) has no face with area", object.name, report.faces_in));
    }
    return work;
}

} // namespace kinelux::clean
