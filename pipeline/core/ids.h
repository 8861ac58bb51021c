// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace kinelux {

/// An index that cannot be mistaken for another kind of index.
template <class Tag>
struct Id {
    std::uint32_t value = 0;

    constexpr Id() = default;
    template <class Integer>
    constexpr explicit Id(Integer index) : value(static_cast<std::uint32_t>(index)) {}
    constexpr auto operator<=>(const Id&) const = default;
};

using MaterialId = Id<struct MaterialTag>; ///< into model::Scene::materials
using ObjectId = Id<struct ObjectTag>;     ///< into model::Scene::objects
using MotionId = Id<struct MotionTag>;     ///< into model::Scene::motions
using DimmingId = Id<struct DimmingTag>;   ///< into model::Scene::dimmings
using PatchId = Id<struct PatchTag>;       ///< into model::PatchSet::patches
using ClusterId = Id<struct ClusterTag>;   ///< into model::ClusterTree::clusters
using ElementId = Id<struct ElementTag>;   ///< into model::ClusterTree::elements

} // namespace kinelux

template <class Tag>
struct std::hash<kinelux::Id<Tag>> {
    std::size_t operator()(kinelux::Id<Tag> id) const noexcept {
        return std::hash<std::uint32_t>{}(id.value);
    }
};
