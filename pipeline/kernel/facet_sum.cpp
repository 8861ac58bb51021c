// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/facet_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/quadrature.h"
#include "kernel/far_pair.h"
#include "kernel/polygon_irradiance.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::SurfaceNode;

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

} // namespace

FacetSum::FacetSum(const ElementShape& element, double accuracy)
    : element_(element),
      facet_accuracy_(accuracy / std::sqrt(static_cast<double>(element.facets.size()))),
      function_scale_((1.0 + element.basis.degree()) / std::sqrt(element.area)),
      phi_(element.basis.size()),
      part_(element.basis.size()) {
    for (const Facet& facet : element.facets) {
        const auto& [p0, p1, p2] = facet.corners;
        Ball ball{(p0 + p1 + p2) / 3.0, 0.0,
                  (facet.parameters[0] + facet.parameters[1] + facet.parameters[2]) / 3.0};
        for (const Vec3& corner : facet.corners)
            ball.radius = std::max(ball.radius, glm::distance(corner, ball.centre));
        balls_.push_back(ball);
        if (element.basis.degree() > 0) moments_.emplace_back(facet, element.basis);
    }
}

void FacetSum::gather(const SurfaceNode& x, std::span<double> values) {
    std::fill(values.begin(), values.end(), 0.0);
    // The kernel's second and third order over a facet, relative to its size.
    constexpr double second_order = 1.0, third_order = 2.0, apart = 1.5;
    for (std::size_t f = 0; f < balls_.size(); ++f) {
        const Facet& facet = element_.facets[f];
        const Ball& ball = balls_[f];
        const Vec3 way = ball.centre - x.position;
        const double there = -glm::dot(facet.normal, way), here = glm::dot(x.normal, way);
        if (!(there > 0.0) || !(here > -ball.radius)) continue;
        const double d2 = glm::dot(way, way), d = std::sqrt(d2), ratio = ball.radius / d;
        const double size = function_scale_ * facet.area * std::min(1.0, (here + ball.radius) / d) *
                            std::min(1.0, there / d + 0.2 * ratio) / (std::numbers::pi * d2);
        const double degree = 1.0 + element_.basis.degree();
        if (d > apart * ball.radius && degree * second_order * size * ratio * ratio <= facet_accuracy_) {
            add_node(x, {ball.centre, facet.normal, facet.area}, ball.parameter, values);
            continue;
        }
        if (here > ball.radius && d > apart * ball.radius &&
            degree * third_order * size * ratio * ratio * ratio <= facet_accuracy_) {
            for (const geometry::TriangleNode& t : geometry::triangle_rule(2)) {
                Vec2 parameter;
                SurfaceNode y = geometry::node_at(element_, facet, t.barycentric, parameter);
                y.weight *= t.weight;
                add_node(x, y, parameter, values);
            }
            continue;
        }
        add_exact(f, x, values);
    }
}

void FacetSum::add_node(const SurfaceNode& x, const SurfaceNode& y, const Vec2& parameter,
                        std::span<double> values) {
    const double kernel = y.weight * kernel_value(x, y);
    if (!(kernel > 0.0)) return;
    element_.basis.evaluate(parameter, phi_);
    for (std::size_t l = 0; l < values.size(); ++l) values[l] += kernel * phi_[l];
}

void FacetSum::add_exact(std::size_t f, const SurfaceNode& x, std::span<double> values) {
    const Facet& facet = element_.facets[f];
    if (moments_.empty()) {
        values[0] += point_to_polygon(x.position, x.normal, facet.corners) / std::sqrt(element_.area);
        return;
    }
    cutter_.begin(facet.corners);
    cutter_.keep([&](const Vec3& point) { return glm::dot(x.normal, point - x.position); });
    if (cutter_.loop().size() < 3) return;
    loops_.clear();
    loops_.add(cutter_.loop());
    moments_[f].to_plane(loops_, flat_);
    constexpr double fine = 1e-4; // relative to one facet
    moments_[f].gather(x.position, x.normal, flat_, fine, part_);
    for (std::size_t l = 0; l < values.size(); ++l) values[l] += part_[l];
}

namespace {

// Rules on a triangle: one node, whose error is foretold; else two rules, whose difference is the error.
enum class Step { Centre, One, Two };

// A triangle in a facet's barycentric coordinates.
struct Triangle {
    const Facet* facet;
    std::array<Vec2, 3> corners;
    Step step = Step::Centre;
    std::vector<double> values;
    double error = 0.0;
};

bool smaller_error(const Triangle& a, const Triangle& b) { return a.error < b.error; }

class FacetIntegrator {
public:
    FacetIntegrator(const ElementShape& outer, const ElementShape& inner, PointGather& gather,
                    const OuterOptions& options)
        : outer_(outer),
          inner_(inner),
          gather_(gather),
          options_(options),
          columns_(inner.basis.size()),
          gathered_(columns_),
          phi_(outer.basis.size()),
          coarse_(outer.basis.size() * columns_) {}

    OuterResult run(std::span<const OuterPiece> pieces) {
        for (const OuterPiece& piece : pieces)
            for (std::size_t i = 2; i < piece.corners.size(); ++i)
                add({piece.facet, {piece.corners[0], piece.corners[i - 1], piece.corners[i]}});
        std::make_heap(triangles_.begin(), triangles_.end(), smaller_error);
        // Sums are kept up to date by differences; they only steer.
        OuterResult sum = total();
        while (points_ < options_.most_points && !triangles_.empty() &&
               sum.error > options_.tolerance * std::max(norm(sum.values), options_.floor)) {
            std::pop_heap(triangles_.begin(), triangles_.end(), smaller_error);
            const Triangle worst = std::move(triangles_.back());
            triangles_.pop_back();
            account(worst, -1.0, sum);
            std::size_t done = triangles_.size();
            refine(worst);
            for (; done < triangles_.size(); ++done) {
                account(triangles_[done], 1.0, sum);
                std::push_heap(triangles_.begin(), triangles_.begin() + static_cast<std::ptrdiff_t>(done) + 1,
                               smaller_error);
            }
        }
        return total();
    }

private:
    void refine(const Triangle& worst) {
        if (worst.step == Step::Centre) return add({worst.facet, worst.corners, Step::One});
        if (worst.step == Step::One) return add({worst.facet, worst.corners, Step::Two});
        const auto& c = worst.corners;
        const Vec3 e1 = worst.facet->corners[1] - worst.facet->corners[0],
                   e2 = worst.facet->corners[2] - worst.facet->corners[0];
        const auto length = [&](std::size_t i) {
            const Vec2 side = c[(i + 1) % 3] - c[i];
            return glm::length(side.x * e1 + side.y * e2);
        };
        std::size_t longest = 0;
        for (const std::size_t i : {1u, 2u})
            if (length(i) > length(longest)) longest = i;
        const Vec2 &p = c[longest], &q = c[(longest + 1) % 3], &r = c[(longest + 2) % 3];
        const Vec2 middle = 0.5 * (p + q);
        add({worst.facet, {p, middle, r}, Step::Two});
        add({worst.facet, {middle, q, r}, Step::Two});
    }

    void add(Triangle triangle) {
        triangle.values.assign(coarse_.size(), 0.0);
        if (triangle.step == Step::Centre) {
            apply(triangle, 1, triangle.values);
            triangle.error = foretold(triangle);
        } else {
            std::fill(coarse_.begin(), coarse_.end(), 0.0);
            apply(triangle, triangle.step == Step::One ? 1 : 2, coarse_);
            apply(triangle, triangle.step == Step::One ? 2 : 5, triangle.values);
            for (std::size_t k = 0; k < coarse_.size(); ++k) coarse_[k] -= triangle.values[k];
            triangle.error = norm(coarse_);
        }
        triangles_.push_back(std::move(triangle));
    }

    static double share_of(const Triangle& triangle) {
        const Vec2 e = triangle.corners[1] - triangle.corners[0],
                   f = triangle.corners[2] - triangle.corners[0];
        return std::abs(e.x * f.y - e.y * f.x);
    }

    // The second order of the kernel over the triangle; everything where it is not apart from the inner element.
    double foretold(const Triangle& triangle) const {
        const Facet& facet = *triangle.facet;
        const Vec3 centre = (facet.corners[0] + facet.corners[1] + facet.corners[2]) / 3.0;
        double radius = 0.0;
        for (const Vec3& corner : facet.corners) radius = std::max(radius, glm::distance(corner, centre));
        const Vec3 way = inner_.centre - centre;
        const double distance = glm::length(way), apart = distance - inner_.radius;
        const double scale =
            (1.0 + outer_.basis.degree()) * share_of(triangle) * facet.area / std::sqrt(outer_.area);
        const double most = scale / std::sqrt(inner_.area); // of all that one point can receive
        if (!(apart > 2.0 * radius)) return most;
        const double ratio = radius / apart;
        const double cosine =
            std::clamp((glm::dot(facet.normal, way) + inner_.radius) / distance + ratio, 0.0, 1.0);
        return std::min(most, scale * std::sqrt(inner_.area) * cosine * ratio * ratio /
                                  (std::numbers::pi * distance * distance));
    }

    void apply(const Triangle& triangle, int degree, std::span<double> values) {
        const auto& c = triangle.corners;
        const double share = share_of(triangle);
        for (const geometry::TriangleNode& t : geometry::triangle_rule(degree)) {
            const Vec2 at = t.barycentric[0] * c[0] + t.barycentric[1] * c[1] + t.barycentric[2] * c[2];
            Vec2 parameter;
            const SurfaceNode x =
                geometry::node_at(outer_, *triangle.facet, {1.0 - at.x - at.y, at.x, at.y}, parameter);
            gather_.gather(x, gathered_);
            ++points_;
            outer_.basis.evaluate(parameter, phi_);
            const double weight = t.weight * share * x.weight;
            for (std::size_t k = 0; k < phi_.size(); ++k)
                for (std::size_t l = 0; l < columns_; ++l)
                    values[k * columns_ + l] += weight * phi_[k] * gathered_[l];
        }
    }

    static void account(const Triangle& triangle, double sign, OuterResult& result) {
        result.error += sign * triangle.error;
        for (std::size_t k = 0; k < result.values.size(); ++k) result.values[k] += sign * triangle.values[k];
    }

    OuterResult total() const {
        OuterResult result{.values = std::vector<double>(coarse_.size(), 0.0), .points = points_};
        for (const Triangle& triangle : triangles_) account(triangle, 1.0, result);
        return result;
    }

    const ElementShape& outer_;
    const ElementShape& inner_;
    PointGather& gather_;
    OuterOptions options_;
    std::size_t columns_;
    std::vector<double> gathered_, phi_, coarse_;
    std::vector<Triangle> triangles_;
    std::size_t points_ = 0;
};

} // namespace

OuterResult integrate_facets(const ElementShape& outer, std::span<const OuterPiece> pieces,
                             const ElementShape& inner, PointGather& gather, const OuterOptions& options) {
    return FacetIntegrator(outer, inner, gather, options).run(pieces);
}

} // namespace kinelux::kernel
