// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/read_scene.h"
#include "io/temporary_folder.h"

namespace kinelux::io {

// Two unit squares, "floor" with material "wood" and "shelf" without one; the third group is a closed tetrahedron.
inline constexpr const char* mesh_text = "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n"
                                         "g floor\nusemtl wood\nf 1 2 3 4\ng shelf\nusemtl glass\nf 4 3 2 1\n"
                                         "g block\nf 1 3 2\nf 1 2 5\nf 1 5 3\nf 2 3 5\n";

class ReadSceneTest : public testing::Test {
protected:
    ReadSceneTest() {
        put("room.obj", mesh_text);
        put("room.mtl", "newmtl wood\nKd 0.3 0.2 0.1\nKe 1 2 3\nnewmtl glass\nKd 0.1 0.1 0.1\n");
    }
    void put(const std::string& name, const std::string& text) const {
        support::put_bytes(folder.path() / name, text);
    }
    model::Scene read(const std::string& text, bool allow_outside = false) const {
        put("scene.toml", text);
        return read_scene(folder.path() / "scene.toml", {allow_outside});
    }
    // "scene.toml:line: text" or whatever was thrown.
    std::string message_of(const std::string& text) const {
        try {
            read(text);
        } catch (const core::Error& error) {
            std::string message = error.what();
            const std::string prefix = folder.path().string() + "/";
            for (std::size_t at; (at = message.find(prefix)) != std::string::npos;)
                message.erase(at, prefix.size());
            return message;
        }
        return "nothing thrown";
    }
    static void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
    }

    support::TemporaryFolder folder;
};

inline const std::string head = "format = 1\n";
inline const std::string floor_object =
    "[[object]]\nname = \"floor\"\nmesh = \"room.obj\"\ngroup = \"floor\"\n";

} // namespace kinelux::io
