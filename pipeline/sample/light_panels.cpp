// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/light_panels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "geometry/tessellation.h"
#include "kernel/polygon_irradiance.h"

namespace kinelux::sample {

namespace {

constexpr double in_plane = 1e-7;     ///< of the size of what is compared: closer to a plane counts as in it
constexpr double same_normal = 1e-12; ///< 1 - cosine, that of 1.4e-6 rad
constexpr double far_distance =
    20.0; ///< in panel diameters; the one-point rule is wrong by less than 1e-3 beyond
constexpr double straight = 1e-12; ///< sine below which two edges of an outline are one

using Corner = std::tuple<double, double, double>;

Corner key(const Vec3& x) { return {x.x, x.y, x.z}; }

// Edges that no other facet runs along backwards.
std::vector<LightPanel::Edge> boundary(const std::vector<std::array<Vec3, 3>>& facets) {
    std::map<std::pair<Corner, Corner>, int> count;
    for (const auto& facet : facets)
        for (std::size_t c = 0; c < 3; ++c) ++count[{key(facet[c]), key(facet[(c + 1) % 3])}];
    std::vector<LightPanel::Edge> edges;
    for (const auto& facet : facets)
        for (std::size_t c = 0; c < 3; ++c)
            if (!count.contains({key(facet[(c + 1) % 3]), key(facet[c])}))
                edges.push_back({facet[c], facet[(c + 1) % 3]});
    return edges;
}

// Joins edges that continue each other in a straight line.
std::vector<LightPanel::Edge> straightened(std::vector<LightPanel::Edge> edges) {
    std::map<Corner, std::vector<std::size_t>> starting, ending;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        starting[key(edges[e].from)].push_back(e);
        ending[key(edges[e].to)].push_back(e);
    }
    std::vector<bool> gone(edges.size(), false);
    for (const auto& [corner, out] : starting) {
        const auto in = ending.find(corner);
        if (in == ending.end() || in->second.size() != 1 || out.size() != 1 || in->second[0] == out[0])
            continue;
        LightPanel::Edge& before = edges[in->second[0]];
        const LightPanel::Edge& after = edges[out[0]];
        const Vec3 a = before.to - before.from, b = after.to - after.from;
        if (glm::dot(a, b) <= 0.0 ||
            glm::length(glm::cross(a, b)) > straight * glm::length(a) * glm::length(b))
            continue;
        before.to = after.to;
        gone[out[0]] = true;
        ending[key(before.to)] = {in->second[0]};
    }
    std::vector<LightPanel::Edge> kept;
    for (std::size_t e = 0; e < edges.size(); ++e)
        if (!gone[e]) kept.push_back(edges[e]);
    return kept;
}

void finish(LightPanel& panel) {
    Vec3 moment(0.0);
    double sum = 0.0;
    for (const auto& facet : panel.facets) {
        const double area = 0.5 * glm::length(glm::cross(facet[1] - facet[0], facet[2] - facet[0]));
        sum += area;
        moment += area / 3.0 * (facet[0] + facet[1] + facet[2]);
        panel.cumulative_area.push_back(sum);
    }
    panel.centre = moment / sum;
    for (const auto& facet : panel.facets)
        for (const Vec3& corner : facet)
            panel.radius = std::max(panel.radius, glm::distance(corner, panel.centre));
    panel.outline = straightened(boundary(panel.facets));
}

bool belongs(const geometry::Facet& facet, const LightPanel& panel, double size) {
    return glm::dot(facet.normal, panel.normal) > 1.0 - same_normal &&
           std::abs(glm::dot(facet.corners[0] - panel.facets.front()[0], panel.normal)) <= in_plane * size;
}

// The facets that stand for a curved element where it casts shadows, so that its light starts on them; its own else.
std::vector<geometry::Facet> occluding_facets(const geometry::ElementShape& element) {
    if (!element.surface) return element.facets;
    std::vector<model::DomainTriangle> domain;
    for (const geometry::Facet& facet : element.facets) domain.push_back(facet.parameters);
    if (element.surface->orientation < 0.0)
        for (model::DomainTriangle& t : domain) std::swap(t[1], t[2]);
    std::vector<geometry::Facet> facets;
    for (const model::DomainTriangle& t : geometry::tessellated(*element.surface, domain))
        facets.push_back(geometry::facet_of(*element.surface, t));
    return facets;
}

// Lambert's sum over the outline; right where all of the panel is above the receiver's horizon.
double outline_sum(const Vec3& x, const Vec3& normal, const LightPanel& panel) {
    double sum = 0.0;
    for (const LightPanel::Edge& edge : panel.outline) {
        const Vec3 a = edge.from - x, b = edge.to - x;
        const Vec3 cross = glm::cross(b, a);
        const double sine = glm::length(cross);
        if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, cross) / sine;
    }
    return std::clamp(sum / (2.0 * std::numbers::pi), 0.0, 1.0);
}

} // namespace

Vec3 LightPanel::point(const Vec2& square) const {
    const double target = square.x * area();
    const auto found = std::upper_bound(cumulative_area.begin(), cumulative_area.end() - 1, target);
    const auto f = static_cast<std::size_t>(found - cumulative_area.begin());
    const double before = f > 0 ? cumulative_area[f - 1] : 0.0;
    const double root = std::sqrt(std::clamp((target - before) / (cumulative_area[f] - before), 0.0, 1.0));
    const std::array<Vec3, 3>& c = facets[f];
    return c[0] + root * (1.0 - square.y) * (c[1] - c[0]) + root * square.y * (c[2] - c[0]);
}

std::vector<LightPanel> light_panels(std::span<const geometry::ElementShape* const> elements) {
    std::vector<LightPanel> panels;
    for (const geometry::ElementShape* element : elements) {
        // The facets of a planar element are in few panels; those of a bent one are compared with its own panels only.
        const std::size_t first = element->planar ? 0 : panels.size();
        for (const geometry::Facet& facet : occluding_facets(*element)) {
            if (!(facet.area > 0.0)) continue;
            const auto mine =
                std::find_if(panels.begin() + static_cast<std::ptrdiff_t>(first), panels.end(),
                             [&](const LightPanel& panel) { return belongs(facet, panel, element->radius); });
            if (mine != panels.end()) {
                mine->facets.push_back(facet.corners);
                continue;
            }
            panels.emplace_back().facets.push_back(facet.corners);
            panels.back().normal = facet.normal;
        }
    }
    for (LightPanel& panel : panels) finish(panel);
    return panels;
}

double point_to_panel(const Vec3& x, const Vec3& normal, const LightPanel& panel) {
    const Vec3 way = panel.centre - x;
    const double height = -glm::dot(panel.normal, way); // of x over the panel
    const double altitude = glm::dot(normal, way);      // of the panel's centre over the receiver
    if (height <= in_plane * panel.radius || altitude <= -panel.radius) return 0.0;
    const double r2 = glm::dot(way, way);
    const double diameter = 2.0 * panel.radius;
    if (r2 > far_distance * far_distance * diameter * diameter && altitude > panel.radius)
        return panel.area() * height * altitude / (std::numbers::pi * r2 * r2);
    double lowest = altitude, highest = altitude;
    for (const LightPanel::Edge& edge : panel.outline) {
        const double h = glm::dot(normal, edge.from - x);
        lowest = std::min(lowest, h);
        highest = std::max(highest, h);
    }
    if (highest <= in_plane * panel.radius) return 0.0;
    if (lowest >= -in_plane * panel.radius) return outline_sum(x, normal, panel);
    double sum = 0.0; // the horizon cuts the panel
    for (const std::array<Vec3, 3>& facet : panel.facets) sum += kernel::point_to_polygon(x, normal, facet);
    return sum;
}

} // namespace kinelux::sample
