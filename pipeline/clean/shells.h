// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "clean/parts.h"
#include "clean/work_mesh.h"
#include "model/scene.h"

namespace kinelux::clean {

/// Parts that make up one surface; most have a single member.
struct Shell {
    struct Member {
        std::size_t object = 0;
        const Part* part = nullptr;
    };
    std::vector<Member> members;
    bool closed = false;
};

/// Turns a part over and notes it.
void flip(WorkMesh& work, const Part& part);

/// Joins open parts of Auto materials that move together and whose boundary edges cover each other, such as the floor,
/// walls and ceiling of a room that are objects of their own. Members of a joined shell are flipped to agree.
/// All other parts are shells by themselves. In order of first members.
/// @param tolerance  points and edges nearer than this lie on each other [m]
std::vector<Shell> find_shells(const model::Scene& scene, const std::vector<std::vector<Part>>& parts,
                               std::vector<WorkMesh>& meshes, double tolerance);

} // namespace kinelux::clean
