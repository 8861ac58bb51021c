// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/quadrature.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

using Rule = std::vector<TriangleNode>;

void add_centroid(Rule& rule, double weight) { rule.push_back({{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}, weight}); }

// The orbit of (1 - 2a, a, a): three nodes of equal weight.
void add_triple(Rule& rule, double a, double weight) {
    const double b = 1.0 - 2.0 * a;
    rule.push_back({{b, a, a}, weight});
    rule.push_back({{a, b, a}, weight});
    rule.push_back({{a, a, b}, weight});
}

// The orbit of (a, b, 1 - a - b): six nodes of equal weight.
void add_sextuple(Rule& rule, double a, double b, double weight) {
    const double c = 1.0 - a - b;
    for (const auto& [x, y, z] : {std::array{a, b, c}, {b, c, a}, {c, a, b}, {b, a, c}, {a, c, b}, {c, b, a}})
        rule.push_back({{x, y, z}, weight});
}

Rule dunavant(int degree) {
    Rule rule;
    if (degree <= 1) {
        add_centroid(rule, 1.0);
    } else if (degree == 2) {
        add_triple(rule, 1.0 / 6.0, 1.0 / 3.0);
    } else if (degree <= 4) {
        add_triple(rule, 0.445948490915965, 0.223381589678011);
        add_triple(rule, 0.091576213509771, 0.109951743655322);
    } else if (degree == 5) {
        add_centroid(rule, 0.225);
        add_triple(rule, 0.470142064105115, 0.132394152788506);
        add_triple(rule, 0.101286507323456, 0.125939180544827);
    } else if (degree == 6) {
        add_triple(rule, 0.249286745170910, 0.116786275726379);
        add_triple(rule, 0.063089014491502, 0.050844906370207);
        add_sextuple(rule, 0.053145049844817, 0.310352451033784, 0.082851075618374);
    } else {
        add_centroid(rule, 0.144315607677787);
        add_triple(rule, 0.459292588292723, 0.095091634267285);
        add_triple(rule, 0.170569307751760, 0.103217370534718);
        add_triple(rule, 0.050547228317031, 0.032458497623198);
        add_sextuple(rule, 0.008394777409958, 0.263112829634638, 0.027230314174435);
    }
    return rule;
}

// Gauss products on the square, collapsed to the triangle by (s, t) -> (s, (1 - s) t).
Rule collapsed_gauss(int degree) {
    const GaussRule& gauss = gauss_rule(degree / 2 + 2);
    Rule rule;
    for (std::size_t i = 0; i < gauss.nodes.size(); ++i)
        for (std::size_t j = 0; j < gauss.nodes.size(); ++j) {
            const double s = gauss.nodes[i];
            const double t = (1.0 - s) * gauss.nodes[j];
            rule.push_back({{1.0 - s - t, s, t}, 2.0 * (1.0 - s) * gauss.weights[i] * gauss.weights[j]});
        }
    return rule;
}

// Roots of the Legendre polynomial by Newton from Chebyshev's guess.
GaussRule make_gauss(int n) {
    GaussRule rule;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
        double derivative = 0.0;
        for (int step = 0; step < 100; ++step) {
            double previous = 1.0, value = x;
            for (int k = 2; k <= n; ++k)
                previous = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * previous) / k);
            derivative = n * (x * value - previous) / (x * x - 1.0);
            const double change = value / derivative;
            x -= change;
            if (std::abs(change) < 1e-16) break;
        }
        rule.nodes.push_back(0.5 * (1.0 - x));
        rule.weights.push_back(1.0 / ((1.0 - x * x) * derivative * derivative));
    }
    return rule;
}

} // namespace

std::span<const TriangleNode> triangle_rule(int degree) {
    constexpr int table_size = 33;
    static const std::vector<Rule> table = [] {
        std::vector<Rule> rules;
        rules.reserve(table_size);
        for (int d = 0; d < table_size; ++d) rules.push_back(d <= 8 ? dunavant(d) : collapsed_gauss(d));
        return rules;
    }();
    if (degree < 0 || degree >= table_size)
        throw core::GeometryError("a triangle rule of degree " + std::to_string(degree) +
                                  " was asked for; 0 to 32 exist");
    return table[static_cast<std::size_t>(degree)];
}

const GaussRule& gauss_rule(int n) {
    constexpr int table_size = 33;
    static const std::vector<GaussRule> table = [] {
        std::vector<GaussRule> rules(1);
        for (int k = 1; k < table_size; ++k) rules.push_back(make_gauss(k));
        return rules;
    }();
    if (n < 1 || n >= table_size)
        throw core::GeometryError("a Gauss rule of " + std::to_string(n) +
                                  " nodes was asked for; 1 to 32 exist");
    return table[static_cast<std::size_t>(n)];
}

} // namespace kinelux::geometry
