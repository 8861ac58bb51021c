// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/convex_pieces.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace kinelux::visibility {

namespace {

constexpr double straight = 1e-12; ///< sine of a turn that counts as none

using Corners = std::vector<std::uint32_t>;

std::size_t position_of(const Corners& corners, std::uint32_t corner) {
    return static_cast<std::size_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
}

// The boundary of two neighbours without the edge a -> b of the first, b -> a of the second.
Corners joined(Corners first, Corners second, std::uint32_t a, std::uint32_t b) {
    std::rotate(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(position_of(first, b)),
                first.end()); // b ... a
    std::rotate(second.begin(), second.begin() + static_cast<std::ptrdiff_t>(position_of(second, a)),
                second.end()); // a ... b
    first.insert(first.end(), second.begin() + 1, second.end() - 1);
    return first;
}

bool has_edge(const Corners& corners, std::uint32_t a, std::uint32_t b) {
    const std::size_t at = position_of(corners, a);
    return at < corners.size() && corners[(at + 1) % corners.size()] == b;
}

std::vector<Vec3> places(std::span<const Vec3> points, const Corners& corners) {
    std::vector<Vec3> loop;
    for (const std::uint32_t corner : corners) loop.push_back(points[corner]);
    return loop;
}

// Pieces that grow by joining; a piece that has been taken up by another points to it.
class Pieces {
public:
    explicit Pieces(std::span<const model::Triangle> triangles) : owner_(triangles.size()) {
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            owner_[t] = t;
            corners_.emplace_back(triangles[t].begin(), triangles[t].end());
        }
    }
    std::size_t owner(std::size_t piece) const {
        while (owner_[piece] != piece) piece = owner_[piece];
        return piece;
    }
    const std::vector<Corners>& corners() const { return corners_; }
    void join(std::size_t first, std::size_t second, Corners corners) {
        owner_[second] = first;
        corners_[first] = std::move(corners);
        corners_[second].clear();
    }

private:
    std::vector<std::size_t> owner_;
    std::vector<Corners> corners_;
};

} // namespace

Loops3 convex_pieces(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                     const Vec3& normal) {
    Pieces pieces(triangles);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> open;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = triangles[t][c], b = triangles[t][(c + 1) % 3];
            open.emplace(std::pair(a, b), t);
            const auto opposite = open.find({b, a});
            if (opposite == open.end()) continue;
            const std::size_t first = pieces.owner(t), second = pieces.owner(opposite->second);
            if (first == second || !has_edge(pieces.corners()[first], a, b) ||
                !has_edge(pieces.corners()[second], b, a))
                continue;
            Corners whole = joined(pieces.corners()[first], pieces.corners()[second], a, b);
            if (is_convex(places(points, whole), normal, straight))
                pieces.join(first, second, std::move(whole));
        }
    Loops3 result;
    for (const Corners& corners : pieces.corners())
        if (!corners.empty()) result.add(places(points, corners));
    return result;
}

} // namespace kinelux::visibility
