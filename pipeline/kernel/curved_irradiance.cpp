// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/curved_irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/facet_surface.h"
#include "geometry/kronrod.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::FacetSurface;
using geometry::KronrodRule;

constexpr std::size_t most_functions = geometry::basis_size(geometry::max_degree);
constexpr std::size_t most_nodes = 15;
// From this tolerance on the rule of 7 nodes needs fewer evaluations than that of 15.
constexpr double short_rule_tolerance = 3e-3;
constexpr double hidden_tolerance = 1e-2; ///< what sampling visibility is worth at the best
constexpr std::size_t most_evaluations = 400000, most_hidden_evaluations = 4000;
// Share of the tolerance that the integrals along rays may use.
constexpr double ray_share = 0.1;
constexpr int ray_depth = 12; ///< halvings of a ray
constexpr int cut_depth = 4;  ///< what a cut at roots costs of it: its parts should need no other
constexpr int fan_depth = 5;  ///< halvings of a fan in search of rays that see anything
// Longest interval of a sinh substitution that one rule is trusted with.
constexpr double longest_interval = 4.0;
// A receiver nearer than this share of the element's radius, and facing the same way, lies on it.
constexpr double on_surface_share = 1e-9;
// Grading towards the edges next to a receiver on the surface stops at this share of the edge.
constexpr double finest_fan = 1e-4;
constexpr double rounding_share = 4.0 * std::numeric_limits<double>::epsilon(); ///< of the coordinates
constexpr double no_area = 1e-14; ///< share of a facet below which a fan is left out
// Values below this, relative to those of a fully seen hemisphere, count as zero.
constexpr double nothing = 1e-13;

// What a receiver sees of a point.
struct Sight {
    double clearance = 0.0; ///< the lesser of both cosines; the point is faced where it is above 0
    double kernel = 0.0;    ///< times dA / (ds dt) [1]
};

// An integral of the integrand with all basis functions, or a part of it.
struct Sum {
    std::array<double, most_functions> values{};
    double size = 0.0;       ///< integral of the integrand's norm
    double error = 0.0;      ///< estimated norm of the error
    double clearance = -1.0; ///< largest met

    void add(const Sum& part, double weight, std::size_t functions) {
        for (std::size_t l = 0; l < functions; ++l) values[l] += weight * part.values[l];
        size += weight * part.size;
        error += weight * part.error;
        clearance = std::max(clearance, part.clearance);
    }
};

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// A substitution: scale sinh(w) about `foot`, or w itself where the scale is 0.
struct Grading {
    double foot = 0.0, scale = 0.0;

    double at(double w) const { return scale > 0.0 ? foot + scale * std::sinh(w) : w; }
    double slope(double w) const { return scale > 0.0 ? scale * std::cosh(w) : 1.0; }
    double inverse(double value) const { return scale > 0.0 ? std::asinh((value - foot) / scale) : value; }
};

// A triangle of a facet's domain with the apex at the point nearest to the receiver.
struct Fan {
    FacetSurface surface;
    Vec2 apex, from, edge; ///< local coordinates; the side opposite to the apex is from + t edge
    double jacobian;       ///< ds dt of the facet per (radial share) d(radial share) dt
    double height;         ///< distance of the receiver from the apex; 0 on the surface [m]
    FacetSurface::Point at_apex;
    Grading grading; ///< of t
};

struct Ray {
    const Fan* fan;
    Vec2 way; ///< from the apex to the opposite side
    Grading grading;
};

// A part of a fan's range of w, with its integral.
struct Panel {
    std::size_t fan;
    double low, high;
    Sum sum;
    std::size_t number; ///< in order of making, so that equal errors are taken in a fixed order
};

struct LessError {
    bool operator()(const Panel& a, const Panel& b) const {
        return a.sum.error != b.sum.error ? a.sum.error < b.sum.error : a.number > b.number;
    }
};

// Whether clearances that are all below 0 could rise above it between two nodes, judged by their slopes.
bool near_miss(std::span<const double> clearances) {
    for (std::size_t i = 0; i < clearances.size(); ++i) {
        double slope = 0.0;
        if (i > 0) slope = std::max(slope, std::abs(clearances[i] - clearances[i - 1]));
        if (i + 1 < clearances.size()) slope = std::max(slope, std::abs(clearances[i] - clearances[i + 1]));
        if (clearances[i] + 0.5 * slope > 0.0) return true;
    }
    return false;
}

class CurvedIntegral {
public:
    CurvedIntegral(const Vec3& x, const Vec3& normal, const ElementShape& b, double tolerance,
                   const SeesPoint& sees)
        : x_(x),
          normal_(normal),
          b_(b),
          tolerance_(sees ? std::max(tolerance, hidden_tolerance) : tolerance),
          limit_(sees ? most_hidden_evaluations : most_evaluations),
          sees_(sees),
          rule_(tolerance_ >= short_rule_tolerance ? geometry::kronrod_7() : geometry::kronrod_15()),
          functions_(b.basis.size()),
          rounding_(rounding_share * (glm::length(x) + glm::length(b.centre) + b.radius)) {
        for (const geometry::Facet& facet : b.facets) add_fans(FacetSurface(b, facet));
    }

    Sum integrate() {
        for (std::size_t f = 0; f < fans_.size(); ++f) start_fan(f);
        while (!panels_.empty()) {
            const Sum sum = total();
            const double least = nothing / std::sqrt(b_.area);
            const double wanted = tolerance_ * norm(std::span(sum.values).first(functions_)) + least;
            if (sum.error <= wanted || evaluations_ > limit_) return sum;
            const Panel worst = take_worst();
            const double middle = 0.5 * (worst.low + worst.high);
            add_panel(worst.fan, worst.low, middle, 0);
            add_panel(worst.fan, middle, worst.high, 0);
        }
        return {};
    }

private:
    static constexpr std::array<Vec2, 3> corners{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};

    void add_fans(const FacetSurface& surface) {
        const Vec2 apex = surface.nearest(x_);
        const FacetSurface::Point foot = surface.at(apex);
        double height = glm::distance(foot.position, x_);
        const bool same_way = glm::dot(foot.area_normal, normal_) > 0.5 * glm::length(foot.area_normal);
        if (height < on_surface_share * b_.radius && same_way) height = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec2 from = corners[c] - apex, to = corners[(c + 1) % 3] - apex;
            const double jacobian = from.x * to.y - from.y * to.x;
            if (jacobian <= no_area) continue;
            Fan fan{surface, apex, corners[c], corners[(c + 1) % 3] - corners[c], jacobian, height, foot, {}};
            fan.grading = grading_of(fan);
            fans_.push_back(fan);
        }
    }

    // Of the rays: by the distance of the opposite side from the apex, in the metric there.
    static Grading grading_of(const Fan& fan) {
        const auto in_space = [&](const Vec2& v) {
            return v.x * fan.at_apex.along_s + v.y * fan.at_apex.along_t;
        };
        const Vec3 start = in_space(fan.from - fan.apex), side = in_space(fan.edge);
        const double length2 = glm::dot(side, side);
        if (!(length2 > 0.0)) return {};
        Grading grading;
        grading.foot = -glm::dot(start, side) / length2;
        const double distance = std::hypot(glm::length(start + grading.foot * side), fan.height);
        grading.scale = std::max(distance / std::sqrt(length2), finest_fan * (fan.height > 0.0 ? 1e-8 : 1.0));
        return grading;
    }

    Ray ray_at(const Fan& fan, double t) const {
        const Vec2 way = fan.from + t * fan.edge - fan.apex;
        Ray ray{&fan, way, {}};
        if (fan.height > 0.0) {
            const double speed = glm::length(way.x * fan.at_apex.along_s + way.y * fan.at_apex.along_t);
            const double chord = glm::distance(fan.surface.at(fan.apex + way).position, fan.at_apex.position);
            const double length = speed > 1e-3 * chord ? speed : chord;
            if (length > 0.0) ray.grading.scale = fan.height / length;
        }
        return ray;
    }

    Sight look(const FacetSurface::Point& y) const {
        const Vec3 way = y.position - x_;
        const double r2 = glm::dot(way, way), density = glm::length(y.area_normal);
        Sight sight;
        if (!(r2 > 0.0) || !(density > 0.0)) return sight;
        const double here = glm::dot(normal_, way), there = -glm::dot(y.area_normal, way) / density;
        const double least = std::min(here, there);
        if (std::abs(least) <= rounding_) return sight;
        sight.clearance = least / std::sqrt(r2);
        if (sight.clearance > 0.0) sight.kernel = here * there * density / (std::numbers::pi * r2 * r2);
        return sight;
    }

    double clearance_on(const Ray& ray, double w) {
        ++evaluations_;
        return look(ray.fan->surface.at(ray.fan->apex + ray.grading.at(w) * ray.way)).clearance;
    }

    double clearance_opposite(const Fan& fan, double w) {
        ++evaluations_;
        return look(fan.surface.at(fan.from + fan.grading.at(w) * fan.edge)).clearance;
    }

    // Where a function of opposite signs at both ends vanishes, by the Illinois variant of the false position. The
    // integrand vanishes there too, so that the square of the root's error counts.
    template <class Function>
    double root(const Function& f, double low, double f_low, double high, double f_high) const {
        constexpr int most_steps = 60;
        const double close = 1e-3 * std::sqrt(tolerance_) * (high - low);
        int last = 0;
        for (int step = 0; step < most_steps && high - low > close; ++step) {
            const double middle = (low * f_high - high * f_low) / (f_high - f_low);
            const double value = f(middle);
            if (value == 0.0) return middle;
            if ((value > 0.0) == (f_high > 0.0)) {
                if (std::abs(high - middle) < close) return middle;
                high = middle;
                f_high = value;
                if (last == 1) f_low *= 0.5;
                last = 1;
            } else {
                if (std::abs(middle - low) < close) return middle;
                low = middle;
                f_low = value;
                if (last == -1) f_high *= 0.5;
                last = -1;
            }
        }
        return 0.5 * (low + high);
    }

    // The ends of an interval with the roots between that the signs at the rule's nodes and at the ends tell of.
    template <class Function>
    std::vector<double> cut_at_roots(const Function& f, double low, double high) {
        std::vector<double> cuts{low};
        double at = low, value = f(low);
        for (std::size_t i = 0; i <= rule_.nodes.size(); ++i) {
            const double next =
                i < rule_.nodes.size() ? 0.5 * (low + high + (high - low) * rule_.nodes[i]) : high;
            const double next_value = f(next);
            if ((value > 0.0) != (next_value > 0.0)) cuts.push_back(root(f, at, value, next, next_value));
            at = next;
            value = next_value;
        }
        cuts.push_back(high);
        return cuts;
    }

    // The integrand at the nodes of a rule along a part of a ray.
    struct Nodes {
        std::array<FacetSurface::Point, most_nodes> points;
        std::array<double, most_nodes> clearances, kernels;
        std::size_t faced = 0, turned_away = 0;
    };

    Nodes nodes_on(const Ray& ray, double low, double high) {
        Nodes nodes;
        for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
            const double w = 0.5 * (low + high + (high - low) * rule_.nodes[i]), share = ray.grading.at(w);
            nodes.points[i] = ray.fan->surface.at(ray.fan->apex + share * ray.way);
            const Sight sight = look(nodes.points[i]);
            nodes.clearances[i] = sight.clearance;
            nodes.kernels[i] =
                0.5 * (high - low) * sight.kernel * share * ray.grading.slope(w) * ray.fan->jacobian;
            nodes.faced += sight.clearance > 0.0 ? 1 : 0;
            nodes.turned_away += sight.clearance < 0.0 ? 1 : 0;
        }
        evaluations_ += rule_.nodes.size();
        return nodes;
    }

    // Whether the signs at the ends of a part of a ray are known not to differ from those at its nodes.
    enum class Ends { Unknown, Known };

    // Whether the clearance has another sign somewhere on a part of a ray whose nodes are all alike.
    bool turns_at_ends(const Ray& ray, double low, double high, const Nodes& nodes) {
        const double first = clearance_on(ray, low), last = clearance_on(ray, high);
        return nodes.faced > 0 ? first < 0.0 || last < 0.0 : first > 0.0 || last > 0.0;
    }

    Sum part_of_ray(const Ray& ray, double low, double high, int depth, Ends ends) {
        const Nodes nodes = nodes_on(ray, low, high);
        const auto clearances = std::span(nodes.clearances).first(rule_.nodes.size());
        const auto divided = [&](std::span<const double> cuts, int left, Ends known) {
            Sum sum;
            for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
                sum.add(part_of_ray(ray, cuts[k], cuts[k + 1], left, known), 1.0, functions_);
            return sum;
        };
        const bool spent = depth == 0 || evaluations_ > limit_;
        const bool mixed = nodes.faced > 0 && nodes.turned_away > 0;
        if (!spent && (mixed || (ends == Ends::Unknown && turns_at_ends(ray, low, high, nodes))))
            return divided(cut_at_roots([&](double w) { return clearance_on(ray, w); }, low, high),
                           std::max(0, depth - cut_depth), Ends::Known);
        const std::array<double, 3> halves{low, 0.5 * (low + high), high};
        if (nodes.faced == 0) {
            if (!spent && depth > ray_depth / 2 && near_miss(clearances))
                return divided(halves, depth - 1, ends);
            Sum none;
            none.clearance = *std::max_element(clearances.begin(), clearances.end());
            return none;
        }
        const Sum sum = rule_sum(nodes);
        if (sum.error <= ray_share * tolerance_ * sum.size || spent) return sum;
        return divided(halves, depth - 1, Ends::Known);
    }

    Sum rule_sum(const Nodes& nodes) {
        Sum sum;
        std::array<double, most_functions> phi, difference{};
        for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
            sum.clearance = std::max(sum.clearance, nodes.clearances[i]);
            if (!(nodes.kernels[i] > 0.0) || (sees_ && !sees_(nodes.points[i].position))) continue;
            b_.basis.evaluate(nodes.points[i].parameter, phi);
            const double weight = rule_.weights[i] * nodes.kernels[i];
            const double gauss = (rule_.weights[i] - rule_.gauss_weights[i]) * nodes.kernels[i];
            for (std::size_t l = 0; l < functions_; ++l) {
                sum.values[l] += weight * phi[l];
                difference[l] += gauss * phi[l];
            }
            sum.size += weight * norm(std::span(phi).first(functions_));
        }
        sum.error = geometry::kronrod_error(norm(std::span(difference).first(functions_)), sum.size);
        return sum;
    }

    Sum along_ray(const Ray& ray) {
        const double high = ray.grading.inverse(1.0);
        const auto parts = static_cast<int>(std::ceil(high / longest_interval));
        Sum sum;
        for (int k = 0; k < parts; ++k)
            sum.add(part_of_ray(ray, high * k / parts, high * (k + 1) / parts, ray_depth, Ends::Unknown), 1.0,
                    functions_);
        return sum;
    }

    // Adds a part of a fan, halved while none of its rays sees anything but some nearly do.
    void add_panel(std::size_t f, double low, double high, int depth) {
        const Fan& fan = fans_[f];
        Panel panel{f, low, high, {}, made_++};
        std::array<double, most_nodes> clearances;
        std::array<double, most_functions> difference{};
        const std::size_t nodes = rule_.nodes.size();
        for (std::size_t i = 0; i < nodes; ++i) {
            const double w = 0.5 * (low + high + (high - low) * rule_.nodes[i]);
            const double scale = 0.5 * (high - low) * fan.grading.slope(w);
            const Sum ray = along_ray(ray_at(fan, fan.grading.at(w)));
            panel.sum.add(ray, rule_.weights[i] * scale, functions_);
            for (std::size_t l = 0; l < functions_; ++l)
                difference[l] += (rule_.weights[i] - rule_.gauss_weights[i]) * scale * ray.values[l];
            clearances[i] = ray.clearance;
        }
        panel.sum.error +=
            geometry::kronrod_error(norm(std::span(difference).first(functions_)), panel.sum.size);
        if (!(panel.sum.size > 0.0)) {
            if (depth == 0 || !near_miss(std::span(clearances).first(nodes))) return;
            const double middle = 0.5 * (low + high);
            add_panel(f, low, middle, depth - 1);
            add_panel(f, middle, high, depth - 1);
            return;
        }
        panels_.push_back(panel);
        std::push_heap(panels_.begin(), panels_.end(), LessError());
    }

    // Divides a fan where a horizon meets its outer side, for there the integral over rays has a kink.
    void start_fan(std::size_t f) {
        const Fan& fan = fans_[f];
        const double low = fan.grading.inverse(0.0), high = fan.grading.inverse(1.0);
        const auto parts = std::max(1, static_cast<int>(std::ceil((high - low) / longest_interval)));
        for (int k = 0; k < parts; ++k) {
            const double a = low + (high - low) * k / parts, b = low + (high - low) * (k + 1) / parts;
            const auto cuts = cut_at_roots([&](double w) { return clearance_opposite(fans_[f], w); }, a, b);
            for (std::size_t c = 0; c + 1 < cuts.size(); ++c)
                if (cuts[c + 1] > cuts[c]) add_panel(f, cuts[c], cuts[c + 1], fan_depth);
        }
    }

    Sum total() const {
        // In the order of the heap, which is the same on every run.
        Sum sum;
        for (const Panel& panel : panels_) sum.add(panel.sum, 1.0, functions_);
        return sum;
    }

    Panel take_worst() {
        std::pop_heap(panels_.begin(), panels_.end(), LessError());
        Panel worst = panels_.back();
        panels_.pop_back();
        return worst;
    }

    Vec3 x_, normal_;
    const ElementShape& b_;
    double tolerance_;
    std::size_t limit_;
    const SeesPoint& sees_;
    const KronrodRule& rule_;
    std::size_t functions_;
    double rounding_; ///< heights above a horizon below this are rounding [m]
    std::vector<Fan> fans_;
    std::vector<Panel> panels_; ///< a heap: the one of the largest error in front
    std::size_t evaluations_ = 0, made_ = 0;
};

} // namespace

double curved_irradiance(const Vec3& x, const Vec3& normal, const ElementShape& b, double tolerance,
                         std::span<double> values, const SeesPoint& sees) {
    const Sum sum = CurvedIntegral(x, normal, b, tolerance, sees).integrate();
    std::copy_n(sum.values.begin(), values.size(), values.begin());
    return sum.error;
}

} // namespace kinelux::kernel
