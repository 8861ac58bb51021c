// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/quasi_monte_carlo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/sequence.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::SurfaceNode;

// Spreads points of the unit square evenly over an element's facets.
class ElementSampler {
public:
    explicit ElementSampler(const ElementShape& element) : element_(element) {
        double sum = 0.0;
        for (const geometry::Facet& facet : element.facets) shares_.push_back(sum += facet.area);
        for (double& share : shares_) share /= sum;
    }

    /// The point with its basis values; as weight the area [m2] over the density it was drawn with.
    SurfaceNode at(const Vec2& u, std::span<double> phi) const {
        const auto found = std::upper_bound(shares_.begin(), shares_.end() - 1, u.x);
        const double low = found == shares_.begin() ? 0.0 : *(found - 1), share = *found - low;
        // What choosing the facet left of the number is uniform again; the root makes it so on a triangle.
        const double root = std::sqrt(std::clamp((u.x - low) / share, 0.0, 1.0));
        const std::array<double, 3> barycentric{1.0 - root, root * (1.0 - u.y), root * u.y};
        Vec2 parameter(0.0);
        const auto& facet = element_.facets[static_cast<std::size_t>(found - shares_.begin())];
        SurfaceNode node = geometry::node_at(element_, facet, barycentric, parameter);
        node.weight /= share;
        element_.basis.evaluate(parameter, phi);
        return node;
    }

private:
    const ElementShape& element_;
    std::vector<double> shares_; ///< running sums, last = 1
};

double kernel_value(const SurfaceNode& x, const SurfaceNode& y) {
    const Vec3 r = y.position - x.position;
    const double cos_x = glm::dot(x.normal, r), cos_y = -glm::dot(y.normal, r);
    if (!(cos_x > 0.0) || !(cos_y > 0.0)) return 0.0;
    const double r2 = glm::dot(r, r);
    return cos_x * cos_y / (std::numbers::pi * r2 * r2);
}

// One repetition: the mean over its samples.
class Repetition {
public:
    Repetition(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
               const QuasiMonteCarloOptions& options)
        : xs_(a),
          ys_(b),
          occluders_(occluders),
          options_(options),
          phi_(a.basis.size()),
          psi_(b.basis.size()) {}

    std::vector<double> block(std::uint64_t seed, std::uint32_t& rays) {
        std::vector<double> values(phi_.size() * psi_.size(), 0.0);
        core::Random random(seed);
        for (std::uint32_t i = 0; i < options_.samples; ++i) {
            const std::array<double, 4> u =
                options_.points == Points::Sobol
                    ? core::sobol_4d(i, seed)
                    : std::array{random.next(), random.next(), random.next(), random.next()};
            add({u[0], u[1]}, {u[2], u[3]}, values, rays);
        }
        for (double& value : values) value /= options_.samples;
        return values;
    }

private:
    void add(const Vec2& u, const Vec2& v, std::vector<double>& values, std::uint32_t& rays) {
        const SurfaceNode x = xs_.at(u, phi_), y = ys_.at(v, psi_);
        const double value = x.weight * y.weight * kernel_value(x, y);
        if (!(value > 0.0)) return;
        if (options_.occlusion && !occluders_.empty()) {
            ++rays;
            if (occluders_.occluded(x.sight_point(), y.sight_point(), options_.occluders)) return;
        }
        for (std::size_t k = 0; k < phi_.size(); ++k)
            for (std::size_t l = 0; l < psi_.size(); ++l)
                values[k * psi_.size() + l] += value * phi_[k] * psi_[l];
    }

    ElementSampler xs_, ys_;
    const visibility::Occluders& occluders_;
    const QuasiMonteCarloOptions& options_;
    std::vector<double> phi_, psi_;
};

} // namespace

TransportBlock quasi_monte_carlo(const ElementShape& a, const ElementShape& b,
                                 const visibility::Occluders& occluders,
                                 const QuasiMonteCarloOptions& options) {
    TransportBlock block;
    if (!may_exchange(a, b)) return block;
    const std::size_t size = a.basis.size() * b.basis.size();
    block.values.assign(size, 0.0);
    std::vector<double> squares(size, 0.0);
    Repetition repetition(a, b, occluders, options);
    const std::uint64_t pair_seed = core::mix(options.seed, core::mix(a.id.value, b.id.value));
    for (std::uint32_t r = 0; r < options.scramblings; ++r) {
        const std::vector<double> values = repetition.block(core::mix(pair_seed, r), block.rays);
        // Running mean and sum of squared deviations (Welford).
        for (std::size_t k = 0; k < size; ++k) {
            const double step = values[k] - block.values[k];
            block.values[k] += step / (r + 1.0);
            squares[k] += step * (values[k] - block.values[k]);
        }
    }
    double sum = 0.0;
    for (const double square : squares) sum += square;
    const double repetitions = options.scramblings;
    block.error = std::sqrt(sum / (repetitions * (repetitions - 1.0)));
    if (std::all_of(block.values.begin(), block.values.end(), [](double value) { return value == 0.0; }))
        block.values.clear();
    return block;
}

} // namespace kinelux::kernel
