// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/pair_reference.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/quadrature.h"
#include "support/point_integral.h"

namespace kinelux::support {

namespace {

using geometry::ElementShape;

constexpr int outer_nodes = 8;     ///< per direction of a cell, at degree 0
constexpr int few_outer_nodes = 6; ///< the same where little is asked for
constexpr double little = 1e-5;    ///< tolerance from which few nodes cost less
constexpr double near_side = 0.25; ///< of the outer piece's size: a side as near cuts it
constexpr double vanishing_side =
    1e-4;                           ///< projected / real length of a side that is perpendicular to the piece
constexpr double close_side = 0.02; ///< of a side's length
constexpr double grading = 0.2;     ///< where a cell at the border of its triangle is cut
constexpr double negligible_block = 1e-6; ///< a smaller block is right to a share of this
constexpr double light_cell = 10.0;       ///< in tolerances of a cell
constexpr int most_cells = 400;           ///< of one triangle: beyond it the disagreement says what is left
constexpr int most_cuts = 60;             ///< of one cell into ever smaller ones

double norm_of(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// A triangle over a side of a piece of a, in the coordinates (s, t): s from the side (0) to the apex (1), t along it.
struct OuterTriangle {
    Vec2 from, to, apex;
    bool at_side; ///< a side of b runs close to this one
};

struct Cell {
    double s0, s1, t0, t1;
};

// Where a piece of a is cut: along the projected sides of b that come near it, and across sides that stand upright on
// it, so that what the inner integral does near sides and corners of b happens at borders and corners of the parts.
std::vector<Line> cutting_lines(const FlatPiece& a, const FlatPiece& b, const Polygon& part) {
    const double size = diameter(part);
    Vec2 centre(0.0);
    for (const Vec2& p : part) centre += p / static_cast<double>(part.size());
    const Vec2 across(glm::dot(b.plane.normal, a.plane.axis_u), glm::dot(b.plane.normal, a.plane.axis_v));
    std::vector<Line> lines;
    for (const Line& side : b.outline) {
        Vec3 from = b.plane.point(side.from), to = b.plane.point(side.to);
        double low = a.plane.height(from), high = a.plane.height(to);
        if (low > high) std::swap(from, to), std::swap(low, high);
        const double reach = near_side * size;
        if (low > reach) continue;
        if (high > reach) to = from + (to - from) * ((reach - low) / (high - low));
        const Vec2 p = a.plane.local(from), q = a.plane.local(to);
        const double length = glm::distance(from, to), projected = glm::distance(p, q);
        if (glm::distance(0.5 * (p + q), centre) > 0.5 * projected + size + reach) continue;
        if (length > 0.0 && projected > vanishing_side * length)
            lines.push_back({p, q});
        else if (glm::length(across) > vanishing_side)
            lines.push_back({p, p + across});
    }
    return lines;
}

double distance_to_side(const Vec3& x, const Vec3& from, const Vec3& to) {
    const Vec3 side = to - from;
    const double length2 = glm::dot(side, side);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(x - from, side) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(x, from + t * side);
}

// Whether a line of a's plane has its middle so close to a side of b that a step may run along it.
bool runs_at_side(const FlatPiece& a, const FlatPiece& b, const Vec2& from, const Vec2& to) {
    const Vec3 middle = a.plane.point(0.5 * (from + to));
    return std::any_of(b.outline.begin(), b.outline.end(), [&](const Line& side) {
        return distance_to_side(middle, b.plane.point(side.from), b.plane.point(side.to)) <
               close_side * glm::distance(from, to);
    });
}

std::vector<Polygon> outer_parts(const FlatPiece& a, const FlatPiece& b) {
    std::vector<Polygon> result;
    for (const Polygon& whole : a.parts) {
        std::vector<Polygon> parts{whole};
        for (const Line& line : cutting_lines(a, b, whole)) {
            std::vector<Polygon> finer;
            for (const Polygon& part : parts)
                for (Polygon& half : cut(part, line)) finer.push_back(std::move(half));
            parts = std::move(finer);
        }
        for (Polygon& part : parts) result.push_back(std::move(part));
    }
    return result;
}

// The adaptive outer integral over one flat piece of a, with all of one piece of b in front.
class OuterIntegral {
public:
    OuterIntegral(const ElementShape& a, const FlatPiece& piece_a, const ElementShape& b,
                  const FlatPiece& piece_b, double tolerance)
        : a_(a),
          b_(b),
          piece_(piece_a),
          inner_(piece_b, b.basis),
          tolerance_(tolerance),
          rule_(geometry::gauss_rule((tolerance < little ? outer_nodes : few_outer_nodes) +
                                     a.basis.degree() / 2)) {
        for (const Polygon& part : outer_parts(piece_a, piece_b)) add_triangles(part, piece_b);
        const std::size_t n = rule_.nodes.size();
        for (std::size_t i = 0; i < n; ++i) {
            // The Legendre polynomial of degree n - 1 on [0, 1], by its recurrence.
            const double z = 2.0 * rule_.nodes[i] - 1.0;
            double previous = 1.0, current = z;
            for (std::size_t k = 1; k + 1 < n; ++k) {
                const double m = static_cast<double>(k);
                previous = std::exchange(current, ((2.0 * m + 1.0) * z * current - m * previous) / (m + 1.0));
            }
            top_.push_back(rule_.weights[i] * current);
        }
    }

    void add_to(std::vector<double>& sums) {
        std::vector<Value> roots;
        std::vector<double> rough(sums.size(), 0.0);
        for (const OuterTriangle& triangle : triangles_) {
            triangle_ = triangle;
            roots.push_back(value_of({0.0, 1.0, 0.0, 1.0}));
            for (std::size_t k = 0; k < rough.size(); ++k) rough[k] += roots.back().block[k];
        }
        size_ = norm_of(rough);
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            triangle_ = triangles_[t];
            cells_ = 0;
            refine({0.0, 1.0, 0.0, 1.0}, roots[t], 0, sums);
            size_ = std::max(size_, norm_of(sums));
        }
    }

private:
    struct Value {
        std::vector<double> block;
        double unrest_s, unrest_t; ///< top Legendre coefficients of the inner integral in both directions
    };

    void add_triangles(const Polygon& part, const FlatPiece& piece_b) {
        Vec2 centre(0.0);
        for (const Vec2& p : part) centre += p / static_cast<double>(part.size());
        for (std::size_t i = 0; i < part.size(); ++i) {
            const Vec2 &from = part[i], &to = part[(i + 1) % part.size()];
            triangles_.push_back({from, to, centre, runs_at_side(piece_, piece_b, from, to)});
        }
    }

    Value value_of(const Cell& cell) {
        const std::size_t n = rule_.nodes.size(), na = a_.basis.size(), nb = b_.basis.size();
        Value value{std::vector<double>(na * nb, 0.0), 0.0, 0.0};
        std::vector<double> gathered(n * n * nb, 0.0), phi(na);
        const double twice_area =
            std::abs(cross(triangle_.to - triangle_.from, triangle_.apex - triangle_.from));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) {
                const double s = cell.s0 + (cell.s1 - cell.s0) * rule_.nodes[i];
                const double t = cell.t0 + (cell.t1 - cell.t0) * rule_.nodes[j];
                const Vec2 p =
                    (1.0 - s) * (triangle_.from + t * (triangle_.to - triangle_.from)) + s * triangle_.apex;
                const auto row = std::span(gathered).subspan((i * n + j) * nb, nb);
                inner_.add(piece_.plane.point(p), piece_.plane.normal, row);
                a_.basis.evaluate(piece_.plane.parameter(p), phi);
                const double jacobian = twice_area * (1.0 - s) * (cell.s1 - cell.s0) * (cell.t1 - cell.t0);
                for (double& entry : row) entry *= jacobian;
                const double weight = rule_.weights[i] * rule_.weights[j];
                for (std::size_t k = 0; k < na; ++k)
                    for (std::size_t l = 0; l < nb; ++l) value.block[k * nb + l] += weight * phi[k] * row[l];
            }
        set_unrest(gathered, value);
        return value;
    }

    void set_unrest(std::span<const double> gathered, Value& value) const {
        const std::size_t n = rule_.nodes.size(), nb = b_.basis.size();
        for (std::size_t fixed = 0; fixed < n; ++fixed)
            for (std::size_t l = 0; l < nb; ++l) {
                double in_s = 0.0, in_t = 0.0;
                for (std::size_t i = 0; i < n; ++i) {
                    in_s += top_[i] * gathered[(i * n + fixed) * nb + l];
                    in_t += top_[i] * gathered[(fixed * n + i) * nb + l];
                }
                value.unrest_s += std::abs(in_s) * rule_.weights[fixed];
                value.unrest_t += std::abs(in_t) * rule_.weights[fixed];
            }
    }

    static double cut_of(double low, double high) {
        if (low == 0.0 && high < 1.0) return grading * high;
        if (high == 1.0 && low > 0.0) return high - grading * (high - low);
        return 0.5 * (low + high);
    }

    // What a cell could add to the block's constant term if all that leaves it reached b.
    double largest_value(const Cell& cell) const {
        const double twice_area =
            std::abs(cross(triangle_.to - triangle_.from, triangle_.apex - triangle_.from));
        return twice_area * (cell.s1 - cell.s0) * (cell.t1 - cell.t0) / std::sqrt(a_.area * b_.area);
    }

    enum class Along : std::uint8_t { S, T };
    struct Halves {
        Cell first, second;
        Value a, b;
        double change; ///< of the cell's value by cutting it
    };

    Halves cut_along(Along direction, const Cell& cell, const Value& whole) {
        Halves halves{cell, cell, {}, {}, 0.0};
        // Towards the apex all is smooth: only the side is graded.
        if (direction == Along::S)
            halves.first.s1 = halves.second.s0 =
                cell.s0 == 0.0 ? grading * cell.s1 : 0.5 * (cell.s0 + cell.s1);
        else
            halves.first.t1 = halves.second.t0 = cut_of(cell.t0, cell.t1);
        halves.a = value_of(halves.first);
        halves.b = value_of(halves.second);
        for (std::size_t k = 0; k < whole.block.size(); ++k)
            halves.change = std::hypot(halves.change, halves.a.block[k] + halves.b.block[k] - whole.block[k]);
        return halves;
    }

    // Cuts a cell where it is least smooth until neither cut changes its value.
    void refine(const Cell& cell, const Value& whole, int cuts, std::vector<double>& sums) {
        const double enough = tolerance_ * std::max(size_, negligible_block);
        const Along first = whole.unrest_s >= whole.unrest_t ? Along::S : Along::T;
        // A step as narrow as a gap may hide below the first node: a cell at the side is cut until it is light.
        const bool hiding = triangle_.at_side && cell.s0 == 0.0 && largest_value(cell) > light_cell * enough;
        cells_ += 2;
        Halves halves = cut_along(hiding ? Along::S : first, cell, whole);
        if (!hiding && halves.change <= enough)
            halves = cut_along(first == Along::S ? Along::T : Along::S, cell, whole);
        if ((!hiding && halves.change <= enough) || cuts >= most_cuts || cells_ >= most_cells) {
            for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += halves.a.block[k] + halves.b.block[k];
            return;
        }
        refine(halves.first, halves.a, cuts + 1, sums);
        refine(halves.second, halves.b, cuts + 1, sums);
    }

    const ElementShape& a_;
    const ElementShape& b_;
    const FlatPiece& piece_;
    PointIntegral inner_;
    double tolerance_;
    const geometry::GaussRule& rule_;
    std::vector<double> top_; ///< weights of the rule's nodes for the top Legendre coefficient
    std::vector<OuterTriangle> triangles_;
    OuterTriangle triangle_{};
    double size_ = 0.0;
    int cells_ = 0; ///< of the triangle at hand
};

std::vector<double> from_the_side_of(const ElementShape& a, const ElementShape& b, double tolerance) {
    std::vector<double> sums(a.basis.size() * b.basis.size(), 0.0);
    for (const FlatPiece& whole_a : flat_pieces(a))
        for (const FlatPiece& whole_b : flat_pieces(b)) {
            const FlatPiece piece_a = in_front(whole_a, whole_b.plane),
                            piece_b = in_front(whole_b, whole_a.plane);
            if (piece_a.parts.empty() || piece_b.parts.empty()) continue;
            std::vector<double> part(sums.size(), 0.0);
            OuterIntegral(a, piece_a, b, piece_b, tolerance).add_to(part);
            for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += part[k];
        }
    return sums;
}

} // namespace

PairReference pair_reference(const ElementShape& a, const ElementShape& b, double tolerance) {
    const std::vector<double> forward = from_the_side_of(a, b, tolerance);
    const std::vector<double> backward = from_the_side_of(b, a, tolerance);
    const std::size_t na = a.basis.size(), nb = b.basis.size();
    PairReference reference{forward, 0.0, 0.0};
    for (std::size_t k = 0; k < na; ++k)
        for (std::size_t l = 0; l < nb; ++l) {
            double& value = reference.values[k * nb + l];
            const double other = backward[l * na + k];
            reference.disagreement = std::hypot(reference.disagreement, value - other);
            value = 0.5 * (value + other);
        }
    reference.norm = norm_of(reference.values);
    return reference;
}

std::vector<double> point_reference(const Vec3& x, const Vec3& normal, const ElementShape& b) {
    std::vector<double> sums(b.basis.size(), 0.0);
    for (const FlatPiece& piece : flat_pieces(b)) PointIntegral(piece, b.basis).add(x, normal, sums);
    return sums;
}

} // namespace kinelux::support
