// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/plane_fit.h"

#include <vector>

#include <glm/geometric.hpp>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/linear_least_squares_fitting_3.h>

namespace kinelux::fit {

double Plane::distance(const Vec3& x) const { return glm::dot(x - point, normal); }

Plane nearest_plane(std::span<const std::array<Vec3, 3>> triangles) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    // Coordinates relative to one corner: far from the origin the covariances would lose their digits.
    const Vec3 base = triangles.front()[0];
    std::vector<Kernel::Triangle_3> shapes;
    for (const std::array<Vec3, 3>& t : triangles) {
        const auto corner = [&](std::size_t k) {
            const Vec3 x = t[k] - base;
            return Kernel::Point_3(x.x, x.y, x.z);
        };
        shapes.emplace_back(corner(0), corner(1), corner(2));
    }
    Kernel::Plane_3 plane;
    Kernel::Point_3 centroid;
    CGAL::linear_least_squares_fitting_3(shapes.begin(), shapes.end(), plane, centroid,
                                         CGAL::Dimension_tag<2>());
    const Kernel::Vector_3 normal = plane.orthogonal_vector();
    Plane result;
    result.point = base + Vec3{centroid.x(), centroid.y(), centroid.z()};
    result.normal = glm::normalize(Vec3{normal.x(), normal.y(), normal.z()});
    return result;
}

} // namespace kinelux::fit
