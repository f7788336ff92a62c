// The points of a cloud at one level in cubes, for questions about their neighbours within two cubes.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Const members may be called from any thread.
class LevelCubes {
public:
    // Cubes of this side, source units, around the given points on a grid with these steps. `base` is a place on the
    // grid; no point, here or in a question, has a coordinate that is more than four cubes below it.
    LevelCubes(const std::vector<Vec3i>& points, const Vec3i& base, const Vec3d& scale, double side);

    // The square of the smallest distance from p to a point, exact; infinite when none is within two sides. Where p is
    // one of the points, that one does not count.
    double nearest(const Vec3i& p, bool is_one_of_them) const;

    // Whether a point lies within the square root of `squared` of p; may be false for distances beyond two sides.
    // `recent` keeps what was found last: points that ask one after another mostly have the same neighbours.
    struct Recent {
        std::array<Vec3i, 4> points;
        std::size_t count = 0;
    };
    bool has_within(const Vec3i& p, double squared, Recent& recent) const;

private:
    // The cube of a place, and how far inside it the place is, in sides.
    struct Place {
        std::array<std::int64_t, 3> cube;
        std::array<double, 3> inside;
    };
    Place place_of(const Vec3i& p) const;
    std::size_t slot_of(std::int64_t x, std::int64_t y, std::int64_t z) const;
    // Calls visit(point) for the points of the cubes that may be nearer than best(), squared, until it returns false.
    template <class Best, class Visit>
    void search(const Vec3i& p, const Best& best, const Visit& visit) const;

    Vec3i base_;
    Vec3d sides_per_step_{}, squared_scale_{};
    double squared_side_;
    std::size_t blocks_ = 1;            // a power of two
    std::vector<std::uint32_t> begin_;  // place of each slot's first point in points_; cubes far apart may share a slot
    std::vector<Vec3i> points_;         // sorted by slot
};

}  // namespace pcm
