// Included by one source per level of system/cpu.h. No inline function of another header is used: see there.
#pragma once

#include "pcm/fit/block_loops.h"
#include "pcm/system/vector_bytes.h"

#include <math.h>

namespace pcm {
namespace {

// Sums are kept in eight lanes, which vectors add at once, always in this order.
constexpr std::size_t lanes = 8;
struct Lanes {
    using Vector = double __attribute__((vector_size(vector_bytes)));
    static constexpr std::size_t width = vector_bytes / sizeof(double), vectors = lanes / width;
    Vector v[vectors];

    explicit Lanes(double all = 0)
    {
        for (Vector& part : v) part = Vector{} + all;
    }
    explicit Lanes(const double* from)
    {
        for (std::size_t k = 0; k < vectors; ++k) __builtin_memcpy(&v[k], from + k * width, sizeof v[k]);
    }
    void operator+=(const Lanes& other)
    {
        for (std::size_t k = 0; k < vectors; ++k) v[k] += other.v[k];
    }
    void operator*=(const Lanes& other)
    {
        for (std::size_t k = 0; k < vectors; ++k) v[k] *= other.v[k];
    }
    void add_product(const Lanes& a, const Lanes& b)
    {
        for (std::size_t k = 0; k < vectors; ++k) v[k] += a.v[k] * b.v[k];
    }
    // The squares, at most `most`, to `sums`, and how many are not above it.
    void add_squares(const Lanes& most, Lanes& sums, Lanes& counts) const
    {
        for (std::size_t k = 0; k < vectors; ++k) {
            const Vector square = v[k] * v[k];
            sums.v[k] += square < most.v[k] ? square : most.v[k];
            counts.v[k] += square <= most.v[k] ? Vector{} + 1.0 : Vector{};
        }
    }
    void take_larger(const Lanes& other)
    {
        for (std::size_t k = 0; k < vectors; ++k) v[k] = other.v[k] > v[k] ? other.v[k] : v[k];
    }
    // Each (value - shift) times a factor.
    void shift(const Lanes& by, const Lanes& factor)
    {
        for (std::size_t k = 0; k < vectors; ++k) v[k] = (v[k] - by.v[k]) * factor.v[k];
    }
    void take_larger_size(const Lanes& other)
    {
        for (std::size_t k = 0; k < vectors; ++k) {
            const Vector size = other.v[k] < 0 ? -other.v[k] : other.v[k];
            v[k] = size > v[k] ? size : v[k];
        }
    }
    void add(std::size_t lane, double value) { v[lane / width][lane % width] += value; }
    double at(std::size_t lane) const { return v[lane / width][lane % width]; }
    double total() const { return ((at(0) + at(4)) + (at(2) + at(6))) + ((at(1) + at(5)) + (at(3) + at(7))); }
};

struct PlaneLoops {
    static void distances(const ShapeNumbers& shape, const double* x, const double* y, const double* z,
                          std::size_t count, double* out)
    {
        const double px = shape.point[0], py = shape.point[1], pz = shape.point[2];
        const double nx = shape.axis[0], ny = shape.axis[1], nz = shape.axis[2];
        for (std::size_t i = 0; i < count; ++i) out[i] = nx * (x[i] - px) + ny * (y[i] - py) + nz * (z[i] - pz);
    }

    static void differentiate(const PatchNumbers& patch, const double* x, const double* y, const double* z,
                              std::size_t count, PatchBlock& out)
    {
        const PatchNumbers p = patch;
        for (std::size_t i = 0; i < count; ++i) {
            const double dx = x[i] - p.place[0], dy = y[i] - p.place[1], dz = z[i] - p.place[2];
            out.distance[i] = p.n[0] * dx + p.n[1] * dy + p.n[2] * dz;
            out.by[0][i] = -1;
            out.by[1][i] = p.b[0] * dx + p.b[1] * dy + p.b[2] * dz;     // turned about a
            out.by[2][i] = -(p.a[0] * dx + p.a[1] * dy + p.a[2] * dz);  // turned about b
        }
    }
};

struct CylinderLoops {
    static void distances(const ShapeNumbers& shape, const double* x, const double* y, const double* z,
                          std::size_t count, double* out)
    {
        const ShapeNumbers s = shape;
        for (std::size_t i = 0; i < count; ++i) {
            const double dx = x[i] - s.point[0], dy = y[i] - s.point[1], dz = z[i] - s.point[2];
            const double cx = s.axis[1] * dz - s.axis[2] * dy, cy = s.axis[2] * dx - s.axis[0] * dz,
                         cz = s.axis[0] * dy - s.axis[1] * dx;
            out[i] = sqrt(cx * cx + cy * cy + cz * cz) - s.radius;
        }
    }

    static void differentiate(const PatchNumbers& patch, const double* x, const double* y, const double* z,
                              std::size_t count, PatchBlock& out)
    {
        const PatchNumbers p = patch;
        const double k = p.curvature;
        for (std::size_t i = 0; i < count; ++i) {
            const double dx = x[i] - p.place[0], dy = y[i] - p.place[1], dz = z[i] - p.place[2];
            const double en = p.n[0] * dx + p.n[1] * dy + p.n[2] * dz, eb = p.b[0] * dx + p.b[1] * dy + p.b[2] * dz,
                         ea = p.a[0] * dx + p.a[1] * dy + p.a[2] * dz;
            const double square = en * en + eb * eb;
            const double q = 2 * en + k * square, inside = 1 + k * q, w = sqrt(inside > 1e-24 ? inside : 1e-24);
            const double one = 1 / (1 + w), inverse = 1 / w;
            const double gn = (1 + k * en) * inverse, gb = k * eb * inverse;  // the gradient
            out.distance[i] = q * one;
            out.by[0][i] = -gn;
            out.by[1][i] = eb * gn - en * gb;  // turned about a
            out.by[2][i] = ea * gb;            // about n
            out.by[3][i] = -ea * gn;           // about b
            out.by[4][i] = (square * (1 + w) - q * (en + k * square) * inverse) * one * one;
        }
    }
};

struct SphereLoops {
    static void distances(const ShapeNumbers& shape, const double* x, const double* y, const double* z,
                          std::size_t count, double* out)
    {
        const ShapeNumbers s = shape;
        for (std::size_t i = 0; i < count; ++i) {
            const double dx = x[i] - s.point[0], dy = y[i] - s.point[1], dz = z[i] - s.point[2];
            out[i] = sqrt(dx * dx + dy * dy + dz * dz) - s.radius;
        }
    }

    static void differentiate(const PatchNumbers& patch, const double* x, const double* y, const double* z,
                              std::size_t count, PatchBlock& out)
    {
        const PatchNumbers p = patch;
        const double k = p.curvature;
        for (std::size_t i = 0; i < count; ++i) {
            const double dx = x[i] - p.place[0], dy = y[i] - p.place[1], dz = z[i] - p.place[2];
            const double along = p.n[0] * dx + p.n[1] * dy + p.n[2] * dz, square = dx * dx + dy * dy + dz * dz;
            const double q = 2 * along + k * square, inside = 1 + k * q, w = sqrt(inside > 1e-24 ? inside : 1e-24);
            const double one = 1 / (1 + w), inverse = 1 / w;
            out.distance[i] = q * one;
            out.by[0][i] = -(1 + k * along) * inverse;
            out.by[1][i] = (p.b[0] * dx + p.b[1] * dy + p.b[2] * dz) * inverse;
            out.by[2][i] = -(p.a[0] * dx + p.a[1] * dy + p.a[2] * dz) * inverse;
            out.by[3][i] = (square * (1 + w) - q * (along + k * square) * inverse) * one * one;
        }
    }
};

double largest(const double* values, std::size_t count, double shift)
{
    Lanes found;
    const Lanes by(shift), one(1);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        Lanes some(values + i);
        some.shift(by, one);
        found.take_larger_size(some);
    }
    double all = 0;
    for (std::size_t lane = 0; lane < lanes; ++lane) all = found.at(lane) > all ? found.at(lane) : all;
    for (; i < count; ++i) all = fabs(values[i] - shift) > all ? fabs(values[i] - shift) : all;
    return all;
}

double sum_scaled(const double* values, std::size_t count, double factor)
{
    Lanes sums;
    const Lanes each(factor);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) sums.add_product(Lanes(values + i), each);
    for (; i < count; ++i) sums.add(i % lanes, values[i] * factor);
    return sums.total();
}

double sum_products(const double* a, const double* b, std::size_t count, double shift_a, double shift_b, double factor)
{
    Lanes sums;
    const Lanes by_a(shift_a), by_b(shift_b), each(factor);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        Lanes of_a(a + i), of_b(b + i);
        of_a.shift(by_a, each);
        of_b.shift(by_b, each);
        sums.add_product(of_a, of_b);
    }
    for (; i < count; ++i) sums.add(i % lanes, (a[i] - shift_a) * factor * ((b[i] - shift_b) * factor));
    return sums.total();
}

void score(const double* distances, std::size_t count, double limit, double* squares, double* near)
{
    Lanes sums, counts;
    const Lanes most(limit);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) Lanes(distances + i).add_squares(most, sums, counts);
    for (; i < count; ++i) {
        const double square = distances[i] * distances[i];
        sums.add(i % lanes, square < limit ? square : limit);
        counts.add(i % lanes, square <= limit ? 1 : 0);
    }
    *squares = sums.total();
    *near = counts.total();
}

double sum_of(const double* values, std::size_t count)
{
    Lanes sums;
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) sums += Lanes(values + i);
    for (; i < count; ++i) sums.add(i % lanes, values[i]);
    return sums.total();
}

double within(const PatchBlock& block, std::size_t count, double threshold, BlockWeights& weights)
{
    for (std::size_t i = 0; i < count; ++i) weights.within[i] = fabs(block.distance[i]) <= threshold ? 1 : 0;
    return sum_of(weights.within, count);
}

void weigh_alike(const PatchBlock& block, std::size_t count, double beyond, BlockWeights& weights)
{
    for (std::size_t i = 0; i < count; ++i) {
        const double d = block.distance[i];
        weights.weight[i] = weights.slope[i] = weights.within[i];
        weights.cost[i] = weights.within[i] > 0 ? d * d : beyond;
    }
}

void take_part(const double* support, std::size_t count, BlockWeights& weights)
{
    if (!support) return;
    for (std::size_t i = 0; i < count; ++i) weights.within[i] *= support[i];
}

// The cost is twice the integral of weight times distance.
void weigh_tapered(const PatchBlock& block, std::size_t count, double from, double threshold, const double* support,
                   BlockWeights& weights)
{
    take_part(support, count, weights);
    const double width = threshold - from, per_width = 1 / width;
    const double beyond = from * from + 2 * width * (from * (1 - 2.0 / 3 + 0.2) + width / 6);
    for (std::size_t i = 0; i < count; ++i) {
        const double away = fabs(block.distance[i]), part = weights.within[i];
        const double past = away - from, u = past > 0 ? (past < width ? past * per_width : 1) : 0,
                     before = away < from ? away : from;
        const double square = u * u, rest = 1 - square, weight = rest * rest;
        weights.weight[i] = part * weight;
        weights.slope[i] = part * (weight - 4 * u * rest * per_width * away);
        const double cost = before * before + 2 * width * u *
                                                  (from * (1 - square * (2.0 / 3 - 0.2 * square)) +
                                                   width * u * (0.5 - square * (0.5 - square * (1.0 / 6))));
        weights.cost[i] = part * cost + (1 - part) * beyond;
    }
}

void weigh(const PatchBlock& block, std::size_t count, const WeightTable& table, const double* support,
           BlockWeights& weights)
{
    const double *rows = table.rows, *part_of = weights.within;
    const double step = table.step, per_length = table.per_length, last = table.size;
    const double beyond = rows[3 * table.size + 2];
    take_part(support, count, weights);
    for (std::size_t i = 0; i < count; ++i) {
        const double away = fabs(block.distance[i]), at = away * per_length;
        const auto k = static_cast<std::int32_t>(at < last ? at : last);
        const double weight = rows[3 * k], grows = rows[3 * k + 1];
        const double from = k * step, past = away - from, by = weight + past * grows, part = part_of[i];
        weights.weight[i] = part * by;
        weights.slope[i] = part * (by + away * grows);
        const double of_it =
            rows[3 * k + 2] + past * (2 * from * weight + past * (from * grows + weight + past * grows * (2.0 / 3)));
        weights.cost[i] = part * of_it + (1 - part) * beyond;
    }
}

void find_bins(const PatchBlock& block, std::size_t count, double threshold, std::int32_t bins, std::int32_t* to)
{
    const double last = bins, per_length = last / threshold;
    for (std::size_t i = 0; i < count; ++i) {
        const double at = fabs(block.distance[i]) * per_length;
        to[i] = static_cast<std::int32_t>(at < last ? at : last);
    }
}

double squares(const PatchBlock& block, const BlockWeights& weights, std::size_t count)
{
    Lanes sums;
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        Lanes part(weights.within + i);
        part *= Lanes(block.distance + i);
        sums.add_product(part, Lanes(block.distance + i));
    }
    for (; i < count; ++i) sums.add(i % lanes, weights.within[i] * block.distance[i] * block.distance[i]);
    return sums.total();
}

double cost(const BlockWeights& weights, std::size_t count) { return sum_of(weights.cost, count); }

// Row j of the products and of the gradient.
template <std::size_t parameters, std::size_t j>
void sum_row(const PatchBlock& block, const double* weight, std::size_t count, BlockSums& sums)
{
    Lanes gradient, products[parameters - j];
    for (std::size_t i = 0; i < count; i += lanes) {
        Lanes by(block.by[j] + i);
        by *= Lanes(weight + i);
        gradient.add_product(by, Lanes(block.distance + i));
        for (std::size_t k = j; k < parameters; ++k) products[k - j].add_product(by, Lanes(block.by[k] + i));
    }
    sums.gradient[j] = gradient.total();
    for (std::size_t k = j; k < parameters; ++k) sums.products[j * most_parameters + k] = products[k - j].total();
    if constexpr (j + 1 < parameters) sum_row<parameters, j + 1>(block, weight, count, sums);
}

void fill(double* values, std::size_t from, std::size_t to)
{
    for (std::size_t i = from; i < to; ++i) values[i] = 0;
}

void sum(PatchBlock& block, BlockWeights& weights, std::size_t count, std::size_t parameters, BlockSums& sums)
{
    const std::size_t full = (count + lanes - 1) / lanes * lanes;
    fill(block.distance, count, full);
    fill(weights.weight, count, full);
    fill(weights.slope, count, full);
    for (std::size_t j = 0; j < parameters; ++j) fill(block.by[j], count, full);
    Lanes used, slope, squares, pull;
    for (std::size_t i = 0; i < full; i += lanes) {
        const Lanes weight(weights.weight + i), distance(block.distance + i);
        Lanes weighted = weight;
        weighted *= distance;
        used += weight;
        slope += Lanes(weights.slope + i);
        squares.add_product(weighted, distance);
        pull.add_product(weighted, weighted);
    }
    sums.used = used.total();
    sums.slope = slope.total();
    sums.squares = squares.total();
    sums.pull = pull.total();
    switch (parameters) {
        case 3:
            return sum_row<3, 0>(block, weights.weight, full, sums);
        case 4:
            return sum_row<4, 0>(block, weights.weight, full, sums);
        case 5:
            return sum_row<5, 0>(block, weights.weight, full, sums);
        case 6:
            return sum_row<6, 0>(block, weights.weight, full, sums);
        default:
            return sum_row<most_parameters, 0>(block, weights.weight, full, sums);
    }
}

void facts(const PatchBlock& block, std::size_t count, std::size_t parameters, const double* inverse, double threshold,
           BlockFacts& to)
{
    alignas(64) double influence[patch_block] = {}, near[patch_block], outside[patch_block];
    for (std::size_t j = 0; j < parameters; ++j)
        for (std::size_t k = j; k < parameters; ++k) {
            const double factor = (k > j ? 2 : 1) * inverse[j * parameters + k];
            for (std::size_t i = 0; i < count; ++i) influence[i] += factor * block.by[j][i] * block.by[k][i];
        }
    for (std::size_t i = 0; i < count; ++i) {
        const double away = fabs(block.distance[i]);
        near[i] = away <= threshold ? 1 : 0;
        outside[i] = (away > 2 * threshold ? 1.0 : 0.0) * (away <= 4 * threshold ? 1.0 : 0.0);
        influence[i] = away <= threshold ? influence[i] : 0;
    }
    to.within += sum_of(near, count);
    to.around += sum_of(outside, count);
    to.sum += sum_of(influence, count);
    Lanes largest(to.largest);
    // Beyond the last one are zeros.
    for (std::size_t i = 0; i < count; i += lanes) largest.take_larger(Lanes(influence + i));
    for (std::size_t lane = 0; lane < lanes; ++lane)
        if (largest.at(lane) > to.largest) to.largest = largest.at(lane);
}

constexpr BlockLoops all_loops()
{
    return {{PlaneLoops::distances, PlaneLoops::differentiate},
            {CylinderLoops::distances, CylinderLoops::differentiate},
            {SphereLoops::distances, SphereLoops::differentiate},
            largest,
            sum_scaled,
            sum_products,
            score,
            within,
            weigh_alike,
            weigh_tapered,
            weigh,
            find_bins,
            sum,
            squares,
            cost,
            facts};
}

}  // namespace
}  // namespace pcm
