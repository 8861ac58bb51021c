// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/closed_forms.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace kinelux::support {

namespace {

constexpr double pi = std::numbers::pi;

// Double antiderivative of a corner pair of parallel rectangles: distances along u and v, and apart.
double parallel_corner(double u, double v, double c) {
    const double pu = std::hypot(u, c), pv = std::hypot(v, c);
    return u * pv * std::atan(u / pv) + v * pu * std::atan(v / pu) -
           0.5 * c * c * std::log(u * u + v * v + c * c);
}

// The same of perpendicular rectangles: distance along the common line, distances of both corners from it.
double perpendicular_corner(double u, double x, double y) {
    const double k = std::hypot(x, y);
    const double angle = u == 0.0 ? 0.0 : u * k * std::atan2(u, k);
    const double r2 = u * u + k * k;
    return r2 == 0.0 ? 0.0 : angle + 0.25 * (u * u - k * k) * std::log(r2);
}

// Sums sign * corner(...) over the corners of both rectangles.
double corner_sum(const Extent& from, const Extent& to,
                  const std::function<double(double, double, double)>& corner) {
    const std::array<double, 2> u1{from.low_u, from.high_u}, v1{from.low_v, from.high_v};
    const std::array<double, 2> u2{to.low_u, to.high_u}, v2{to.low_v, to.high_v};
    double sum = 0.0;
    for (int i = 0; i < 16; ++i) {
        const int a = i & 1, b = (i >> 1) & 1, c = (i >> 2) & 1, d = i >> 3;
        sum += ((a + b + c + d) % 2 == 0 ? 1.0 : -1.0) * corner(u2[b] - u1[a], v1[c], v2[d]);
    }
    return sum;
}

// Gauss and Kronrod, 7 and 15 points, bisected until both agree. Nodes and weights from QUADPACK's qk15.
double adaptive(const std::function<double(double)>& f, double low, double high, double tolerance,
                int depth = 0) {
    static constexpr std::array<double, 8> nodes{
        0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
        0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
        0.586087235467691130294144691693937, 0.405845151377397166906606412076961,
        0.207784955007898467600689403773245, 0.0};
    static constexpr std::array<double, 8> kronrod{
        0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
        0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
        0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
        0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
    static constexpr std::array<double, 4> gauss{
        0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
        0.381830050505118944950369775488975, 0.417959183673469387755102040816327};
    const double centre = 0.5 * (low + high), half = 0.5 * (high - low);
    double coarse = 0.0, fine = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        const double value = i == 7 ? f(centre) : f(centre - half * nodes[i]) + f(centre + half * nodes[i]);
        fine += kronrod[i] * value;
        if (i % 2 == 1) coarse += gauss[i / 2] * value;
    }
    constexpr int most_bisections = 60;
    if (std::abs(fine - coarse) * half <= tolerance || depth == most_bisections) return fine * half;
    return adaptive(f, low, centre, tolerance, depth + 1) + adaptive(f, centre, high, tolerance, depth + 1);
}

} // namespace

double parallel_equal_rectangles(double a, double b, double c) {
    const double x = a / c, y = b / c, x2 = 1.0 + x * x, y2 = 1.0 + y * y;
    return 2.0 / (pi * x * y) *
           (0.5 * std::log(x2 * y2 / (x2 + y2 - 1.0)) + x * std::sqrt(y2) * std::atan(x / std::sqrt(y2)) +
            y * std::sqrt(x2) * std::atan(y / std::sqrt(x2)) - x * std::atan(x) - y * std::atan(y));
}

double parallel_rectangles(const Extent& from, const Extent& to, double c) {
    const double sum =
        corner_sum(from, to, [&](double u, double v1, double v2) { return parallel_corner(u, v2 - v1, c); });
    return sum / (2.0 * pi * from.area());
}

double perpendicular_rectangles_common_edge(double l, double w, double h) {
    const double x = h / l, y = w / l, x2 = x * x, y2 = y * y, z2 = x2 + y2, z = std::sqrt(z2);
    const double logs = std::log((1.0 + y2) * (1.0 + x2) / (1.0 + z2)) +
                        y2 * std::log(y2 * (1.0 + z2) / ((1.0 + y2) * z2)) +
                        x2 * std::log(x2 * (1.0 + z2) / ((1.0 + x2) * z2));
    return (y * std::atan(1.0 / y) + x * std::atan(1.0 / x) - z * std::atan(1.0 / z) + 0.25 * logs) /
           (pi * y);
}

double perpendicular_rectangles(const Extent& from, const Extent& to) {
    return corner_sum(from, to, perpendicular_corner) / (2.0 * pi * from.area());
}

double hinged_rectangles(double l, double a, double b, double angle) {
    // Points at s and r from the common edge, p^2 = s^2 + r^2 - 2 s r cos(angle): along the edge the kernel
    // s r sin^2(angle) / (pi (p^2 + (u - v)^2)^2) integrates to s r sin^2(angle) l atan(l / p) / (pi p^3). With
    // s = q cos t, r = q sin t, p = q m(t), the integral over q is closed: `primitive`. The one over t is left.
    const double sine2 = std::sin(angle) * std::sin(angle), half_sine = std::sin(0.5 * angle);
    // The integral of atan(1/x) from 0, x = q m / l.
    const auto primitive = [](double x) { return x * std::atan2(1.0, x) + 0.5 * std::log1p(x * x); };
    const auto along = [&](double t) {
        const double c = std::cos(t), s = std::sin(t);
        const double m2 = (c - s) * (c - s) + 4.0 * s * c * half_sine * half_sine;
        const double m = std::sqrt(m2), reach = std::min(a / c, b / s);
        return s * c * sine2 / (m2 * m2) * l * l * primitive(reach * m / l);
    };
    const double corner = std::atan2(b, a), middle = 0.25 * pi;
    const double low = std::min(corner, middle), high = std::max(corner, middle);
    constexpr double tolerance = 1e-15;
    return (adaptive(along, 0.0, low, tolerance) + adaptive(along, low, high, tolerance) +
            adaptive(along, high, 0.5 * pi, tolerance)) /
           (pi * l * a);
}

double coaxial_discs(double r1, double r2, double h) {
    const double x = 1.0 + (h * h + r2 * r2) / (r1 * r1), ratio = r2 / r1;
    // (x - sqrt(x^2 - 4 ratio^2)) / 2 without its cancellation for small or distant discs.
    return 2.0 * ratio * ratio / (x + std::sqrt(x * x - 4.0 * ratio * ratio));
}

double outer_sphere_to_inner(double r1, double r2) { return r1 * r1 / (r2 * r2); }
double outer_sphere_to_itself(double r1, double r2) { return 1.0 - outer_sphere_to_inner(r1, r2); }

double cylinder_to_itself(double r, double h) {
    const double x = h / (2.0 * r);
    return 1.0 + x - std::sqrt(1.0 + x * x);
}

double cylinder_to_end(double r, double h) {
    const double x = h / (2.0 * r);
    return 0.5 * (std::sqrt(1.0 + x * x) - x);
}

double infinite_parallel_strips(double w, double h) { return (std::hypot(w, h) - h) / w; }
double infinite_hinged_strips(double angle) { return 1.0 - std::sin(0.5 * angle); }

double element_to_parallel_rectangle(double a, double b, double c) {
    const double x = a / c, y = b / c, rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
    return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * pi);
}

double element_to_perpendicular_rectangle(double a, double b, double c) {
    const double far = std::hypot(b, c);
    return (std::atan(a / c) - c / far * std::atan(a / far)) / (2.0 * pi);
}

double element_to_disc(double r, double h, double a) {
    const double z = 1.0 + (h * h + r * r) / (a * a), ratio = r / a;
    if (a == 0.0) return r * r / (h * h + r * r);
    return 0.5 * (1.0 - (z - 2.0 * ratio * ratio) / std::sqrt(z * z - 4.0 * ratio * ratio));
}

double element_to_sphere(double r, double h, double angle) {
    const double d = h / r, c = std::cos(angle);
    if (angle <= 0.5 * pi - std::asin(1.0 / d)) return c / (d * d);
    if (angle >= 0.5 * pi + std::asin(1.0 / d)) return 0.0;
    const double tangent = std::sqrt(d * d - 1.0);
    return 0.5 - std::asin(tangent / (d * std::sin(angle))) / pi +
           (c * std::acos(-tangent / std::tan(angle)) - tangent * std::sqrt(1.0 - d * d * c * c)) /
               (pi * d * d);
}

double sphere_to_rectangle(double a, double b, double d) {
    return std::asin(a * b / std::sqrt((a * a + d * d) * (b * b + d * d))) / pi;
}

} // namespace kinelux::support
