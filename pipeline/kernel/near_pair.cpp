// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/near_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "geometry/quadrature.h"
#include "kernel/singularity.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::SurfaceNode;

constexpr int most_nodes = 12;

// A bilinear quadrilateral in a facet's barycentric coordinates: s runs from the edge 0-1 to the edge 3-2, t along them.
// A triangle has 2 = 3. Each direction has its Gauss rule, its error, and where it is divided.
struct Direction {
    int nodes = 2;
    double rate = 1.0;        ///< Singularity::rate
    double raw_error = 0.0;   ///< of the cell's values, before calibration [1]
    double calibration = 3.0; ///< what raw errors were found to be wrong by nearby
    double foretold = 0.0;    ///< error relative to the integrand's size, from where it is singular [1]
    double place = 0.5;       ///< Singularity::place
    double layer = std::numeric_limits<double>::infinity(); ///< Singularity::layer
    double division = 0.5;

    double error() const { return calibration * raw_error; }
};

struct Cell {
    const Facet* facet;
    std::array<Vec2, 4> corners;
    Direction s, t;
    double wanted = 0.0; ///< foretold error x area that will do [m2]
    std::vector<double> values;
    double brightest2 = 0.0; ///< largest square sum of inner integrals at the nodes [1/m2]

    double error() const { return s.error() + t.error(); }
};

std::array<std::array<Vec2, 4>, 2> divided(const std::array<Vec2, 4>& c, bool across_s, double at) {
    if (across_s) {
        const Vec2 left = c[0] + at * (c[3] - c[0]), right = c[1] + at * (c[2] - c[1]);
        return {{{c[0], c[1], right, left}, {left, right, c[2], c[3]}}};
    }
    const Vec2 bottom = c[0] + at * (c[1] - c[0]), top = c[3] + at * (c[2] - c[3]);
    return {{{c[0], bottom, top, c[3]}, {bottom, c[1], c[2], top}}};
}

// Normalised Legendre polynomials of degree 0 .. n-1 at the n Gauss nodes: [degree * n + node].
std::vector<double> legendre_at_nodes(int n) {
    const auto count = static_cast<std::size_t>(n);
    std::vector<double> values(count * count);
    for (std::size_t i = 0; i < count; ++i) {
        const double x = 2.0 * geometry::gauss_rule(n).nodes[i] - 1.0;
        double previous = 0.0, value = 1.0;
        for (int k = 0; k < n; ++k) {
            values[static_cast<std::size_t>(k) * count + i] = value * std::sqrt(2.0 * k + 1.0);
            previous = std::exchange(value, ((2 * k + 1) * x * value - k * previous) / (k + 1));
        }
    }
    return values;
}

const std::vector<double>& legendre_table(int n) {
    static const std::vector<std::vector<double>> table = [] {
        std::vector<std::vector<double>> result(1);
        for (int k = 1; k <= most_nodes; ++k) result.push_back(legendre_at_nodes(k));
        return result;
    }();
    return table[static_cast<std::size_t>(n)];
}

double norm2(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return sum;
}

class OuterIntegrator {
public:
    OuterIntegrator(const ElementShape& element, std::size_t columns, PointGather& inner,
                    const OuterOptions& options)
        : element_(element),
          columns_(columns),
          size_(element.basis.size() * columns),
          inner_(inner),
          options_(options),
          gathered_(columns),
          phi_(element.basis.size()),
          entries_(size_) {}

    OuterResult run(std::span<const OuterPiece> pieces) {
        std::vector<Cell> first;
        for (const OuterPiece& piece : pieces) append_cells(piece, first);
        double total_area = 0.0;
        for (const Cell& cell : first) total_area += area_of(cell);
        for (Cell& cell : first) cell.wanted = plan_share * options_.tolerance * total_area;
        cells_ = options_.polygon != nullptr ? planned(std::move(first)) : std::move(first);
        for (Cell& cell : cells_) {
            if (options_.refine) ask_for_measuring(cell);
            evaluate(cell);
        }
        if (options_.refine) {
            divide_dark_cells();
            refine();
        } else if (options_.settle) {
            divide_blind_cells();
            settle();
        }

        OuterResult result;
        result.values = sum_of_cells();
        for (const Cell& cell : cells_) result.error += cell.error();
        if (!options_.refine && !options_.settle)
            result.error = options_.tolerance * std::max(std::sqrt(norm2(result.values)), options_.floor);
        result.points = points_;
        return result;
    }

private:
    std::vector<double> sum_of_cells() const {
        std::vector<double> sum(size_, 0.0);
        for (const Cell& cell : cells_)
            for (std::size_t k = 0; k < size_; ++k) sum[k] += cell.values[k];
        return sum;
    }

    static bool smaller_error(const Cell& a, const Cell& b) { return a.error() < b.error(); }

    // A cell whose nodes all see nothing may hold points that do: it is divided before it is believed.
    void divide_dark_cells() {
        constexpr int halvings = 4;
        constexpr std::size_t most_cells = 16; // more of them are small already
        if (cells_.size() > most_cells) return;
        for (int halving = 0; halving < halvings; ++halving) {
            std::vector<Cell> next;
            for (Cell& cell : cells_) {
                if (norm2(cell.values) > 0.0) {
                    next.push_back(std::move(cell));
                    continue;
                }
                for (const auto& corners : divided(cell.corners, halving % 2 == 0, 0.5)) {
                    next.push_back(cell);
                    next.back().corners = corners;
                    evaluate(next.back());
                }
            }
            cells_ = std::move(next);
        }
    }

    // Light may fall on a spot that all nodes of a cell miss, so that their values do not tell of it: where an edge or corner
    // of the polygon all but touches the cell. A cell that is far brighter there than at its nodes is planned anew, by what
    // such a spot would add to the block.
    void divide_blind_cells() {
        if (options_.polygon == nullptr) return;
        constexpr double contrast2 = 4.0;
        const double allowed =
            options_.tolerance * std::max(std::sqrt(norm2(sum_of_cells())), options_.floor);
        std::vector<Cell> next, blind;
        for (Cell& cell : cells_) {
            const double unsure = area_of(cell) * std::max(cell.s.foretold, cell.t.foretold);
            const double bright2 = unsure > 0.0 ? brightness2(cell) : 0.0;
            const double wanted = allowed * std::sqrt(element_.area / bright2);
            if (bright2 <= contrast2 * cell.brightest2 || unsure <= wanted) {
                next.push_back(std::move(cell));
                continue;
            }
            cell.wanted = wanted;
            blind.push_back(std::move(cell));
        }
        for (Cell& part : planned(std::move(blind))) {
            evaluate(part);
            next.push_back(std::move(part));
        }
        cells_ = std::move(next);
    }

    // Square sum of the inner integrals where a cell's directions are nearest to a singularity.
    double brightness2(const Cell& cell) {
        const auto& c = cell.corners;
        const Vec2 bottom = glm::mix(c[0], c[1], cell.t.place), top = glm::mix(c[3], c[2], cell.t.place);
        const Vec2 at = glm::mix(bottom, top, cell.s.place);
        Vec2 parameter;
        inner_.gather(geometry::node_at(element_, *cell.facet, {1.0 - at.x - at.y, at.x, at.y}, parameter),
                      gathered_);
        ++points_;
        return norm2(gathered_);
    }

    static void append_cells(const OuterPiece& piece, std::vector<Cell>& cells) {
        const std::vector<Vec2>& p = piece.corners;
        if (p.size() == 3) return cells.push_back({piece.facet, {p[0], p[1], p[2], p[2]}});
        if (p.size() == 4) return cells.push_back({piece.facet, {p[0], p[1], p[2], p[3]}});
        Vec2 centre(0.0);
        for (const Vec2& corner : p) centre += corner / static_cast<double>(p.size());
        for (std::size_t i = 0; i < p.size(); ++i)
            cells.push_back({piece.facet, {p[i], p[(i + 1) % p.size()], centre, centre}});
    }

    // By the diagonals; exact on flat facets, and only for shares.
    static double area_of(const Cell& cell) {
        const Vec2 e = cell.corners[2] - cell.corners[0], f = cell.corners[3] - cell.corners[1];
        return std::abs(e.x * f.y - e.y * f.x) * cell.facet->area;
    }

    Vec3 position(const Facet* facet, const Vec2& at) const {
        return facet->corners[0] + at.x * (facet->corners[1] - facet->corners[0]) +
               at.y * (facet->corners[2] - facet->corners[0]);
    }

    // Nodes with which errors can be measured; few for coarse and many for fine tolerances are the cheapest in the end.
    void ask_for_measuring(Cell& cell) const {
        const double tolerance = options_.tolerance;
        const int by_tolerance = tolerance >= 3e-3 ? 2 : tolerance >= 1e-4 ? 3 : tolerance >= 1e-6 ? 5 : 7;
        const int nodes = std::clamp(by_tolerance + (element_.basis.degree() + 1) / 2, 3, most_nodes);
        cell.s.nodes = cell.t.nodes = nodes;
    }

    // Divides cells until every direction of each is resolved by few nodes, or does not matter.
    std::vector<Cell> planned(std::vector<Cell> waiting) const {
        std::vector<Cell> result;
        while (!waiting.empty()) {
            Cell cell = std::move(waiting.back());
            waiting.pop_back();
            const bool resolved = foretell(cell);
            if (resolved || result.size() + waiting.size() > most_planned) {
                result.push_back(std::move(cell));
                continue;
            }
            for (Cell& part : parts(cell, cell.t.foretold <= clearly * cell.s.foretold))
                waiting.push_back(std::move(part));
        }
        return result;
    }

    // Both sides of a cell's division; the same error per area will do.
    static std::array<Cell, 2> parts(const Cell& cell, bool across_s) {
        const auto corners = divided(cell.corners, across_s, across_s ? cell.s.division : cell.t.division);
        std::array<Cell, 2> result{Cell{cell.facet, corners[0]}, Cell{cell.facet, corners[1]}};
        for (Cell& part : result) part.wanted = cell.wanted;
        return result;
    }

    // Chooses nodes for both directions. @return  whether they resolve the integrand
    bool foretell(Cell& cell) const {
        const double area = area_of(cell);
        if (!(area > 0.0)) return true; // holds nothing
        const InnerPolygon& polygon = *options_.polygon;
        const auto& c = cell.corners;
        Singularity s, t;
        for (const double at : {0.1, 0.5, 0.9}) {
            foretell_along(polygon, position(cell.facet, c[0] + at * (c[1] - c[0])),
                           position(cell.facet, c[3] + at * (c[2] - c[3])), s);
            foretell_along(polygon, position(cell.facet, c[0] + at * (c[3] - c[0])),
                           position(cell.facet, c[1] + at * (c[2] - c[1])), t);
        }
        const double s_length = glm::distance(position(cell.facet, 0.5 * (c[0] + c[1])),
                                              position(cell.facet, 0.5 * (c[2] + c[3])));
        const double t_length = glm::distance(position(cell.facet, 0.5 * (c[0] + c[3])),
                                              position(cell.facet, 0.5 * (c[1] + c[2])));
        const double wanted = cell.wanted / area;
        const bool s_resolved = choose(s, wanted, s_length, cell.s);
        const bool t_resolved = choose(t, wanted, t_length, cell.t);
        return s_resolved && t_resolved;
    }

    bool choose(const Singularity& nearest, double wanted, double length, Direction& direction) const {
        const int extra = element_.basis.degree() + 1; // of the basis and of the cell's map
        const double log_rate = std::log(nearest.rate);
        direction.rate = nearest.rate;
        direction.place = nearest.place;
        direction.layer = nearest.layer;
        constexpr int fewest = 3;
        const double amplitude =
            2.0 * (2.0 + element_.basis.degree()); // on the ellipse through the singularity
        const double degree = std::log(amplitude / wanted) / std::max(log_rate, 1e-9);
        const double nodes = std::ceil(0.5 * (degree + extra));
        direction.nodes = static_cast<int>(std::clamp(nodes, double{fewest}, double{most_planned_nodes}));
        direction.foretold =
            std::min(1.0, amplitude * std::pow(nearest.rate, -(2.0 * direction.nodes - extra)));
        if (nodes <= most_planned_nodes) return true;
        // A singularity that the cell all but touches is weak: the integrand only bends there, over the cell's length.
        const double size = 2.0 * element_.radius;
        constexpr double border = 1e-6;
        if (nearest.distance < 1e-3 * options_.tolerance * size &&
            (nearest.place < border || nearest.place > 1.0 - border)) {
            constexpr double bend = 0.1;
            direction.foretold = std::min(direction.foretold, bend * length / size);
        }
        direction.division = nearest.place < 0.25 ? 0.25 : nearest.place > 0.75 ? 0.75 : nearest.place;
        return direction.foretold <= wanted;
    }

    // Evaluates again, with more nodes or in parts, the cells that hold most of the measured error, until what is left
    // is below the tolerance.
    void settle() {
        constexpr int most_passes = 12;
        for (int pass = 0; pass < most_passes && points_ < options_.most_points; ++pass) {
            const double allowed =
                options_.tolerance * std::max(std::sqrt(norm2(sum_of_cells())), options_.floor);
            std::stable_sort(cells_.begin(), cells_.end(),
                             [](const Cell& a, const Cell& b) { return smaller_error(b, a); });
            double left = 0.0;
            for (const Cell& cell : cells_) left += cell.error();
            if (left <= allowed) return;
            std::size_t count = 0;
            while (count < cells_.size() && left > 0.5 * allowed) left -= cells_[count++].error();
            while (count < cells_.size() && clearly * cells_[count].error() > cells_[count - 1].error())
                ++count;
            std::vector<Cell> again;
            for (std::size_t c = 0; c < count; ++c)
                improve(cells_[c], 0.5 * allowed / static_cast<double>(count), again);
            for (Cell& cell : again) evaluate(cell);
            cells_.erase(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count));
            std::move(again.begin(), again.end(), std::back_inserter(cells_));
        }
    }

    // What takes a cell's place for its error to become a wanted one.
    void improve(Cell& cell, double wanted, std::vector<Cell>& result) const {
        const auto enough = [&](Direction& direction) {
            const double excess = std::log(2.0 * direction.error() / wanted);
            if (!(excess > 0.0)) return true;
            const double more = std::ceil(0.5 * excess / std::max(std::log(direction.rate), 1e-9));
            if (direction.nodes + more > most_planned_nodes) return false;
            direction.nodes += static_cast<int>(more);
            return true;
        };
        const bool across_s = cell.t.error() <= clearly * cell.s.error();
        if (enough(across_s ? cell.s : cell.t)) {
            Direction& other = across_s ? cell.t : cell.s;
            if (!enough(other)) other.nodes = most_planned_nodes;
            result.push_back(std::move(cell));
            return;
        }
        cell.wanted = area_of(cell) * wanted /
                      std::max(std::sqrt(norm2(cell.values)), std::numeric_limits<double>::min());
        std::vector<Cell> both;
        for (Cell& part : parts(cell, across_s)) both.push_back(std::move(part));
        for (Cell& part : planned(std::move(both))) result.push_back(std::move(part));
    }

    void refine() {
        std::make_heap(cells_.begin(), cells_.end(), smaller_error);
        // The sums are kept up to date by differences; they only steer.
        std::vector<double> sum(size_, 0.0);
        double error = 0.0;
        const auto account = [&](const Cell& cell, double sign) {
            for (std::size_t k = 0; k < size_; ++k) sum[k] += sign * cell.values[k];
            error += sign * cell.error();
        };
        for (const Cell& cell : cells_) account(cell, 1.0);
        while (!cells_.empty() && points_ < options_.most_points &&
               error > options_.tolerance * std::max(std::sqrt(norm2(sum)), options_.floor)) {
            std::pop_heap(cells_.begin(), cells_.end(), smaller_error);
            const Cell worst = std::move(cells_.back());
            cells_.pop_back();
            account(worst, -1.0);
            for (Cell& half : split(worst)) {
                account(half, 1.0);
                cells_.push_back(std::move(half));
                std::push_heap(cells_.begin(), cells_.end(), smaller_error);
            }
        }
    }

    std::array<Cell, 2> split(const Cell& cell) {
        const bool across_s = cell.s.error() >= cell.t.error();
        const auto corners = divided(cell.corners, across_s, 0.5);
        std::array<Cell, 2> result{Cell{cell.facet, corners[0], cell.s, cell.t},
                                   Cell{cell.facet, corners[1], cell.s, cell.t}};
        for (Cell& half : result) evaluate(half);
        calibrate(cell, result);
        return result;
    }

    // The change that halving brings is what the cell's error across was: the halves are judged in proportion.
    void calibrate(const Cell& cell, std::array<Cell, 2>& parts) const {
        constexpr double safety = 3.0, least = 1e-3, most = 1e3;
        const bool across_s = cell.s.error() >= cell.t.error();
        const Direction& direction = across_s ? cell.s : cell.t;
        if (!(direction.raw_error > 0.0)) return;
        double change2 = 0.0;
        for (std::size_t k = 0; k < size_; ++k) {
            const double change = cell.values[k] - parts[0].values[k] - parts[1].values[k];
            change2 += change * change;
        }
        const double calibration = std::clamp(safety * std::sqrt(change2) / direction.raw_error, least, most);
        for (Cell& part : parts) (across_s ? part.s : part.t).calibration = calibration;
    }

    void evaluate(Cell& cell) {
        const geometry::GaussRule& s_rule = geometry::gauss_rule(cell.s.nodes);
        const geometry::GaussRule& t_rule = geometry::gauss_rule(cell.t.nodes);
        const std::size_t ns = s_rule.nodes.size(), nt = t_rule.nodes.size();
        along_s_.assign(ns * size_, 0.0);
        along_t_.assign(nt * size_, 0.0);
        cell.values.assign(size_, 0.0);
        cell.brightest2 = 0.0;
        const auto& c = cell.corners;
        for (std::size_t i = 0; i < ns; ++i)
            for (std::size_t j = 0; j < nt; ++j) {
                const Vec2 bottom = c[0] + t_rule.nodes[j] * (c[1] - c[0]);
                const Vec2 ds = c[3] + t_rule.nodes[j] * (c[2] - c[3]) - bottom;
                const Vec2 dt = (1.0 - s_rule.nodes[i]) * (c[1] - c[0]) + s_rule.nodes[i] * (c[2] - c[3]);
                set_entries(cell.facet, bottom + s_rule.nodes[i] * ds, std::abs(ds.x * dt.y - ds.y * dt.x));
                cell.brightest2 = std::max(cell.brightest2, norm2(gathered_));
                for (std::size_t e = 0; e < size_; ++e) {
                    along_s_[i * size_ + e] += t_rule.weights[j] * entries_[e];
                    along_t_[j * size_ + e] += s_rule.weights[i] * entries_[e];
                }
            }
        for (std::size_t i = 0; i < ns; ++i)
            for (std::size_t e = 0; e < size_; ++e)
                cell.values[e] += s_rule.weights[i] * along_s_[i * size_ + e];
        if (options_.refine) {
            cell.s.raw_error = error_along(along_s_, cell.s.nodes);
            cell.t.raw_error = error_along(along_t_, cell.t.nodes);
        } else if (options_.settle) {
            for (Direction* direction : {&cell.s, &cell.t}) {
                direction->raw_error = error_left(direction == &cell.s ? along_s_ : along_t_, *direction);
                direction->calibration = 1.0;
            }
            add_unseen_layers(cell);
        }
    }

    // Whether a singularity is so close to the cell that what happens there happens between two nodes.
    static bool hides_layer(const Direction& direction) {
        double to_node = 1.0;
        for (const double node : geometry::gauss_rule(direction.nodes).nodes)
            to_node = std::min(to_node, std::abs(node - direction.place));
        return direction.layer < 0.5 * to_node;
    }

    // A jump that spreads over a layer as wide as a singularity is far is not in the coefficients when no node is in it.
    void add_unseen_layers(Cell& cell) {
        if (options_.polygon == nullptr || !(hides_layer(cell.s) || hides_layer(cell.t))) return;
        const double jump = std::abs(std::sqrt(brightness2(cell)) - std::sqrt(cell.brightest2));
        constexpr double ends = 2.0; // of the cell, where another layer may be
        const double per_share = ends * jump * area_of(cell) / std::sqrt(element_.area);
        for (Direction* direction : {&cell.s, &cell.t})
            if (hides_layer(*direction))
                direction->raw_error = std::max(direction->raw_error, direction->layer * per_share);
    }

    // entries_ = phi_k(x) gather_l(x) times the area per (s, t) at one point.
    void set_entries(const Facet* facet, const Vec2& at, double jacobian) {
        Vec2 parameter;
        const SurfaceNode x = geometry::node_at(element_, *facet, {1.0 - at.x - at.y, at.x, at.y}, parameter);
        inner_.gather(x, gathered_);
        ++points_;
        element_.basis.evaluate(parameter, phi_);
        // node_at's weight is the area per unit of the reference triangle's measure, which is 2 db1 db2.
        const double area = 2.0 * x.weight * jacobian;
        for (std::size_t k = 0; k < phi_.size(); ++k)
            for (std::size_t l = 0; l < columns_; ++l)
                entries_[k * columns_ + l] = area * phi_[k] * gathered_[l];
    }

    // Norms of the Legendre coefficients along one direction, as the nodes see them.
    void measure_coefficients(std::span<const double> lines, int nodes) {
        const auto& weights = geometry::gauss_rule(nodes).weights;
        const auto& legendre = legendre_table(nodes);
        const std::size_t n = weights.size();
        norms_.assign(n, 0.0);
        for (std::size_t k = 0; k < n; ++k) {
            coefficients_.assign(size_, 0.0);
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t e = 0; e < size_; ++e)
                    coefficients_[e] += weights[i] * legendre[k * n + i] * lines[i * size_ + e];
            norms_[k] = std::sqrt(norm2(coefficients_));
        }
    }

    // Where the Legendre coefficients c_k of an integrand fall like q^k the error of n Gauss nodes is about c_2n, or
    // c_(n-1)^2 / c_0; where they fall like a power of k it is smaller than that as well.
    double error_along(std::span<const double> lines, int nodes) {
        measure_coefficients(lines, nodes);
        double highest = 0.0;
        for (std::size_t k = 2; k < norms_.size(); ++k)
            if (k + 2 >= norms_.size()) highest = std::max(highest, norms_[k]);
        const double scale = std::sqrt(norm2(norms_));
        return scale > 0.0 ? highest * highest / scale : 0.0;
    }

    // The error of n Gauss nodes is about c_2n. The highest coefficients are measured; from there they fall by the rate
    // that the nearest singularity gives, once the degree of the basis is passed, or as fast as they were seen to fall.
    double error_left(std::span<const double> lines, const Direction& direction) {
        measure_coefficients(lines, direction.nodes);
        const int n = direction.nodes, first_fall = element_.basis.degree() + 1;
        const auto count = static_cast<std::size_t>(n);
        const double highest = std::max(norms_[count - 1], norms_[count - 2] / direction.rate);
        const double fall = std::pow(direction.rate, -std::max(0, std::min(n + 1, 2 * n - first_fall)));
        double before = 0.0;
        for (std::size_t k = (count - 1) / 2; k + 2 < count; ++k) before = std::max(before, norms_[k]);
        const double seen = count >= 5 && before > 0.0 ? std::min(1.0, highest / before) : 1.0;
        constexpr double safety = 4.0;
        return safety * highest * std::min(fall, seen);
    }

    static constexpr int most_planned_nodes = 8;
    static constexpr double plan_share = 3.0; ///< of the tolerance, for what a first plan foretells
    static constexpr std::size_t most_planned = 4000;

    const ElementShape& element_;
    std::size_t columns_, size_;
    PointGather& inner_;
    OuterOptions options_;
    std::vector<double> gathered_, phi_, entries_, along_s_, along_t_, coefficients_, norms_;
    std::vector<Cell> cells_;
    std::size_t points_ = 0;
};

} // namespace

OuterResult integrate_outer(const ElementShape& element, std::span<const OuterPiece> pieces,
                            std::size_t columns, PointGather& inner, const OuterOptions& options) {
    return OuterIntegrator(element, columns, inner, options).run(pieces);
}

} // namespace kinelux::kernel
