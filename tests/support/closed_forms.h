// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace kinelux::support {

// Form factors with a closed form, unoccluded: F_12 is the share of what leaves 1 uniformly that reaches 2 [1]. Lengths
// in one unit of any kind. C-n, A-n, B-n are numbers in Howell, A Catalog of Radiation Heat Transfer Configuration
// Factors. The catalogue has misprints: tests/support/closed_forms_test.cpp checks all of these against each other.

/// An axis-parallel rectangle in the plane z of its pair.
struct Extent {
    double low_u, high_u, low_v, high_v;
    double area() const { return (high_u - low_u) * (high_v - low_v); }
};

/// Equal directly opposed a x b rectangles at distance c. @cite C-11
double parallel_equal_rectangles(double a, double b, double c);

/// Parallel rectangles with parallel sides at distance c, by sixteen corner terms. @cite Ehlert and Smith,
/// J. Thermophys. Heat Transf. 7 (1993); C-13
double parallel_rectangles(const Extent& from, const Extent& to, double c);

/// Rectangles of width l on either side of a common edge at 90 degrees, w deep (from) and h high (to). @cite C-14
double perpendicular_rectangles_common_edge(double l, double w, double h);

/// Perpendicular rectangles, both with a pair of sides along the line where their planes meet: u along that line, v the
/// distance from it, v >= 0; by sixteen corner terms. @cite Ehlert and Smith (1993); C-15
double perpendicular_rectangles(const Extent& from, const Extent& to);

/// Rectangles that share an edge of length l at any angle, a (from) and b (to) deep; the integral that is left over the
/// common edge's direction is done to 1e-13. @param angle  between the fronts, 0..pi [rad]
/// @cite the factor of an element beside an inclined rectangle, Hamilton and Morgan, NACA TN 2836 (1952), P-4; C-16
double hinged_rectangles(double l, double a, double b, double angle);

/// Coaxial parallel discs of radii r1, r2 at distance h. @cite C-41
double coaxial_discs(double r1, double r2, double h);

/// Inside of an outer sphere, r2, about an inner one, r1: from inner to outer 1, outer to inner, outer to itself. @cite C-135
double outer_sphere_to_inner(double r1, double r2);
double outer_sphere_to_itself(double r1, double r2);

/// Inside of a right circular cylinder of radius r and height h, without ends: to itself, and to one end. @cite C-78, C-79
double cylinder_to_itself(double r, double h);
double cylinder_to_end(double r, double h);

/// Infinitely long: parallel strips of width w at distance h, and strips hinged at an angle. @cite Hottel's crossed
/// strings; C-1, C-5
double infinite_parallel_strips(double w, double h);
double infinite_hinged_strips(double angle);

/// A small plate to a parallel rectangle a x b at distance c, under its corner. @cite B-3
double element_to_parallel_rectangle(double a, double b, double c);

/// A small plate to a perpendicular rectangle, a along their planes' common line and b high, c from it, at its corner. @cite B-4
double element_to_perpendicular_rectangle(double a, double b, double c);

/// A small plate to a parallel disc of radius r at height h, off its axis by a. @cite B-13
double element_to_disc(double r, double h, double a);

/// A small plate to a sphere of radius r whose centre is at distance h; angle between the normal and the way to the centre;
/// also where the plate's horizon cuts the sphere. @cite B-41, B-43
double element_to_sphere(double r, double h, double angle);

/// A sphere to a rectangle 2a x 2b at distance d from its centre, facing it in the middle, d above the radius: its share of
/// all directions as seen from the centre. @cite C-108
double sphere_to_rectangle(double a, double b, double d);

} // namespace kinelux::support
