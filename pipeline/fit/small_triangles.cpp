// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/small_triangles.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace kinelux::fit {

namespace {

using Corners = std::array<Vec3, 3>;

// The same bits from both ends: addition commutes.
Vec3 midpoint(const Vec3& a, const Vec3& b) { return 0.5 * (a + b); }

// Halves edges that are too long. Which edges are halved depends on the edges alone, so neighbours agree.
std::vector<Corners> refined(const Corners& face, double longest_edge) {
    std::vector<Corners> open{face}, done;
    while (!open.empty()) {
        Corners t = open.back();
        open.pop_back();
        std::array<bool, 3> long_edge{};
        int count = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            long_edge[k] = glm::distance(t[k], t[(k + 1) % 3]) > longest_edge;
            count += long_edge[k] ? 1 : 0;
        }
        if (count == 0) {
            done.push_back(t);
            continue;
        }
        // Turned so that edge 0 is the only long one, or edge 2 the only short one.
        while (count == 1 ? !long_edge[0] : (count == 2 && long_edge[2])) {
            t = {t[1], t[2], t[0]};
            long_edge = {long_edge[1], long_edge[2], long_edge[0]};
        }
        const Vec3 m0 = midpoint(t[0], t[1]), m1 = midpoint(t[1], t[2]), m2 = midpoint(t[2], t[0]);
        if (count == 1) {
            open.push_back({t[0], m0, t[2]});
            open.push_back({m0, t[1], t[2]});
        } else if (count == 2) {
            open.push_back({m0, t[1], m1});
            const bool first_diagonal = glm::distance(t[0], m1) <= glm::distance(m0, t[2]);
            open.push_back(first_diagonal ? Corners{t[0], m0, m1} : Corners{t[0], m0, t[2]});
            open.push_back(first_diagonal ? Corners{t[0], m1, t[2]} : Corners{m0, m1, t[2]});
        } else {
            open.push_back({t[0], m0, m2});
            open.push_back({m0, t[1], m1});
            open.push_back({m2, m1, t[2]});
            open.push_back({m0, m1, m2});
        }
    }
    return done;
}

} // namespace

void add_small_triangles(const Body& body, const Chart& chart, double longest_edge,
                         model::SmallTriangles& small) {
    std::map<std::tuple<double, double, double>, std::uint32_t> number;
    const auto point = [&](const Vec3& x) {
        const auto [at, fresh] =
            number.try_emplace({x.x, x.y, x.z}, static_cast<std::uint32_t>(small.points.size()));
        if (fresh) small.points.push_back(x);
        return at->second;
    };
    const auto add = [&](const model::Triangle& triangle) {
        small.triangles.push_back(triangle);
        small.objects.push_back(body.object);
        small.materials.push_back(chart.material);
    };
    for (const std::uint32_t f : chart.faces) {
        const model::Triangle& t = body.faces[f].corners;
        for (const Corners& piece :
             refined({body.points[t[0]], body.points[t[1]], body.points[t[2]]}, longest_edge)) {
            const model::Triangle triangle{point(piece[0]), point(piece[1]), point(piece[2])};
            add(triangle);
            if (chart.two_sided) add({triangle[0], triangle[2], triangle[1]});
        }
    }
}

} // namespace kinelux::fit
