// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_quadrature.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/facet_loops.h"
#include "geometry/quadrature.h"
#include "geometry/quadrature_compression.h"
#include "geometry/surface.h"

namespace kinelux::geometry {

namespace {

// Corners of a parallelogram may be off by this share of its edges: rounding of cuts on tilted planes.
constexpr double parallelogram_tolerance = 1e-12;
// The area of a curved element is known when a finer rule changes it by less than this share.
constexpr double area_tolerance = 1e-12;
constexpr int most_halvings = 3; ///< of the cells of a curved element
constexpr std::array<std::size_t, rule_levels> cluster_nodes{16, 64, 256}; ///< at the most

struct ElementNode {
    SurfaceNode node;
    Vec2 parameter;
};

// A triangle or parallelogram of an element's domain, in space and in the parameters:
// s, t -> corner + s edge_1 + t edge_2.
struct Cell {
    enum class Form { Triangle, Parallelogram };
    Form form;
    std::array<Vec3, 3> space;     ///< corner and both edges; of the chords on curved patches
    std::array<Vec2, 3> parameter; ///< the same
    Vec3 normal;                   ///< of `space`
};

struct ReferenceNode {
    double s, t, weight; ///< weights sum to 1
};

std::vector<ReferenceNode> reference_rule(Cell::Form form, int degree) {
    std::vector<ReferenceNode> rule;
    if (form == Cell::Form::Triangle) {
        for (const TriangleNode& node : triangle_rule(degree))
            rule.push_back({node.barycentric[1], node.barycentric[2], node.weight});
        return rule;
    }
    const GaussRule& gauss = gauss_rule(degree / 2 + 1);
    for (std::size_t i = 0; i < gauss.nodes.size(); ++i)
        for (std::size_t j = 0; j < gauss.nodes.size(); ++j)
            rule.push_back({gauss.nodes[i], gauss.nodes[j], gauss.weights[i] * gauss.weights[j]});
    return rule;
}

std::vector<Cell> facet_cells(const ElementShape& shape) {
    std::vector<Cell> cells;
    for (const auto& [x, p, normal, area] : shape.facets)
        cells.push_back({Cell::Form::Triangle,
                         {x[0], x[1] - x[0], x[2] - x[0]},
                         {p[0], p[1] - p[0], p[2] - p[0]},
                         normal});
    return cells;
}

// The whole element as one cell, where its domain is a parallelogram.
std::optional<Cell> parallelogram(const ElementShape& shape) {
    std::vector<std::array<Vec3, 3>> domain;
    for (const Facet& facet : shape.facets) {
        std::array<Vec3, 3>& triangle = domain.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) triangle[c] = Vec3(facet.parameters[c], 0.0);
    }
    const auto loops = boundary_loops(domain);
    if (loops.size() != 1) return std::nullopt;
    std::vector<Vec3> points;
    for (const TriangleCorner& at : loops.front()) points.push_back(domain[at.triangle][at.corner]);
    const std::vector<std::size_t> turns = turning_points(points, parallelogram_tolerance);
    if (turns.size() != 4) return std::nullopt;

    std::array<Vec3, 4> x;
    std::array<Vec2, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
        const TriangleCorner& at = loops.front()[turns[k]];
        x[k] = shape.facets[at.triangle].corners[at.corner];
        p[k] = shape.facets[at.triangle].parameters[at.corner];
    }
    const double gap = glm::distance(p[1] - p[0], p[2] - p[3]);
    if (gap > parallelogram_tolerance * std::min(glm::distance(p[1], p[0]), glm::distance(p[3], p[0])))
        return std::nullopt;
    return Cell{Cell::Form::Parallelogram,
                {x[0], x[1] - x[0], x[3] - x[0]},
                {p[0], p[1] - p[0], p[3] - p[0]},
                shape.facets.front().normal};
}

std::vector<Cell> cells_of(const ElementShape& shape) {
    if (shape.planar || shape.surface)
        if (const auto whole = parallelogram(shape)) return {*whole};
    return facet_cells(shape);
}

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

ElementNode node_in(const ElementShape& shape, const Cell& cell, const ReferenceNode& at) {
    const auto& [x, x_1, x_2] = cell.space;
    const auto& [p, p_1, p_2] = cell.parameter;
    const double share = (cell.form == Cell::Form::Triangle ? 0.5 : 1.0) * at.weight;
    const Vec2 parameter = p + at.s * p_1 + at.t * p_2;
    if (!shape.surface) {
        const double area = glm::length(glm::cross(x_1, x_2));
        return {{x + at.s * x_1 + at.t * x_2, cell.normal, share * area}, parameter};
    }
    const SurfaceJet jet = evaluate(*shape.surface, parameter);
    return {
        {jet.position, jet.normal, share * jet.area_factor * std::abs(cross(p_1, p_2)), shape.chord_height},
        parameter};
}

std::vector<ElementNode> nodes_in(const ElementShape& shape, std::span<const Cell> cells, int degree) {
    std::vector<ElementNode> nodes;
    for (const Cell& cell : cells)
        for (const ReferenceNode& at : reference_rule(cell.form, degree))
            nodes.push_back(node_in(shape, cell, at));
    return nodes;
}

// Four parts of each cell; only their parameters matter on curved patches, yet the chords are divided as well.
std::vector<Cell> halved(std::span<const Cell> cells) {
    std::vector<Cell> parts;
    for (const Cell& cell : cells) {
        const auto part = [&](double s, double t, double scale) {
            Cell child = cell;
            child.space = {cell.space[0] + s * cell.space[1] + t * cell.space[2], scale * cell.space[1],
                           scale * cell.space[2]};
            child.parameter = {cell.parameter[0] + s * cell.parameter[1] + t * cell.parameter[2],
                               scale * cell.parameter[1], scale * cell.parameter[2]};
            parts.push_back(child);
        };
        part(0.0, 0.0, 0.5);
        part(0.5, 0.0, 0.5);
        part(0.0, 0.5, 0.5);
        if (cell.form == Cell::Form::Parallelogram)
            part(0.5, 0.5, 0.5);
        else
            part(0.5, 0.5, -0.5);
    }
    return parts;
}

double area_of(std::span<const ElementNode> nodes) {
    double sum = 0.0;
    for (const ElementNode& n : nodes) sum += n.node.weight;
    return sum;
}

// Cells of an element and the degree of a polynomial on each that the area factor cannot be told from.
struct AreaModel {
    std::vector<Cell> cells;
    int degree = 0;
};

// Per cell the integral of the area factor with second powers of the cell's coordinates. The area of the whole agrees
// between rules also where symmetry hides how coarse they are (whole turns of tori and spheres).
std::vector<double> moments_of_area(const ElementShape& shape, std::span<const Cell> cells, int degree) {
    std::vector<double> moments;
    for (const Cell& cell : cells) {
        double& sum = moments.emplace_back(0.0);
        for (const ReferenceNode& at : reference_rule(cell.form, degree))
            sum += (1.0 + at.s * at.s + at.t * at.t) * node_in(shape, cell, at).node.weight;
    }
    return moments;
}

bool agree(std::span<const double> a, std::span<const double> b) {
    double difference = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += std::abs(a[i] - b[i]);
        sum += a[i];
    }
    return difference <= area_tolerance * sum;
}

// Raises the degree, then halves the cells, until those moments no longer change. Where the surface is not smooth enough
// for that, the finest cells stand.
AreaModel resolved_area(const ElementShape& shape, std::vector<Cell> cells) {
    constexpr int highest = 12, step = 2;
    if (!shape.surface) return {std::move(cells), 0};
    for (int halving = 0;; ++halving, cells = halved(cells)) {
        std::vector<double> moments = moments_of_area(shape, cells, step);
        for (int degree = 2 * step; degree <= highest; degree += step) {
            const std::vector<double> coarser = std::exchange(moments, moments_of_area(shape, cells, degree));
            if (agree(moments, coarser)) return {std::move(cells), degree};
        }
        if (halving == most_halvings) return {std::move(cells), highest};
    }
}

std::vector<DomainPoint> domain_points(std::span<const ElementNode> nodes) {
    std::vector<DomainPoint> points;
    points.reserve(nodes.size());
    for (const ElementNode& n : nodes) points.push_back({n.parameter, n.node.weight});
    return points;
}

// The rule itself where it is short, else one as exact of fewer of its nodes.
std::vector<ElementNode> thinned(std::vector<ElementNode> nodes, int degree) {
    const auto kept = compress_quadrature(domain_points(nodes), degree);
    if (!kept) return nodes;
    std::vector<ElementNode> few;
    for (const auto& [index, weight] : *kept) {
        few.push_back(nodes[index]);
        few.back().node.weight = weight;
    }
    return few;
}

// `count` nodes of equal weight at equal steps of the area of the facets.
std::vector<ElementNode> systematic_nodes(const ElementShape& shape, std::span<const Cell> cells,
                                          std::size_t count) {
    std::vector<ElementNode> all = nodes_in(shape, cells, cells.size() >= count ? 1 : 2);
    if (all.size() <= count) return all;
    std::vector<ElementNode> chosen;
    const double step = area_of(all) / static_cast<double>(count);
    double sum = 0.0;
    for (const ElementNode& n : all)
        for (sum += n.node.weight;
             chosen.size() < count && sum > (static_cast<double>(chosen.size()) + 0.5) * step;) {
            chosen.push_back(n);
            chosen.back().node.weight = step;
        }
    return chosen;
}

NodeSet node_set(const Basis& basis, std::span<const ElementNode> nodes, int exactness) {
    NodeSet set;
    set.exactness = exactness;
    set.basis.resize(nodes.size() * basis.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        set.nodes.push_back(nodes[i].node);
        basis.evaluate(nodes[i].parameter, std::span(set.basis).subspan(i * basis.size(), basis.size()));
    }
    return set;
}

} // namespace

ElementQuadrature element_quadrature(const ElementShape& shape, int degree) {
    const AreaModel model = resolved_area(shape, cells_of(shape));
    const auto rule = [&](int exactness) { return nodes_in(shape, model.cells, exactness + model.degree); };
    const std::vector<ElementNode> domain = rule(2 * degree);
    ElementQuadrature result{area_of(domain), Vec3(0.0), Basis(domain_points(domain), degree), {}};
    for (const ElementNode& n : domain) result.normal_area += n.node.weight * n.node.normal;

    const std::array<int, rule_levels> exactness{std::max(1, 2 * degree), 2 * degree + 3, 2 * degree + 6};
    for (std::size_t q = 0; q < rule_levels; ++q)
        if (shape.planar || shape.surface)
            result.rules[q] = node_set(result.basis, thinned(rule(exactness[q]), exactness[q]), exactness[q]);
        else
            result.rules[q] =
                node_set(result.basis, systematic_nodes(shape, model.cells, cluster_nodes[q]), 0);
    return result;
}

} // namespace kinelux::geometry
