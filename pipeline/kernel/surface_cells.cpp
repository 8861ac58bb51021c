// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/surface_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/quadrature.h"
#include "kernel/far_pair.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::SurfaceNode;

constexpr std::array<int, 3> rule_degrees{2, 5, 8};
constexpr int most_divisions = 30;
constexpr std::size_t most_cells = 20000; ///< kept from point to point
// Errors of the cells of one point have different signs and add up to about as many times one.
constexpr double cells_at_once = 2.0;
// A rule converges towards a point as far away as this many radii of its cell.
constexpr double nearest = 1.5;

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

} // namespace

SurfaceCells::SurfaceCells(const ElementShape& element, double accuracy, Points points)
    : element_(element),
      cell_accuracy_(accuracy / cells_at_once),
      function_scale_((1.0 + element.basis.degree()) / std::sqrt(element.area)),
      points_(points),
      phi_(element.basis.size()) {
    for (const Facet& facet : element.facets) add_cell(facet, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, 0);
    roots_ = static_cast<std::uint32_t>(cells_.size());
}

std::uint32_t SurfaceCells::add_cell(const Facet& facet, const std::array<Vec2, 3>& corners, int depth) {
    Cell cell{.facet = &facet, .corners = corners, .depth = depth};
    const geometry::FacetSurface surface(element_, facet);
    const Vec2 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    // The rule of degree 3 on corners, middles of edges and centre.
    constexpr double corner_share = 1.0 / 20.0, edge_share = 2.0 / 15.0, centre_share = 9.0 / 20.0;
    const double jacobian = 0.5 * std::abs(cross(corners[1] - corners[0], corners[2] - corners[0]));
    const auto sample = [&](std::size_t i, const Vec2& at, double share) {
        geometry::FacetSurface::Point point = surface.at(at);
        double density = glm::length(point.area_normal);
        cell.area += share * jacobian * density;
        cell.samples[i].position = point.position;
        // At a pole there is no normal: that of a point beside it stands for it.
        constexpr double beside = 1e-4, none = 1e-9;
        if (!(density > none * element_.area)) {
            point = surface.at(glm::mix(at, middle, beside));
            density = glm::length(point.area_normal);
        }
        cell.samples[i].normal = density > 0.0 ? point.area_normal / density : Vec3(0.0);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        sample(c, corners[c], corner_share);
        sample(3 + c, 0.5 * (corners[c] + corners[(c + 1) % 3]), edge_share);
    }
    sample(6, middle, centre_share);
    cell.centre = cell.samples[6].position;
    constexpr double between = 1.05; // samples
    for (const Sample& s : cell.samples) {
        cell.radius = std::max(cell.radius, between * glm::distance(s.position, cell.centre));
        cell.turn = std::max(cell.turn, between * glm::distance(s.normal, cell.samples[6].normal));
    }
    if (element_.surface->type == model::SurfaceType::BSpline) {
        double area = 0.0;
        Vec2 parameter;
        for (const geometry::TriangleNode& t : geometry::triangle_rule(rule_degrees[1]))
            area += node_in(cell, corners, t.barycentric, t.weight, parameter).weight;
        cell.roughness = area > 0.0 ? std::abs(cell.area / area - 1.0) : 0.0;
    }
    cells_.push_back(cell);
    return static_cast<std::uint32_t>(cells_.size() - 1);
}

void SurfaceCells::divide(std::uint32_t index) {
    const Cell parent = cells_[index];
    const auto& c = parent.corners;
    const std::array<Vec2, 3> m{0.5 * (c[0] + c[1]), 0.5 * (c[1] + c[2]), 0.5 * (c[2] + c[0])};
    const int depth = parent.depth + 1;
    cells_[index].first_child = add_cell(*parent.facet, {c[0], m[0], m[2]}, depth);
    add_cell(*parent.facet, {m[0], c[1], m[1]}, depth);
    add_cell(*parent.facet, {m[2], m[1], c[2]}, depth);
    add_cell(*parent.facet, {m[1], m[2], m[0]}, depth);
}

void SurfaceCells::gather(const SurfaceNode& x, std::span<double> values) {
    std::fill(values.begin(), values.end(), 0.0);
    if (cells_.size() > most_cells) {
        cells_.resize(roots_);
        for (Cell& root : cells_) {
            root.first_child = 0;
            root.first_node = {};
        }
        nodes_.clear();
        basis_.clear();
    }
    for (std::uint32_t root = 0; root < roots_; ++root) visit(root, x, values);
}

SurfaceCells::Look SurfaceCells::look(const Cell& cell, const SurfaceNode& x) const {
    Look result;
    const Vec3 way = cell.centre - x.position;
    result.distance = glm::length(way);
    const double here = glm::dot(x.normal, way), there = -glm::dot(cell.samples[6].normal, way);
    const double slack = cell.radius + cell.turn * (result.distance + cell.radius);
    if (here <= -cell.radius || there <= -slack) return result;
    if (here >= cell.radius && there >= slack) {
        result.view = View::Whole;
        const double d = result.distance;
        result.most = function_scale_ * cell.area * std::min(1.0, (here + cell.radius) / d) *
                      std::min(1.0, (there + slack) / d) / (std::numbers::pi * d * d);
        return result;
    }
    look_closely(cell, x, result);
    return result;
}

// Decides by the samples whether a horizon crosses the cell.
void SurfaceCells::look_closely(const Cell& cell, const SurfaceNode& x, Look& look) const {
    auto& [here, there, bend_here, bend_there] = look.clearances;
    for (std::size_t i = 0; i < cell.samples.size(); ++i) {
        const Vec3 way = cell.samples[i].position - x.position;
        here[i] = glm::dot(x.normal, way);
        there[i] = -glm::dot(cell.samples[i].normal, way);
    }
    // How far clearances are from linear: at the middles of the edges and in the centre, and what those may miss of the
    // third order.
    constexpr double safety = 1.5, third_order = 1.0 / 8.0;
    const double missed = third_order * cell.turn * cell.turn * cell.turn * (look.distance + cell.radius);
    const auto deviation = [missed](const std::array<double, 7>& c) {
        double worst = std::abs(c[6] - (c[0] + c[1] + c[2]) / 3.0);
        for (std::size_t e = 0; e < 3; ++e)
            worst = std::max(worst, std::abs(c[3 + e] - 0.5 * (c[e] + c[(e + 1) % 3])));
        return safety * worst + missed;
    };
    bend_here = deviation(here);
    bend_there = deviation(there);
    const auto [low_here, high_here] = std::minmax_element(here.begin(), here.end());
    const auto [low_there, high_there] = std::minmax_element(there.begin(), there.end());
    if (*high_here <= -bend_here || *high_there <= -bend_there) return;
    look.view = *low_here >= bend_here && *low_there >= bend_there ? View::Whole : View::Cut;
    look.most = bound(cell, x, look);
    if (look.view == View::Whole) return;
    // Beside the true line lies a strip as wide as the bend over the clearance's slope, where the clearance is below
    // the bend.
    const double d = std::max(look.distance, cell.radius);
    const auto strip = [&](double bend, double low, double high, double other) {
        if (low >= bend || !(high > low)) return 0.0;
        const double width = std::min(1.0, bend / (high - low));
        return width * bend / d * std::clamp(other / d, 0.0, 1.0);
    };
    look.cut_error = function_scale_ * cell.area / (std::numbers::pi * d * d) *
                     (strip(bend_here, *low_here, *high_here, *high_there) +
                      strip(bend_there, *low_there, *high_there, *high_here));
}

// By the largest cosines of the samples where the cell is apart; beside or below the point by the point's cosine alone,
// for no part of a hemisphere adds more than twice that.
double SurfaceCells::bound(const Cell& cell, const SurfaceNode& x, const Look& look) const {
    const auto& [here, there, bend_here, bend_there] = look.clearances;
    double most_here = 0.0, most_there = 0.0, most_kernel = 0.0;
    for (std::size_t i = 0; i < cell.samples.size(); ++i) {
        const double r = glm::distance(cell.samples[i].position, x.position);
        if (!(r > 0.0)) continue;
        const double cos_here = std::clamp((here[i] + bend_here) / r, 0.0, 1.0),
                     cos_there = std::clamp((there[i] + bend_there) / r, 0.0, 1.0);
        most_here = std::max(most_here, cos_here);
        most_there = std::max(most_there, cos_there);
        most_kernel = std::max(most_kernel, cos_here * cos_there / (std::numbers::pi * r * r));
    }
    constexpr double between = 2.0; // samples
    if (points_ == Points::OnTheSurface) return between * function_scale_ * cell.area * most_kernel;
    const double beside = function_scale_ * std::min(1.0, 2.0 * most_here);
    if (look.distance < nearest * cell.radius) return beside;
    const double d = look.distance;
    const double ratio = cell.radius / d;
    const double apart = function_scale_ * cell.area * std::min(1.0, most_here + 0.2 * ratio) *
                         std::min(1.0, most_there + 0.2 * ratio) / (std::numbers::pi * d * d);
    return std::min(beside, between * apart);
}

std::size_t SurfaceCells::rule_for(const Cell& cell, const Look& look) const {
    if (look.most <= cell_accuracy_) return 0;
    if (look.distance < nearest * cell.radius || look.cut_error > cell_accuracy_) return rule_count;
    if (cell.roughness * look.most > cell_accuracy_) return rule_count;
    constexpr double amplitude = 1.0, per_turn = 1.0 / 3.0;
    const double ratio = std::max(cell.radius / look.distance, per_turn * cell.turn);
    // The basis is rougher on large cells.
    const int taken = element_.basis.degree() >> cell.depth;
    for (std::size_t rule = 0; rule < rule_count; ++rule)
        if (amplitude * look.most * std::pow(ratio, std::max(1, rule_degrees[rule] + 1 - taken)) <=
            cell_accuracy_)
            return rule;
    return rule_count;
}

void SurfaceCells::visit(std::uint32_t index, const SurfaceNode& x, std::span<double> values) {
    Cell& cell = cells_[index];
    const Look found = look(cell, x);
    if (found.view == View::None) return;
    std::size_t rule = rule_for(cell, found);
    if (rule == rule_count && cell.depth < most_divisions) {
        if (cell.first_child == 0) divide(index);
        const std::uint32_t first = cells_[index].first_child;
        for (std::uint32_t child = first; child < first + 4; ++child) visit(child, x, values);
        return;
    }
    rule = std::min(rule, rule_count - 1);
    if (found.view == View::Whole)
        add_whole(cell, rule, x, values);
    else
        add_cut(cell, found, rule, x, values);
}

void SurfaceCells::add_node(const SurfaceNode& x, const SurfaceNode& y, std::span<const double> phi,
                            std::span<double> values) const {
    const double kernel = y.weight * kernel_value(x, y);
    if (!(kernel > 0.0)) return;
    for (std::size_t l = 0; l < values.size(); ++l) values[l] += kernel * phi[l];
}

void SurfaceCells::add_whole(Cell& cell, std::size_t rule, const SurfaceNode& x, std::span<double> values) {
    if (cell.first_node[rule] == 0) make_nodes(cell, rule);
    const std::size_t first = cell.first_node[rule] - 1, functions = values.size();
    const std::size_t count = geometry::triangle_rule(rule_degrees[rule]).size();
    for (std::size_t i = first; i < first + count; ++i)
        add_node(x, nodes_[i], std::span(basis_).subspan(i * functions, functions), values);
}

void SurfaceCells::make_nodes(Cell& cell, std::size_t rule) {
    const std::size_t functions = phi_.size();
    cell.first_node[rule] = static_cast<std::uint32_t>(nodes_.size() + 1);
    for (const geometry::TriangleNode& t : geometry::triangle_rule(rule_degrees[rule])) {
        Vec2 parameter;
        nodes_.push_back(node_in(cell, cell.corners, t.barycentric, t.weight, parameter));
        basis_.resize(nodes_.size() * functions);
        element_.basis.evaluate(parameter, std::span(basis_).last(functions));
    }
}

// The parts of the cell in front of both straight horizons, as fans of triangles.
void SurfaceCells::add_cut(const Cell& cell, const Look& look, std::size_t rule, const SurfaceNode& x,
                           std::span<double> values) {
    const auto& c = cell.corners;
    const Vec2 e1 = c[1] - c[0], e2 = c[2] - c[0];
    const double whole = cross(e1, e2);
    const auto linear = [&](const std::array<double, 7>& at_corners) {
        return [&, whole](const Vec2& p) {
            const double b1 = cross(p - c[0], e2) / whole, b2 = cross(e1, p - c[0]) / whole;
            return (1.0 - b1 - b2) * at_corners[0] + b1 * at_corners[1] + b2 * at_corners[2];
        };
    };
    cutter_.begin(c);
    cutter_.keep(linear(look.clearances.here));
    if (cutter_.loop().size() >= 3) cutter_.keep(linear(look.clearances.there));
    const std::span<const Vec2> loop = cutter_.loop();
    for (std::size_t i = 2; i < loop.size(); ++i)
        for (const geometry::TriangleNode& t : geometry::triangle_rule(rule_degrees[rule])) {
            Vec2 parameter;
            const SurfaceNode y =
                node_in(cell, {loop[0], loop[i - 1], loop[i]}, t.barycentric, t.weight, parameter);
            if (!(kernel_value(x, y) > 0.0)) continue;
            element_.basis.evaluate(parameter, phi_);
            add_node(x, y, phi_, values);
        }
}

SurfaceNode SurfaceCells::node_in(const Cell& cell, const std::array<Vec2, 3>& corners,
                                  const std::array<double, 3>& at, double weight, Vec2& parameter) const {
    const Vec2 local = at[0] * corners[0] + at[1] * corners[1] + at[2] * corners[2];
    SurfaceNode node =
        geometry::node_at(element_, *cell.facet, {1.0 - local.x - local.y, local.x, local.y}, parameter);
    // node_at's weight is the area per unit of the reference triangle's measure, which is 2 ds dt.
    node.weight *= weight * std::abs(cross(corners[1] - corners[0], corners[2] - corners[0]));
    return node;
}

} // namespace kinelux::kernel
