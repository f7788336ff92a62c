#include "pcm/build/levels/poisson_pass.h"

#include "pcm/build/levels/cells.h"
#include "pcm/build/levels/poisson_loops.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pcm {
namespace {

constexpr float nowhere = 1e18f;
constexpr std::size_t few_points = 6;        // tested one by one
constexpr std::size_t few_in_block = 16384;  // a block's points: so few are all placed, a cell has one or two of them

using Four = float __attribute__((vector_size(16)));
using FourFlags = std::int32_t __attribute__((vector_size(16)));

Four four_at(const float* from)
{
    Four v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

bool any(FourFlags flags)
{
#if defined(__SSE2__)
    Four bits;
    std::memcpy(&bits, &flags, sizeof bits);
    return __builtin_ia32_movmskps(bits) != 0;
#else
    std::array<std::uint64_t, 2> halves;
    std::memcpy(halves.data(), &flags, sizeof halves);
    return (halves[0] | halves[1]) != 0;
#endif
}

Four larger(Four a, Four b) { return a < b ? b : a; }

}  // namespace

template <class Coord>
void PoissonPass<Coord>::NearPoints::make_room(std::size_t more)
{
    if (size + more + near_padding <= x.size()) return;
    for (auto* axis : {&x, &y, &z}) axis->resize(2 * (size + more) + 64);
    chosen.resize(x.size());
}

template <class Coord>
void PoissonPass<Coord>::NearPoints::fill(std::size_t multiple)
{
    while (size % multiple) add(nowhere, nowhere, nowhere, none);
}

template <class Coord>
PoissonPass<Coord>::PoissonPass(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size,
                                const std::vector<std::uint32_t>& own, const std::vector<Point<Coord>>& others)
    : points_(points),
      lattice_(lattice),
      size_(size),
      bucket_bits_(bucket_bits(lattice)),
      own_(own),
      cell_(all_shifts(lattice, size)),
      bucket_(all_shifts(lattice, size + bucket_bits_)),
      block_(all_shifts(lattice, size + block_bits)),
      table_(std::size_t(1) << table_bits_),
      taken_(std::size_t(1) << (3 * block_bits - 6)),
      loops_(poisson_loops())
{
    const double spacing = lattice.spacing(size);
    squared_spacing_ = spacing * spacing;
    for (std::size_t a = 0; a < 3; ++a) {
        squared_scale_[a] = lattice.scale[a] * lattice.scale[a];
        unit_[a] = lattice.scale[a] / spacing;
    }
    for (std::size_t n = 0; n < 27; ++n) bucket_steps_[n] = ((n / 9) * side + n / 3 % 3) * side + n % 3;
    const std::size_t along = ((std::size_t(1) << block_bits) - 1) >> bucket_bits_ << bucket_bits_;
    bucket_mask_ = along | along << block_bits | along << (2 * block_bits);
    chosen_.reserve(own.size() + others.size());
    for (const std::uint32_t i : own) add(points_[i]);
    for (const Point<Coord>& p : others) add(p);
}

template <class Coord>
std::size_t PoissonPass<Coord>::slot(const Point<Coord>& block) const
{
    std::size_t i = hash_of(block, table_bits_);
    while (table_[i].used() && !same(table_[i].at, block)) i = (i + 1) & (table_.size() - 1);
    return i;
}

template <class Coord>
void PoissonPass<Coord>::grow()
{
    std::vector<Block> old(table_.size() * 2);
    old.swap(table_);
    ++table_bits_;
    for (const Block& block : old)
        if (block.used()) table_[slot(block.at)] = block;
}

template <class Coord>
std::uint32_t PoissonPass<Coord>::add(const Point<Coord>& p)
{
    const Point<Coord> at = cell_of(p, block_);
    std::size_t i = last_slot_;  // points come in Morton order
    if (!table_[i].used() || !same(table_[i].at, at)) i = slot(at);
    if (!table_[i].used()) {
        if (2 * ++used_ > table_.size()) {
            grow();
            i = slot(at);
        }
        table_[i].at = at;
    }
    last_slot_ = i;
    const std::uint64_t buckets = (std::uint64_t(1) << (block_bits - bucket_bits_)) - 1;
    bool core = true;
    for (std::size_t a = 0; a < 3; ++a) core = core && ((down(p[a], bucket_[a]) + 1) & buckets) >= 2;
    std::uint32_t& head = core ? table_[i].core : table_[i].rim;
    chosen_.push_back({p, head});
    return head = static_cast<std::uint32_t>(chosen_.size() - 1);
}

template <class Coord>
float PoissonPass<Coord>::relative(Coord c, std::size_t axis) const
{
    double steps;
    if constexpr (sizeof(Coord) == 4)
        steps = static_cast<double>(static_cast<std::int64_t>(c) - static_cast<std::int64_t>(origin_[axis]));
    else
        steps = c >= origin_[axis] ? static_cast<double>(c - origin_[axis]) : -static_cast<double>(origin_[axis] - c);
    return static_cast<float>(steps * unit_[axis]);
}

// The index in taken_ of the cell of a point in the current block.
template <class Coord>
std::size_t PoissonPass<Coord>::cell_at(const Point<Coord>& p) const
{
    constexpr std::uint64_t mask = (std::uint64_t(1) << block_bits) - 1;
    std::uint64_t index = 0;
    for (std::size_t a = 3; a-- > 0;) index = index << block_bits | (down(p[a], cell_[a]) & mask);
    return index;
}

template <class Coord>
void PoissonPass<Coord>::add_local(std::uint32_t chosen)
{
    const Point<Coord>& p = chosen_[chosen].point;
    const std::uint64_t buckets = (std::uint64_t(1) << (block_bits - bucket_bits_)) + 2;
    std::array<std::uint64_t, 3> along;
    for (std::size_t a = 0; a < 3; ++a) {
        along[a] = down(p[a], bucket_[a]) - down(origin_[a], bucket_[a]) + 1;
        if (along[a] >= buckets) return;
    }
    const std::size_t row = along[2] * side + along[1], bucket = row * side + along[0];
    const std::uint32_t bit = 1u << along[0];
    local_.push_back(
        {relative(p[0], 0), relative(p[1], 1), relative(p[2], 2), chosen, rows_[row] & bit ? heads_[bucket] : none});
    heads_[bucket] = static_cast<std::uint32_t>(local_.size() - 1);
    rows_[row] |= bit;
}

template <class Coord>
void PoissonPass<Coord>::enter_block(const Point<Coord>& p)
{
    const Point<Coord> at = cell_of(p, block_);
    // The cell of a point that is not in the first one is less than 64 bits wide.
    for (std::size_t a = 0; a < 3; ++a)
        origin_[a] = at[a] ? static_cast<Coord>(static_cast<std::uint64_t>(at[a]) << block_[a]) : 0;
    local_.clear();
    rows_.fill(0);
    std::fill(taken_.begin(), taken_.end(), 0);
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                if (!x && !y && !z) continue;
                const Point<Coord> adjacent{static_cast<Coord>(at[0] + static_cast<Coord>(x)),
                                            static_cast<Coord>(at[1] + static_cast<Coord>(y)),
                                            static_cast<Coord>(at[2] + static_cast<Coord>(z))};
                for (std::uint32_t n = table_[slot(adjacent)].rim; n != none; n = chosen_[n].next) add_local(n);
            }
    const Block& own = table_[slot(at)];
    for (const std::uint32_t head : {own.rim, own.core})
        for (std::uint32_t n = head; n != none; n = chosen_[n].next) {
            add_local(n);
            const std::size_t cell = cell_at(chosen_[n].point);
            taken_[cell / 64] |= std::uint64_t(1) << cell % 64;
        }
}

// The points in the bucket of a cell and in those adjacent to it.
template <class Coord>
auto PoissonPass<Coord>::gather(std::size_t cell) -> Range
{
    near_.size = 0;
    near_.make_room(local_.size());
    constexpr std::size_t mask = (std::size_t(1) << block_bits) - 1;
    const std::size_t x = (cell & mask) >> bucket_bits_, y = (cell >> block_bits & mask) >> bucket_bits_,
                      z = cell >> (2 * block_bits) >> bucket_bits_;
    const std::size_t corner_row = z * side + y, corner = corner_row * side + x;
    std::uint32_t used = 0;  // one bit per bucket
    for (std::size_t n = 0; n < 9; ++n) used |= (rows_[corner_row + bucket_steps_[3 * n] / side] >> x & 7) << (3 * n);
    float *const to_x = near_.x.data(), *const to_y = near_.y.data(), *const to_z = near_.z.data();
    std::uint32_t* const to_chosen = near_.chosen.data();
    const Local* const local = local_.data();
    std::size_t size = 0;
    for (; used; used &= used - 1) {
        const std::size_t bucket = corner + bucket_steps_[static_cast<std::size_t>(__builtin_ctz(used))];
        for (std::uint32_t n = heads_[bucket]; n != none; n = local[n].next) {
            to_x[size] = local[n].x;
            to_y[size] = local[n].y;
            to_z[size] = local[n].z;
            to_chosen[size++] = local[n].chosen;
        }
    }
    near_.size = size;
    const Range near{0, near_.size};
    near_.fill(near_padding);
    return near;
}

template <class Coord>
bool PoissonPass<Coord>::covered(const Point<Coord>& p, Range near)
{
    const float px = relative(p[0], 0), py = relative(p[1], 1), pz = relative(p[2], 2);
    const Four x{px, px, px, px}, y{py, py, py, py}, z{pz, pz, pz, pz};
    const auto four_cover = [&](std::size_t n) {
        const Four dx = four_at(&near_.x[n]) - x, dy = four_at(&near_.y[n]) - y, dz = four_at(&near_.z[n]) - z;
        const Four squared = dx * dx + dy * dy + dz * dz;
        if (any(squared < surely_inside)) return true;
        if (!any(squared < surely_outside)) return false;
        for (std::size_t k = 0; k < 4; ++k)
            if (squared[k] < surely_outside &&
                squared_distance(p, chosen_[near_.chosen[n + k]].point, squared_scale_) < squared_spacing_)
                return true;
        return false;
    };
    if (hint_ >= near.from && hint_ < near.to && four_cover(hint_)) return true;
    for (std::size_t n = near.from; n < near.to; n += 4)
        if (four_cover(n)) {
            hint_ = n;
            return true;
        }
    return false;
}

template <class Coord>
std::size_t PoissonPass<Coord>::first_free(std::size_t i, std::size_t end) const
{
    if (barred_)
        while (i < end && barred_[i] <= size_) ++i;
    return i;
}

template <class Coord>
std::size_t PoissonPass<Coord>::first_uncovered(std::size_t i, std::size_t end, int size, Range near)
{
    if (near.from == near.to) return first_free(i, end);
    if (end - i <= few_points || size == 0) {
        Point<Coord> last{};
        bool tested = false;
        for (; i < end; ++i) {
            const Point<Coord> p = points_[i];
            if (tested && same(p, last)) continue;
            if (barred_ && barred_[i] <= size_) continue;
            if (!covered(p, near)) return i;
            last = p;
            tested = true;
        }
        return end;
    }
    // The cell's box, and the minimum and maximum distance that its points can have to a chosen point.
    std::array<int, 3> shifts = lattice_.shifts(size);
    const Point<Coord> cell = cell_of(points_[i], shifts);
    std::array<float, 3> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = relative(static_cast<Coord>(static_cast<std::uint64_t>(cell[a]) << shifts[a]), a);
        high[a] = low[a] + static_cast<float>(std::ldexp(unit_[a], shifts[a]));
    }
    const std::size_t kept = near_.size;
    near_.make_room(near.to - near.from);
    for (std::size_t n = near.from; n < near.to; n += 4) {  // what fills the last four is far away
        const std::array<Four, 3> at{four_at(&near_.x[n]), four_at(&near_.y[n]), four_at(&near_.z[n])};
        Four nearest{}, farthest{};
        for (std::size_t a = 0; a < 3; ++a) {
            const Four below = low[a] - at[a], above = at[a] - high[a];
            const Four gap = larger(Four{}, larger(below, above));
            const Four reach = larger(larger(below, -below), larger(above, -above));
            nearest += gap * gap;
            farthest += reach * reach;
        }
        if (any(farthest < surely_inside)) {
            near_.size = kept;
            return end;
        }
        if (!any(nearest < surely_outside)) continue;
        for (std::size_t k = 0; k < 4; ++k)
            if (nearest[k] < surely_outside) near_.add(at[0][k], at[1][k], at[2][k], near_.chosen[n + k]);
    }
    const Range left{kept, near_.size};
    near_.fill(4);
    std::size_t found = end;
    if (left.from == left.to) {
        found = first_free(i, end);
    } else {
        shifts = lattice_.shifts(size - 1);
        while (i < end) {
            const std::size_t part = points_.end_of_cell(i, end, shifts);
            found = first_uncovered(i, part, size - 1, left);
            if (found < part) break;
            i = part;
            found = end;
        }
    }
    near_.size = kept;
    return found;
}

template <class Coord>
std::vector<std::uint32_t> PoissonPass<Coord>::run(const std::vector<std::uint8_t>& barred)
{
    barred_ = barred.empty() ? nullptr : barred.data();
    found_.clear();
    const auto block_shifts = lattice_.shifts(size_ + block_bits);
    const bool can_place = *std::max_element(block_.begin(), block_.end()) < static_cast<int>(8 * sizeof(Coord));
    const std::size_t count = points_.size();
    std::size_t own = 0, end = 0;
    for (std::size_t i = 0; i < count; i = end) {
        end = points_.end_of_cell(i, count, block_shifts);
        const std::size_t own_before = own;
        while (own < own_.size() && own_[own] < end) ++own;
        if (own - own_before == end - i) continue;  // nothing to choose
        enter_block(points_[i]);
        if (can_place && !barred_ && end - i <= few_in_block)
            choose_by_points(i, end);
        else
            choose_by_cells(i, end);
    }
    return std::move(found_);
}

// Chooses a point of the current block, and adds it to those near the current bucket.
template <class Coord>
void PoissonPass<Coord>::choose(std::size_t i, std::size_t cell, Range& near)
{
    found_.push_back(static_cast<std::uint32_t>(i));
    taken_[cell / 64] |= std::uint64_t(1) << cell % 64;
    add_local(add(points_[i]));
    near_.size = near.to;
    near_.make_room(1);
    near_.add(local_.back().x, local_.back().y, local_.back().z, local_.back().chosen);
    near.to = near_.size;
    near_.fill(near_padding);
}

template <class Coord>
void PoissonPass<Coord>::choose_by_cells(std::size_t i, std::size_t end)
{
    const auto cell_shifts = lattice_.shifts(size_);
    std::size_t bucket = none;
    Range near{0, 0};
    for (std::size_t next; i < end; i = next) {
        const Point<Coord> p = points_[i];
        next = points_.end_of_cell(i, end, cell_shifts);
        const std::size_t cell = cell_at(p);
        if (taken_[cell / 64] >> cell % 64 & 1) continue;
        if (bucket != (cell & bucket_mask_)) {
            bucket = cell & bucket_mask_;
            near = gather(cell);
        }
        const std::size_t first = first_uncovered(i, next, size_, near);
        if (first != next) choose(first, cell, near);
    }
}

// The same where cells hold a few points: a point is chosen when its cell has none yet and nothing covers it.
template <class Coord>
void PoissonPass<Coord>::choose_by_points(std::size_t i, std::size_t end)
{
    std::size_t bucket = none;
    Range near{0, 0};
    while (i < end) {
        const std::size_t first = i;
        i = std::min(end, (first / sorted_block + 1) * sorted_block);
        place(first, i - first);
        for (std::size_t n = 0, count = i - first; n < count;) {
            const OpenPoint open = loops_.first_open(placed_, n, count, taken_.data(), bucket, bucket_mask_,
                                                     {near_.x.data(), near_.y.data(), near_.z.data(), near.to});
            n = open.index;
            if (n == count) break;
            const std::size_t cell = placed_.cell[n];
            if (bucket != (cell & bucket_mask_)) {
                bucket = cell & bucket_mask_;
                near = gather(cell);
                continue;
            }
            if (open.is_sure || !covered(points_[first + n], near)) choose(first + n, cell, near);
            ++n;
        }
    }
}

template <class Coord>
void PoissonPass<Coord>::place(std::size_t first, std::size_t count)
{
    const Point<Coord>* const points = &points_[first];  // one block of the sorted points
    const auto steps = [&](std::size_t i, std::size_t a) {
        return static_cast<double>(static_cast<std::make_signed_t<Coord>>(points[i][a] - origin_[a])) * unit_[a];
    };
    constexpr Coord mask = (Coord(1) << block_bits) - 1;
    for (std::size_t i = 0; i < count; ++i) {
        placed_.x[i] = static_cast<float>(steps(i, 0));
        placed_.y[i] = static_cast<float>(steps(i, 1));
        placed_.z[i] = static_cast<float>(steps(i, 2));
        placed_.cell[i] = static_cast<std::uint16_t>((points[i][0] >> cell_[0] & mask) |
                                                     (points[i][1] >> cell_[1] & mask) << block_bits |
                                                     (points[i][2] >> cell_[2] & mask) << (2 * block_bits));
    }
}

template <class Coord>
void PoissonPass<Coord>::mark(std::vector<std::uint8_t>& barred)
{
    const auto block_shifts = lattice_.shifts(size_ + block_bits);
    const std::size_t count = points_.size();
    std::size_t end = 0;
    for (std::size_t i = 0; i < count; i = end) {
        end = points_.end_of_cell(i, count, block_shifts);
        enter_block(points_[i]);
        if (local_.empty()) continue;
        std::size_t bucket = none;
        Range near{0, 0};
        for (; i < end; ++i) {
            const Point<Coord> p = points_[i];
            const std::size_t cell = cell_at(p);
            if (bucket != (cell & bucket_mask_)) {
                bucket = cell & bucket_mask_;
                near = gather(cell);
            }
            if (covered(p, near)) barred[i] = static_cast<std::uint8_t>(size_);
        }
    }
}

template class PoissonPass<std::uint32_t>;
template class PoissonPass<std::uint64_t>;

}  // namespace pcm
