#include "pcm/tree/level_cubes.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

constexpr double room = 1e-6;  // for rounding, in sides
// Blocks of 4 x 4 x 4 cubes lie together in memory: neighbours are in few of them.
constexpr unsigned block_bits = 2;
constexpr std::int64_t in_block = (1 << block_bits) - 1;
constexpr std::size_t slots_a_block = std::size_t(1) << (3 * block_bits);
constexpr std::array<int, 5> steps{0, -1, 1, -2, 2};  // the nearest first

// The square of the distance, in sides, from a place at `inside` of its cube to the cube that is `step` cubes further.
double squared_gap(double inside, int step)
{
    if (step == 0) return 0;
    const double gap = std::max(0.0, (step > 0 ? step - inside : inside - step - 1) - room);
    return gap * gap;
}

}  // namespace

LevelCubes::LevelCubes(const std::vector<Vec3i>& points, const Vec3i& base, const Vec3d& scale, double side)
    : base_(base), points_(points.size())
{
    side *= 1 + room;
    squared_side_ = side * side;
    for (std::size_t a = 0; a < 3; ++a) {
        sides_per_step_[a] = scale[a] / side;
        squared_scale_[a] = scale[a] * scale[a];
    }
    // On a surface a block has some sixteen points.
    while (blocks_ * 16 < points.size()) blocks_ *= 2;
    begin_.assign(blocks_ * slots_a_block + 1, 0);
    std::vector<std::uint32_t> slots(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::array<std::int64_t, 3> cube = place_of(points[i]).cube;
        slots[i] = static_cast<std::uint32_t>(slot_of(cube[0], cube[1], cube[2]));
        ++begin_[slots[i] + 1];
    }
    for (std::size_t s = 1; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
    for (std::size_t i = points.size(); i-- > 0;) points_[--begin_[slots[i] + 1]] = points[i];
    // Each entry is the begin of its slot now, one place too late.
    begin_.erase(begin_.begin());
    begin_.push_back(static_cast<std::uint32_t>(points.size()));
}

LevelCubes::Place LevelCubes::place_of(const Vec3i& p) const
{
    Place place;
    for (std::size_t a = 0; a < 3; ++a) {
        const double at =
            static_cast<double>(p[a] - base_[a]) * sides_per_step_[a] + 8;  // positive: cut is rounded down
        place.cube[a] = static_cast<std::int64_t>(at);
        place.inside[a] = at - static_cast<double>(place.cube[a]);
    }
    return place;
}

std::size_t LevelCubes::slot_of(std::int64_t x, std::int64_t y, std::int64_t z) const
{
    std::uint64_t hash = static_cast<std::uint64_t>(x >> block_bits) * 0x9E3779B97F4A7C15u;
    hash = (hash ^ static_cast<std::uint64_t>(y >> block_bits)) * 0x9E3779B97F4A7C15u;
    hash = (hash ^ (hash >> 32) ^ static_cast<std::uint64_t>(z >> block_bits)) * 0x9E3779B97F4A7C15u;
    const std::size_t block = (hash >> 32) & (blocks_ - 1);
    const auto within =
        static_cast<std::size_t>(((z & in_block) << 2 * block_bits) | ((y & in_block) << block_bits) | (x & in_block));
    return block * slots_a_block + within;
}

template <class Best, class Visit>
void LevelCubes::search(const Vec3i& p, const Best& best, const Visit& visit) const
{
    const Place place = place_of(p);
    std::array<std::array<double, 5>, 3> gaps;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t s = 0; s < 5; ++s) gaps[a][s] = squared_gap(place.inside[a], steps[s]) * squared_side_;
    for (std::size_t z = 0; z < 5; ++z) {
        if (gaps[2][z] > best()) continue;
        for (std::size_t y = 0; y < 5; ++y) {
            const double across = gaps[2][z] + gaps[1][y];
            if (across > best()) continue;
            for (std::size_t x = 0; x < 5; ++x) {
                if (across + gaps[0][x] > best()) continue;
                const std::size_t slot =
                    slot_of(place.cube[0] + steps[x], place.cube[1] + steps[y], place.cube[2] + steps[z]);
                for (std::uint32_t i = begin_[slot]; i < begin_[slot + 1]; ++i)
                    if (!visit(points_[i])) return;
            }
        }
    }
}

double LevelCubes::nearest(const Vec3i& p, bool is_one_of_them) const
{
    double best = infinity;
    bool skip = is_one_of_them;
    search(
        p, [&] { return best; },
        [&](const Vec3i& q) {
            const double squared = squared_distance(p, q, squared_scale_);
            if (squared == 0 && std::exchange(skip, false)) return true;
            best = std::min(best, squared);
            return true;
        });
    return best <= 4 * squared_side_ ? best : infinity;
}

bool LevelCubes::has_within(const Vec3i& p, double squared, Recent& recent) const
{
    for (std::size_t i = 0; i < recent.count; ++i)
        if (squared_distance(p, recent.points[i], squared_scale_) <= squared) {
            if (i > 0) std::swap(recent.points[i], recent.points[i - 1]);
            return true;
        }
    bool found = false;
    search(
        p, [&] { return squared; },
        [&](const Vec3i& q) {
            found = squared_distance(p, q, squared_scale_) <= squared;
            if (found) {
                std::rotate(recent.points.begin(), recent.points.end() - 1, recent.points.end());
                recent.points[0] = q;
                recent.count = std::min(recent.count + 1, recent.points.size());
            }
            return !found;
        });
    return found;
}

}  // namespace pcm
