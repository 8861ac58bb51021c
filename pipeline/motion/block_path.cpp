// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/block_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace kinelux::motion {

namespace {

// Longest piece where something may stand between [frames]: a shadow that comes and goes within a quarter of it is missed.
constexpr std::uint32_t longest_shaded = 24;
// Pieces of fewer steps are not worth interpolating: the checks would cost as much as all of their frames.
constexpr std::uint32_t shortest_clear = 6, shortest_shaded = 9;
constexpr std::uint32_t shortest_nine = 16; ///< steps over which nine Lobatto nodes fall on different frames
// Of the tolerance: blocks below it may be interpolated as they like.
constexpr double nothing = 0.3;
// A step from 3 to 5 or from 5 to 9 nodes is not believed to bring more than this.
constexpr double best_gain = 0.1;

double frobenius(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// Nodes of Chebyshev and Lobatto over frames; those for half as many steps are among them.
std::vector<std::uint32_t> lobatto(std::uint32_t first, std::uint32_t last, std::uint32_t steps) {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t k = 0; k <= steps; ++k) {
        const double x = 0.5 * (1.0 - std::cos(std::numbers::pi * k / steps));
        nodes.push_back(first + static_cast<std::uint32_t>(std::lround(x * (last - first))));
    }
    return nodes;
}

} // namespace

void BlockPath::add_run(Change change, std::uint32_t first, std::uint32_t last) {
    if (change == Change::Near) return open_.push_back({first, last, change, all});
    const std::uint32_t longest = change == Change::Shaded ? longest_shaded : last - first;
    const std::uint32_t shortest = change == Change::Shaded ? shortest_shaded : shortest_clear;
    const std::uint32_t parts = longest > 0 ? (last - first + longest - 1) / longest : 1;
    for (std::uint32_t p = 0; p < std::max(parts, 1u); ++p) {
        const std::uint32_t from = first + p * (last - first) / std::max(parts, 1u);
        const std::uint32_t to = first + (p + 1) * (last - first) / std::max(parts, 1u);
        open_.push_back({from, to, change, to - from < shortest ? all : std::uint8_t{0}});
    }
}

std::vector<std::uint32_t> BlockPath::frames_of(const Span& span) {
    std::vector<std::uint32_t> frames;
    if (span.level == all) {
        for (std::uint32_t f = span.first; f <= span.last; ++f) frames.push_back(f);
        return frames;
    }
    if (span.change != Change::Shaded) return lobatto(span.first, span.last, 2u << span.level);
    const std::uint32_t middle = (span.first + span.last) / 2;
    if (span.level == 0) return {span.first, middle, span.last};
    return {span.first, (span.first + middle) / 2, middle, (middle + span.last) / 2, span.last};
}

std::vector<BlockPath::Request> BlockPath::requests() const {
    std::vector<Request> result;
    for (const Span& span : open_)
        for (const std::uint32_t frame : frames_of(span))
            if (find(frame) == nullptr) result.push_back({frame, span.change});
    std::sort(result.begin(), result.end(),
              [](const Request& a, const Request& b) { return a.frame < b.frame; });
    result.erase(std::unique(result.begin(), result.end(),
                             [](const Request& a, const Request& b) { return a.frame == b.frame; }),
                 result.end());
    return result;
}

const BlockPath::Sample* BlockPath::find(std::uint32_t frame) const {
    const auto found = std::lower_bound(samples_.begin(), samples_.end(), frame,
                                        [](const Sample& s, std::uint32_t f) { return s.frame < f; });
    return found != samples_.end() && found->frame == frame ? &*found : nullptr;
}

void BlockPath::set(std::uint32_t frame, const kernel::TransportBlock& block) {
    const auto place = std::lower_bound(samples_.begin(), samples_.end(), frame,
                                        [](const Sample& s, std::uint32_t f) { return s.frame < f; });
    ++integrated_;
    if (block.values.empty()) {
        samples_.insert(place, {frame, 0.0f, zero});
        return;
    }
    samples_.insert(
        place, {frame, static_cast<float>(block.error), static_cast<std::uint32_t>(values_.size() / size_)});
    for (const double value : block.values) values_.push_back(static_cast<float>(value));
}

// Lagrange's form; the largest error of the nodes is returned.
double BlockPath::interpolate(std::span<const std::uint32_t> nodes, double frame,
                              std::span<double> values) const {
    std::fill(values.begin(), values.end(), 0.0);
    double error = 0.0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Sample& sample = *find(nodes[n]);
        error = std::max(error, static_cast<double>(sample.error));
        if (sample.place == zero) continue;
        double weight = 1.0;
        for (std::size_t m = 0; m < nodes.size(); ++m)
            if (m != n) weight *= (frame - nodes[m]) / (static_cast<double>(nodes[n]) - nodes[m]);
        const float* own = &values_[sample.place * size_];
        for (std::size_t v = 0; v < size_; ++v) values[v] += weight * static_cast<double>(own[v]);
    }
    return error;
}

double BlockPath::deviation(std::span<const std::uint32_t> nodes, std::uint32_t check) const {
    std::vector<double> values(size_), exact(size_);
    interpolate(nodes, check, values);
    interpolate(std::array{check}, check, exact);
    for (std::size_t v = 0; v < size_; ++v) values[v] -= exact[v];
    return frobenius(values);
}

double BlockPath::norm(std::uint32_t frame) const {
    std::vector<double> values(size_);
    interpolate(std::array{frame}, frame, values);
    return frobenius(values);
}

void BlockPath::accept(const Span& span, std::span<const std::uint32_t> nodes, double error) {
    Piece piece{.first = span.first,
                .last = span.last,
                .error = static_cast<float>(error),
                .count = static_cast<std::uint32_t>(nodes.size()),
                .nodes = {}};
    std::copy(nodes.begin(), nodes.end(), piece.nodes.begin());
    pieces_.push_back(piece);
}

void BlockPath::take_all(const Span& span) {
    open_.push_back(span);
    open_.back().level = all;
}

void BlockPath::halve(const Span& span, std::uint32_t middle) {
    const std::uint32_t shortest = span.change == Change::Shaded ? shortest_shaded : shortest_clear;
    for (const auto& [first, last] : {std::pair(span.first, middle), std::pair(middle, span.last)})
        open_.push_back({first, last, span.change, last - first < shortest ? all : std::uint8_t{0}});
}

// Accepts a piece whose blocks are so small that no error in them matters.
bool BlockPath::negligible(const Span& span, std::span<const std::uint32_t> frames, double tolerance) {
    double largest = 0.0;
    for (const std::uint32_t frame : frames) largest = std::max(largest, norm(frame));
    if (largest > nothing * tolerance && bound_ > tolerance) return false;
    accept(span, frames, std::min(std::max(largest, std::min(bound_, nothing * tolerance)), bound_));
    return true;
}

void BlockPath::judge_clear(const Span& span, double tolerance) {
    const std::vector<std::uint32_t> nodes = frames_of(span);
    if (span.level == 0) {
        if (negligible(span, nodes, tolerance)) return;
        open_.push_back({span.first, span.last, span.change, 1});
        return;
    }
    const std::vector<std::uint32_t> five = lobatto(span.first, span.last, 4);
    const std::array three{five[0], five[2], five[4]};
    const double error_1 = deviation(std::array{five[0], five[4]}, five[2]);
    const double error_3 = std::max(deviation(three, five[1]), deviation(three, five[3]));
    if (span.level == 1) {
        const double gain = error_1 > 0.0 ? std::clamp(error_3 / error_1, best_gain, 1.0) : 1.0;
        if (error_3 <= nothing * tolerance) return accept(span, three, error_3);
        if (error_3 * gain <= tolerance) return accept(span, five, error_3 * gain);
        if (span.last - span.first < shortest_nine || error_3 * gain * gain * gain > 2.0 * tolerance)
            return halve(span, five[2]);
        open_.push_back({span.first, span.last, span.change, 2});
        return;
    }
    double error_5 = 0.0;
    for (const std::size_t k : {1u, 3u, 5u, 7u}) error_5 = std::max(error_5, deviation(five, nodes[k]));
    const double gain = error_3 > 0.0 ? std::clamp(error_5 / error_3, best_gain, 1.0) : 1.0;
    if (error_5 * gain <= tolerance) return accept(span, nodes, error_5 * gain);
    halve(span, five[2]);
}

void BlockPath::judge_shaded(const Span& span, double tolerance) {
    const std::vector<std::uint32_t> nodes = frames_of(span);
    if (span.level == 0) {
        if (negligible(span, nodes, tolerance)) return;
        open_.push_back({span.first, span.last, span.change, 1});
        return;
    }
    const std::array three{nodes[0], nodes[2], nodes[4]};
    const double error = std::max(deviation(three, nodes[1]), deviation(three, nodes[3]));
    if (error <= tolerance) {
        // What was checked is quadratic over all of it; with the checks for nodes too it is at least as good.
        accept({nodes[0], nodes[2], span.change}, std::span(nodes).first(3), 0.5 * error);
        accept({nodes[2], nodes[4], span.change}, std::span(nodes).last(3), 0.5 * error);
    } else if (span.last - span.first < 2 * shortest_shaded) {
        take_all(span);
    } else {
        halve(span, nodes[2]);
    }
}

void BlockPath::judge(double tolerance) {
    std::vector<Span> spans;
    std::swap(spans, open_);
    for (const Span& span : spans) {
        if (span.level == all) {
            accept(span, {}, 0.0);
            continue;
        }
        // Blocks that are off by more than the tolerance scatter by about as much: no polynomial goes through them.
        double scatter = 0.0;
        for (const std::uint32_t frame : frames_of(span))
            scatter = std::max(scatter, static_cast<double>(find(frame)->error));
        constexpr double heard = 0.5, most = 3.0;
        const double allowed = std::max(tolerance, std::min(heard * scatter, most * tolerance));
        span.change == Change::Shaded ? judge_shaded(span, allowed) : judge_clear(span, allowed);
    }
    if (!finished()) return;
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
        return std::pair(a.first, a.last) < std::pair(b.first, b.last);
    });
}

void BlockPath::compact() {
    std::vector<Sample> samples;
    std::vector<float> values;
    for (const Sample& sample : samples_) {
        const bool used = std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
            const auto last = piece.nodes.begin() + piece.count;
            return sample.frame >= piece.first && sample.frame <= piece.last &&
                   (piece.count == 0 || std::find(piece.nodes.begin(), last, sample.frame) != last);
        });
        if (!used) continue;
        samples.push_back(sample);
        if (sample.place == zero) continue;
        samples.back().place = static_cast<std::uint32_t>(values.size() / size_);
        const auto from = values_.begin() + static_cast<std::ptrdiff_t>(sample.place * size_);
        values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(size_));
    }
    samples_ = std::vector<Sample>(samples.begin(), samples.end());
    values_ = std::vector<float>(values.begin(), values.end());
    pieces_.shrink_to_fit();
    open_ = {};
}

const BlockPath::Piece* BlockPath::piece_at(std::uint32_t first, std::uint32_t last) const {
    const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), first,
                                        [](std::uint32_t f, const Piece& piece) { return f < piece.first; });
    return after != pieces_.begin() && std::prev(after)->last >= last ? &*std::prev(after) : nullptr;
}

BlockPath::Value BlockPath::at(double frame, std::span<double> values) const {
    const auto below = static_cast<std::uint32_t>(std::floor(frame));
    const auto above = static_cast<std::uint32_t>(std::ceil(frame));
    const Piece& piece = *piece_at(below, above);
    if (piece.count > 0) {
        const auto last = piece.nodes.begin() + piece.count;
        const double error = interpolate(std::span(piece.nodes).first(piece.count), frame, values);
        return {error + static_cast<double>(piece.error),
                below == above && std::find(piece.nodes.begin(), last, below) != last};
    }
    if (below == above) return {interpolate(std::array{below}, frame, values), true};
    return {interpolate(std::array{below, above}, frame, values), false};
}

std::size_t BlockPath::bytes() const {
    return sizeof(BlockPath) + samples_.capacity() * sizeof(Sample) + values_.capacity() * sizeof(float) +
           pieces_.capacity() * sizeof(Piece);
}

} // namespace kinelux::motion
