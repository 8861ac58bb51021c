// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/gather.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/surface.h"
#include "kernel/polygon_irradiance.h"

namespace kinelux::sample {

namespace {

constexpr double near_distance = 4.0;  ///< in radii of the element: nearer than that its nodes are too few
constexpr double far_distance = 10.0;  ///< in radii of the element: farther than that its coarse nodes do
constexpr double piece_distance = 2.0; ///< in longest edges of a piece: nearer than that it is cut
constexpr int max_cuts = 5;            ///< of a facet, into four each time
constexpr int curved_cuts = 2;         ///< of any facet of a curved element

// cos+ cos'+ / (pi r^2)
double exchange(const Receiver& receiver, const Vec3& x, const Vec3& normal) {
    const Vec3 way = x - receiver.position;
    const double r2 = glm::dot(way, way), here = glm::dot(way, receiver.normal),
                 there = -glm::dot(way, normal);
    return here > 0.0 && there > 0.0 ? here * there / (std::numbers::pi * r2 * r2) : 0.0;
}

// Corners of pieces of curved elements lie on the true surface.
std::array<geometry::Facet, 4> quarters(const geometry::ElementShape& element, const geometry::Facet& facet) {
    std::array<Vec3, 3> x;
    std::array<Vec2, 3> uv;
    for (std::size_t e = 0; e < 3; ++e) {
        uv[e] = 0.5 * (facet.parameters[e] + facet.parameters[(e + 1) % 3]);
        x[e] = element.surface ? geometry::position(*element.surface, uv[e])
                               : 0.5 * (facet.corners[e] + facet.corners[(e + 1) % 3]);
    }
    const auto piece = [&](const std::array<Vec3, 3>& corners, const std::array<Vec2, 3>& parameters) {
        return geometry::Facet{corners, parameters, facet.normal, 0.25 * facet.area};
    };
    const auto& p = facet.corners;
    const auto& q = facet.parameters;
    return {piece({p[0], x[0], x[2]}, {q[0], uv[0], uv[2]}), piece({x[0], p[1], x[1]}, {uv[0], q[1], uv[1]}),
            piece({x[2], x[1], p[2]}, {uv[2], uv[1], q[2]}), piece(x, uv)};
}

double longest_edge(const geometry::Facet& facet) {
    return std::max({glm::distance(facet.corners[0], facet.corners[1]),
                     glm::distance(facet.corners[1], facet.corners[2]),
                     glm::distance(facet.corners[2], facet.corners[0])});
}

} // namespace

/// Segments to the elements and what arrives along each where it is free.
struct Gather::Rays {
    std::vector<visibility::Segment> segments;
    std::vector<double> arriving; ///< segments x (channels + 1)
};

Gather::Gather(std::span<const geometry::ElementShape> elements, const model::Scene& scene,
               const model::UnknownLayout& layout, const model::FrameSolution& frame,
               const visibility::Occluders& occluders)
    : elements_(elements),
      scene_(scene),
      layout_(layout),
      frame_(frame),
      occluders_(occluders),
      exitances_(model::exitances_at(scene, frame.time_s)),
      channels_(scene.channels.size()) {}

// Radiosity less exitance at a point of an element, and the estimated error of it.
void Gather::reflected(std::size_t element, std::span<const double> basis, std::span<double> values) const {
    const MaterialId id = elements_[element].material;
    const model::Material& material = scene_.materials[id.value];
    const std::size_t offset = layout_.offsets[element];
    for (std::size_t c = 0; c < channels_; ++c) {
        values[c] = -exitances_[id.value][c];
        for (std::size_t k = 0; k < basis.size(); ++k)
            values[c] += basis[k] * frame_.radiosity[(offset + k) * channels_ + c];
    }
    const double rho = *std::max_element(material.reflectance.begin(), material.reflectance.end());
    values[channels_] = element < frame_.element_error.size()
                            ? rho * static_cast<double>(frame_.element_error[element])
                            : 0.0;
}

void Gather::add_nodes(std::size_t element, const geometry::NodeSet& set, const Receiver& receiver,
                       Rays& rays) const {
    const std::size_t functions = elements_[element].basis.size();
    std::vector<double> values(channels_ + 1);
    for (std::size_t n = 0; n < set.nodes.size(); ++n) {
        const geometry::SurfaceNode& node = set.nodes[n];
        const double weight = node.weight * exchange(receiver, node.position, node.normal);
        if (!(weight > 0.0)) continue;
        reflected(element, std::span(set.basis).subspan(n * functions, functions), values);
        rays.segments.push_back({receiver.position, node.sight_point()});
        for (const double value : values) rays.arriving.push_back(weight * value);
    }
}

void Gather::add_piece(std::size_t element, const geometry::Facet& piece, const Receiver& receiver, int cuts,
                       Rays& rays) const {
    const Vec3 middle = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0;
    const bool bent = elements_[element].surface && cuts < curved_cuts;
    if (bent || (cuts < max_cuts &&
                 glm::distance(middle, receiver.position) < piece_distance * longest_edge(piece))) {
        for (const geometry::Facet& quarter : quarters(elements_[element], piece))
            add_piece(element, quarter, receiver, cuts + 1, rays);
        return;
    }
    const double factor = kernel::point_to_polygon(receiver.position, receiver.normal, piece.corners);
    if (!(factor > 0.0)) return;
    std::vector<double> basis(elements_[element].basis.size()), values(channels_ + 1);
    constexpr double third = 1.0 / 3.0;
    Vec2 parameter;
    const geometry::SurfaceNode node =
        geometry::node_at(elements_[element], piece, {third, third, third}, parameter);
    elements_[element].basis.evaluate(parameter, basis);
    reflected(element, basis, values);
    rays.segments.push_back({receiver.position, node.sight_point()});
    for (const double value : values) rays.arriving.push_back(factor * value);
}

std::vector<double> Gather::indirect(const Receiver& receiver) const {
    Rays rays;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const geometry::ElementShape& shape = elements_[e];
        const Vec3 way = shape.centre - receiver.position;
        if (glm::dot(way, receiver.normal) < -shape.radius) continue; // below the horizon
        if (glm::length(way) > near_distance * shape.radius) {
            const bool far = glm::length(way) > far_distance * shape.radius;
            add_nodes(e, shape.rules[far ? 0 : 1], receiver, rays);
            continue;
        }
        for (const geometry::Facet& facet : shape.facets) add_piece(e, facet, receiver, 0, rays);
    }
    std::vector<std::uint8_t> blocked(rays.segments.size());
    occluders_.occluded(rays.segments, blocked);
    std::vector<double> sum(channels_ + 1, 0.0);
    for (std::size_t i = 0; i < blocked.size(); ++i)
        for (std::size_t c = 0; c <= channels_ && blocked[i] == 0; ++c)
            sum[c] += rays.arriving[i * (channels_ + 1) + c];
    for (double& value : sum) value = std::max(0.0, value);
    return sum;
}

} // namespace kinelux::sample
