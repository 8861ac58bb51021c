// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "closed_form_cases.h"
#include "support/closed_forms.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::validation {

namespace {

using Patches = std::vector<model::Patch>;
using std::numbers::pi;

constexpr double exact = 1e-6; // relative, what is asked for at 1e-6

model::Surface round(model::SurfaceType type, double radius, double orientation) {
    model::Surface s;
    s.type = type;
    s.radius = radius;
    s.orientation = orientation;
    return s;
}

// Octants of a sphere about the origin. @param orientation  -1: seen from inside
Patches sphere(double radius, double orientation, const Vec3& centre = Vec3(0.0)) {
    Patches octants;
    model::Surface s = round(model::SurfaceType::Sphere, radius, orientation);
    s.origin = centre;
    for (int i = 0; i < 4; ++i)
        for (const double v : {-0.5 * pi, 0.0})
            octants.push_back(
                support::surface_patch(s, {0.5 * pi * i, v}, {0.5 * pi * (i + 1), v + 0.5 * pi}));
    return octants;
}

// Quarters of the inside of a cylinder's wall.
Patches wall(double radius, double height) {
    Patches quarters;
    const model::Surface s = round(model::SurfaceType::Cylinder, radius, -1.0);
    for (int i = 0; i < 4; ++i)
        quarters.push_back(support::surface_patch(s, {0.5 * pi * i, 0.0}, {0.5 * pi * (i + 1), height}));
    return quarters;
}

Patches disc(double radius, double height, double facing) {
    Patches quarters;
    for (int i = 0; i < 4; ++i) quarters.push_back(support::quarter_disc(radius, height, i, facing));
    return quarters;
}

// From some patches to others with nothing in between.
ClosedFormCase open_case(std::string name, std::string source, double expected, Patches from,
                         const Patches& to) {
    ClosedFormCase item{std::move(name), std::move(source), {}, expected, exact};
    item.group_of.assign(from.size(), 0);
    item.to = to.empty() ? 0 : 1;
    item.group_of.insert(item.group_of.end(), to.size(), 1);
    from.insert(from.end(), to.begin(), to.end());
    for (std::size_t p = 0; p < from.size(); ++p) from[p].object = ObjectId(p);
    item.set.patches = std::move(from);
    item.open = true;
    return item;
}

void add_spheres(std::vector<ClosedFormCase>& cases) {
    constexpr double inner = 0.4;
    cases.push_back(open_case("octant of a sphere to a concentric one of 0.4 of its radius inside",
                              "Howell C-135", support::outer_sphere_to_inner(inner, 1.0),
                              {sphere(1.0, -1.0)[1]}, sphere(inner, 1.0)));
    cases.push_back(open_case("octant of the inner sphere to the outer one", "Howell C-135", 1.0,
                              {sphere(inner, 1.0)[1]}, sphere(1.0, -1.0)));
    const model::Surface inside = round(model::SurfaceType::Sphere, 1.0, -1.0);
    const model::Patch cap = support::surface_patch(inside, {0.0, 0.25 * pi}, {2.0 * pi, 0.5 * pi}),
                       zone = support::surface_patch(inside, {0.0, -0.2}, {2.0 * pi, 0.3});
    const double cap_share = 0.5 * (1.0 - std::sin(0.25 * pi)),
                 zone_share = 0.5 * (std::sin(0.3) + std::sin(0.2));
    cases.push_back(
        open_case("inside of a sphere, cap to zone", "share of the sphere", zone_share, {cap}, {zone}));
    cases.push_back(
        open_case("inside of a sphere, cap to itself", "share of the sphere", cap_share, {cap}, {}));
    constexpr double s = 1e-4;
    for (const double angle : {0.0, 0.9, 1.5}) {
        const Vec3 tilted(0.0, std::cos(angle), std::sin(angle));
        cases.push_back(open_case(
            fmt::format("element to a sphere at twice its radius, {:g} from its direction", angle),
            "Howell B-43", support::element_to_sphere(1.0, 2.0, angle),
            {support::rectangle(Vec3(-0.5 * s, 0, 0) - 0.5 * s * tilted, Vec3(s, 0, 0), s * tilted)},
            sphere(1.0, 1.0, {0, 0, 2})));
    }
    cases.push_back(open_case("sphere to a 3 x 1 rectangle at 1.2 of its radius",
                              "solid angle from the centre", support::sphere_to_rectangle(1.5, 0.5, 1.2),
                              sphere(1.0, 1.0),
                              {support::rectangle({-1.5, -0.5, 1.2}, {0, 1, 0}, {3, 0, 0})}));
}

void add_cylinders(std::vector<ClosedFormCase>& cases) {
    constexpr double height = 2.0;
    cases.push_back(open_case("inside of a cylinder as high as wide, wall to wall", "Howell C-78",
                              support::cylinder_to_itself(1.0, height), wall(1.0, height), {}));
    cases.push_back(open_case("inside of a cylinder, wall to one end", "Howell C-79",
                              support::cylinder_to_end(1.0, height), {wall(1.0, height)[0]},
                              disc(1.0, 0.0, 1.0)));
    cases.push_back(open_case("inside of a cylinder, end to end", "Howell C-41",
                              support::coaxial_discs(1.0, 1.0, height), {disc(1.0, 0.0, 1.0)[0]},
                              disc(1.0, height, -1.0)));
    cases.push_back(open_case("coaxial discs of radii 1 and 0.5 at 0.8", "Howell C-41",
                              support::coaxial_discs(1.0, 0.5, 0.8), {disc(1.0, 0.0, 1.0)[0]},
                              disc(0.5, 0.8, -1.0)));
}

} // namespace

std::vector<ClosedFormCase> curved_form_cases() {
    std::vector<ClosedFormCase> cases;
    add_spheres(cases);
    add_cylinders(cases);
    return cases;
}

} // namespace kinelux::validation
