// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/clean.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "clean/coplanar_panels.h"
#include "clean/intersections.h"
#include "clean/orient.h"
#include "clean/parts.h"
#include "clean/sides.h"
#include "clean/work_mesh.h"
#include "geometry/settle.h"

namespace kinelux::clean {

namespace {

// Counts the faces that cross each other and says where the first of them lies.
void report_intersections(const model::Mesh& mesh, CleanReport& report) {
    const SelfIntersections found = find_self_intersections(mesh.points, mesh.triangles);
    report.self_intersections = found.pairs;
    report.crossing_faces = found.faces.size();
    if (found.faces.empty()) return;
    const model::Triangle& t = mesh.triangles[found.faces.front()];
    const Vec3 x = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3.0;
    report.notes.push_back(
        fmt::format("{} face(s) touch or cross others, the first at ({:.6g}, {:.6g}, {:.6g}) m",
                    found.faces.size(), x.x, x.y, x.z));
}

// Says where an object is open: light passes there, unless other objects close the gap.
void report_gaps(const std::vector<Part>& parts, CleanReport& report) {
    const Part* widest = nullptr;
    for (const Part& part : parts) {
        report.gap_length += part.gap_length;
        if (widest == nullptr || part.longest_gap > widest->longest_gap) widest = &part;
    }
    if (widest == nullptr || widest->longest_gap == 0.0) return;
    const Vec3& x = widest->gap_place;
    report.notes.push_back(
        fmt::format("open along {:.6g} m of edges, the longest ({:.6g} m) at ({:.6g}, {:.6g}, {:.6g}) m",
                    report.gap_length, widest->longest_gap, x.x, x.y, x.z));
}

// Turns the faces of an object to agree within each connected part and returns the parts. Pinned faces stay as they are.
std::vector<Part> orient(WorkMesh& work, CleanReport& report) {
    std::vector<std::uint32_t> loose;
    std::vector<model::Triangle> triangles;
    for (std::size_t f = 0; f < work.mesh.triangles.size(); ++f) {
        if (work.pinned[f] != 0) continue;
        loose.push_back(static_cast<std::uint32_t>(f));
        triangles.push_back(work.mesh.triangles[f]);
    }
    OrientedSoup soup = orient_soup(work.mesh.points, triangles);
    report.non_manifold_edges = soup.non_manifold_edges;
    std::vector<Part> parts = find_parts(soup.points, soup.triangles, soup.origin);
    for (std::size_t i = 0; i < loose.size(); ++i) {
        const model::Triangle& before = triangles[i];
        const model::Triangle& after = soup.triangles[i];
        // Same direction: the corner after the first one is the same, wherever the first one went.
        std::size_t k = 0;
        while (soup.origin[after[k]] != before[0]) ++k;
        work.flipped[loose[i]] = soup.origin[after[(k + 1) % 3]] == before[1] ? 0 : 1;
        work.mesh.triangles[loose[i]] = after;
    }
    work.mesh.points = std::move(soup.points);
    for (Part& part : parts) {
        report.boundary_edges += part.boundary_edges;
        report.closed_parts += part.closed ? 1U : 0U;
        for (std::uint32_t& face : part.faces) face = loose[face];
    }
    report.parts = static_cast<std::uint32_t>(parts.size());
    report_gaps(parts, report);
    return parts;
}

// Points that no face is left of go; the others keep their order.
void drop_unused_points(model::Mesh& mesh) {
    constexpr std::uint32_t unused = 0xffffffffU;
    std::vector<std::uint32_t> number(mesh.points.size(), unused);
    for (const model::Triangle& t : mesh.triangles) {
        for (const std::uint32_t corner : t) number[corner] = 0;
    }
    std::vector<Vec3> points;
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (number[p] == unused) continue;
        number[p] = static_cast<std::uint32_t>(points.size());
        points.push_back(mesh.points[p]);
    }
    for (model::Triangle& t : mesh.triangles) {
        for (std::uint32_t& corner : t) corner = number[corner];
    }
    mesh.points = std::move(points);
}

void note_settling(geometry::Settled settled, CleanReport& report) {
    if (settled == geometry::Settled::AtRest)
        report.notes.emplace_back("its motion never changes its pose in the frames: it rests");
    if (settled == geometry::Settled::WithOthers)
        report.notes.emplace_back("keeps its place relative to a body before it: both are moved as one");
}

void finish(WorkMesh& work, CleanReport& report) {
    drop_unused_points(work.mesh);
    report.faces_out = work.mesh.triangles.size();
    report.points_out = work.mesh.points.size();
    report.area_out = model::area(work.mesh);
    for (std::size_t f = 0; f < work.mesh.triangles.size(); ++f) {
        report.two_sided_faces += work.mesh.two_sided[f];
        report.flipped_faces += work.flipped[f];
    }
}

} // namespace

CleanResult clean_scene(model::Scene scene, const CleanOptions& options) {
    CleanResult result;
    result.reports.resize(scene.objects.size());
    const std::vector<geometry::Settled> settled = geometry::settle_motions(scene);
    std::vector<WorkMesh> meshes;
    std::vector<std::vector<Part>> parts;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        CleanReport& report = result.reports[o];
        note_settling(settled[o], report);
        meshes.push_back(repair(scene.objects[o], options, report));
        report_intersections(meshes.back().mesh, report);
        parts.push_back(orient(meshes.back(), report));
    }
    decide_sides(scene, parts, meshes, result.reports);
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        finish(meshes[o], result.reports[o]);
        scene.objects[o].mesh = std::move(meshes[o].mesh);
    }
    lift_coplanar_panels(scene, result.reports);
    result.scene = std::move(scene);
    return result;
}

} // namespace kinelux::clean
