// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/orient.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>

namespace kinelux::clean {

namespace {

using EdgeSet = std::set<std::pair<std::size_t, std::size_t>>;

// CGAL copies its visitor, so it writes through pointers; it names an edge once for each face there.
struct Recorder : CGAL::Polygon_mesh_processing::Default_orientation_visitor {
    Recorder(OrientedSoup* target, EdgeSet* edges) : soup(target), non_manifold(edges) {}
    void non_manifold_edge(std::size_t a, std::size_t b, std::size_t) {
        non_manifold->insert(std::minmax(a, b));
    }
    void duplicated_vertex(std::size_t old_point, std::size_t new_point) {
        if (soup->origin.size() <= new_point) soup->origin.resize(new_point + 1, 0);
        soup->origin[new_point] = soup->origin[old_point];
    }

    OrientedSoup* soup;
    EdgeSet* non_manifold;
};

} // namespace

OrientedSoup orient_soup(const std::vector<Vec3>& points, const std::vector<model::Triangle>& triangles) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    std::vector<Point> soup_points;
    std::vector<std::vector<std::size_t>> soup_faces;
    OrientedSoup soup;
    soup_faces.reserve(triangles.size());
    for (const Vec3& x : points) {
        soup.origin.push_back(static_cast<std::uint32_t>(soup_points.size()));
        soup_points.emplace_back(x.x, x.y, x.z);
    }
    for (const model::Triangle& t : triangles) soup_faces.push_back({t[0], t[1], t[2]});
    EdgeSet non_manifold;
    CGAL::Polygon_mesh_processing::orient_polygon_soup(
        soup_points, soup_faces, CGAL::parameters::visitor(Recorder(&soup, &non_manifold)));
    soup.non_manifold_edges = non_manifold.size();
    for (const Point& p : soup_points) soup.points.emplace_back(p.x(), p.y(), p.z());
    for (const std::vector<std::size_t>& f : soup_faces) {
        soup.triangles.push_back({static_cast<std::uint32_t>(f[0]), static_cast<std::uint32_t>(f[1]),
                                  static_cast<std::uint32_t>(f[2])});
    }
    return soup;
}

} // namespace kinelux::clean
