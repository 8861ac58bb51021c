// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/round_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <Eigen/Dense>
#include <unsupported/Eigen/LevenbergMarquardt>
#include <unsupported/Eigen/NumericalDiff>

namespace kinelux::fit {

namespace {

using model::Surface;
using model::SurfaceType;

// More points than this add nothing to a fit of seven numbers.
constexpr std::size_t most_points = 1500;
// A radius above this many extents of the piece is a plane's.
constexpr double flattest = 100.0;
// Beyond this a cone is a disc.
constexpr double widest_half_angle_rad = 85.0 * std::numbers::pi / 180.0;

// A point in a surface's frame: height along the axis and distance from it.
struct Profile {
    double height, radius;
};

Profile profile_of(const Surface& s, const Vec3& x) {
    const Vec3 p = x - s.origin;
    const double height = glm::dot(p, s.axis_w);
    return {height, glm::length(p - height * s.axis_w)};
}

// The least-squares circle through points of a plane (Kasa): x^2 + y^2 = 2 cx x + 2 cy y + d.
struct Circle {
    double x, y, radius;
};

std::optional<Circle> circle_through(const std::vector<Vec2>& points) {
    Eigen::MatrixXd left(static_cast<Eigen::Index>(points.size()), 3);
    Eigen::VectorXd right(left.rows());
    for (Eigen::Index i = 0; i < left.rows(); ++i) {
        const Vec2& p = points[static_cast<std::size_t>(i)];
        left.row(i) << 2.0 * p.x, 2.0 * p.y, 1.0;
        right[i] = glm::dot(p, p);
    }
    const Eigen::Vector3d c = left.colPivHouseholderQr().solve(right);
    const double square = c[2] + c[0] * c[0] + c[1] * c[1];
    if (!(square > 0.0)) return std::nullopt;
    return Circle{c[0], c[1], std::sqrt(square)};
}

std::optional<Surface> first_sphere(std::span<const Vec3> points) {
    Eigen::MatrixXd left(static_cast<Eigen::Index>(points.size()), 4);
    Eigen::VectorXd right(left.rows());
    for (Eigen::Index i = 0; i < left.rows(); ++i) {
        const Vec3& p = points[static_cast<std::size_t>(i)];
        left.row(i) << 2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0;
        right[i] = glm::dot(p, p);
    }
    const Eigen::Vector4d c = left.colPivHouseholderQr().solve(right);
    Surface s;
    s.type = SurfaceType::Sphere;
    s.origin = {c[0], c[1], c[2]};
    const double square = c[3] + glm::dot(s.origin, s.origin);
    if (!(square > 0.0)) return std::nullopt;
    s.radius = std::sqrt(square);
    return s;
}

std::optional<Surface> first_cylinder(std::span<const Vec3> points, std::span<const FaceSample> samples) {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const FaceSample& sample : samples) {
        const Eigen::Vector3d n(sample.normal.x, sample.normal.y, sample.normal.z);
        spread += sample.area * n * n.transpose();
    }
    const Eigen::Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
    Surface s;
    s.type = SurfaceType::Cylinder;
    set_axis(s, {axis[0], axis[1], axis[2]});
    std::vector<Vec2> across;
    for (const Vec3& p : points) across.push_back({glm::dot(p, s.axis_u), glm::dot(p, s.axis_v)});
    const auto circle = circle_through(across);
    if (!circle) return std::nullopt;
    s.origin = circle->x * s.axis_u + circle->y * s.axis_v;
    s.radius = circle->radius;
    return s;
}

// The line that all normals meet best: the least of sum (n . m + (x cross n) . a)^2 over directions a, where m is the
// line's moment; origin is its point nearest to 0.
Surface revolution_axis(std::span<const FaceSample> samples) {
    Eigen::Matrix3d aa = Eigen::Matrix3d::Zero(), am = aa, mm = aa;
    for (const FaceSample& sample : samples) {
        const Vec3 c = glm::cross(sample.position, sample.normal);
        const Eigen::Vector3d a(c.x, c.y, c.z), m(sample.normal.x, sample.normal.y, sample.normal.z);
        aa += sample.area * a * a.transpose();
        am += sample.area * a * m.transpose();
        mm += sample.area * m * m.transpose();
    }
    const Eigen::Matrix3d from_a = mm.completeOrthogonalDecomposition().solve(am.transpose());
    const Eigen::Matrix3d rest = aa - am * from_a;
    const Eigen::Vector3d a =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(0.5 * (rest + rest.transpose())).eigenvectors().col(0);
    const Eigen::Vector3d m = -from_a * a;
    Surface s;
    set_axis(s, {a[0], a[1], a[2]});
    s.origin = glm::cross(s.axis_w, Vec3{m[0], m[1], m[2]});
    return s;
}

std::optional<Surface> first_cone(Surface s, std::span<const Vec3> points) {
    s.type = SurfaceType::Cone;
    double n = 0.0, h = 0.0, r = 0.0, hh = 0.0, hr = 0.0;
    for (const Vec3& x : points) {
        const Profile p = profile_of(s, x);
        n += 1.0;
        h += p.height;
        r += p.radius;
        hh += p.height * p.height;
        hr += p.height * p.radius;
    }
    const double spread = n * hh - h * h;
    if (!(spread > 0.0)) return std::nullopt;
    const double slope = (n * hr - h * r) / spread;
    s.half_angle_rad = std::atan(slope);
    s.radius = (r - slope * h) / n;
    return s;
}

std::optional<Surface> first_torus(Surface s, std::span<const Vec3> points) {
    s.type = SurfaceType::Torus;
    std::vector<Vec2> profile;
    for (const Vec3& x : points) {
        const Profile p = profile_of(s, x);
        profile.push_back({p.radius, p.height});
    }
    const auto circle = circle_through(profile);
    if (!circle) return std::nullopt;
    s.radius = circle->x;
    s.minor_radius = circle->radius;
    s.origin += circle->y * s.axis_w;
    return s;
}

// Distances of points as a function of what may change in a surface: its origin, the tilt of its axis, two sizes.
struct Distances : Eigen::DenseFunctor<double> {
    Distances(const Surface& s, std::span<const Vec3> p)
        : Eigen::DenseFunctor<double>(7, static_cast<int>(p.size())), start(s), points(p) {}

    Surface changed(const InputType& by) const {
        Surface s = start;
        s.origin += Vec3{by[0], by[1], by[2]};
        if (s.type != SurfaceType::Sphere)
            set_axis(s, start.axis_w + by[3] * start.axis_u + by[4] * start.axis_v);
        s.radius += by[5];
        if (s.type == SurfaceType::Torus) s.minor_radius += by[6];
        if (s.type == SurfaceType::Cone) s.half_angle_rad += by[6];
        return s;
    }
    int operator()(const InputType& by, ValueType& distances) const {
        const Surface s = changed(by);
        for (std::size_t i = 0; i < points.size(); ++i)
            distances[static_cast<Eigen::Index>(i)] = signed_distance(s, points[i]);
        return 0;
    }

    const Surface& start;
    std::span<const Vec3> points;
};

Surface settled(const Surface& first, std::span<const Vec3> points) {
    if (points.size() < 7) return first;
    using Differenced = Eigen::NumericalDiff<Distances, Eigen::Central>;
    Differenced distances(Distances(first, points));
    Eigen::LevenbergMarquardt<Differenced> search(distances);
    Eigen::VectorXd by = Eigen::VectorXd::Zero(7);
    search.minimize(by);
    return distances.changed(by);
}

bool usable(const Surface& s) {
    const double sum = s.radius + s.minor_radius + s.half_angle_rad + glm::dot(s.origin, Vec3{1.0});
    if (!std::isfinite(sum) || std::abs(s.radius) > flattest || !(s.minor_radius >= 0.0)) return false;
    if (s.type == SurfaceType::Cone) return std::abs(s.half_angle_rad) < widest_half_angle_rad;
    return s.radius > s.minor_radius;
}

// Coordinates in which the piece lies about 0 and has size 1.
struct Unit {
    Vec3 centre{0.0};
    double size = 1.0;

    explicit Unit(std::span<const Vec3> points) {
        Vec3 low = points.front(), high = low;
        for (const Vec3& p : points) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        centre = 0.5 * (low + high);
        size = glm::length(high - low);
    }
    Vec3 to(const Vec3& x) const { return (x - centre) / size; }
    Surface back(Surface s) const {
        s.origin = centre + size * s.origin;
        s.radius *= size;
        s.minor_radius *= size;
        return s;
    }
};

} // namespace

void set_axis(Surface& s, const Vec3& axis) {
    s.axis_w = glm::normalize(axis);
    const Vec3 size = glm::abs(s.axis_w);
    const Vec3 other = size.x > 0.9 ? Vec3{0.0, 1.0, 0.0} : Vec3{1.0, 0.0, 0.0};
    s.axis_u = glm::normalize(glm::cross(other, s.axis_w));
    s.axis_v = glm::cross(s.axis_w, s.axis_u);
}

double signed_distance(const Surface& s, const Vec3& x) {
    const Profile p = profile_of(s, x);
    switch (s.type) {
    case SurfaceType::Sphere: return std::hypot(p.radius, p.height) - s.radius;
    case SurfaceType::Torus: return std::hypot(p.radius - s.radius, p.height) - s.minor_radius;
    default:
        return (p.radius - s.radius - p.height * std::tan(s.half_angle_rad)) * std::cos(s.half_angle_rad);
    }
}

Vec2 round_parameters(const Surface& s, const Vec3& x) {
    const Profile p = profile_of(s, x);
    const Vec3 offset = x - s.origin;
    const double u = std::atan2(glm::dot(offset, s.axis_v), glm::dot(offset, s.axis_u));
    switch (s.type) {
    case SurfaceType::Sphere: return {u, std::atan2(p.height, p.radius)};
    case SurfaceType::Torus: return {u, std::atan2(p.height, p.radius - s.radius)};
    default: return {u, p.height + signed_distance(s, x) * std::sin(s.half_angle_rad)};
    }
}

std::vector<Surface> nearest_round_surfaces(std::span<const Vec3> points,
                                            std::span<const FaceSample> samples) {
    const Unit unit(points);
    std::vector<Surface> result;
    if (!(unit.size > 0.0)) return result;
    std::vector<Vec3> scaled;
    const std::size_t stride = (points.size() + most_points - 1) / most_points;
    for (std::size_t i = 0; i < points.size(); i += stride) scaled.push_back(unit.to(points[i]));
    std::vector<FaceSample> turned;
    for (const FaceSample& s : samples) turned.push_back({unit.to(s.position), s.normal, s.area});

    const Surface axis = revolution_axis(turned);
    for (const std::optional<Surface>& first : {first_cylinder(scaled, turned), first_sphere(scaled),
                                                first_cone(axis, scaled), first_torus(axis, scaled)}) {
        if (!first || !usable(*first)) continue;
        const Surface s = settled(*first, scaled);
        if (usable(s)) result.push_back(unit.back(s));
    }
    return result;
}

} // namespace kinelux::fit
