// Points so far from the others that a grid that reaches them would put the others on each other: no-data values such
// as 3.4e38 among coordinates of a few hundred.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// Watches all positions of a cloud, in bounded memory: points are counted by the power of two of their largest
// coordinate. One thread.
class FarPoints {
public:
    // A batch of doubles. Points without a finite position are ignored.
    void watch(const PointBatch& batch);
    void watch(const Vec3d& p);
    // Adds what another one has watched, as if its points came after these.
    void merge(const FarPoints& later);
    void save(ByteWriter& out) const;
    static FarPoints load(ByteReader& in);

    const Box3d& box() const { return box_; }  // box of all points
    std::uint64_t points() const { return watched_; }
    // The power of two above the largest coordinates of most points; 0 without points.
    double usual_magnitude() const;

    struct Finding {
        std::uint64_t points = 0;  // number of points that are too far away
        Vec3d first{};             // the first of them that was watched
        double step = 0;           // step of a grid that reaches them, source units
        double spacing = 0;        // about the distance between neighbours among the other points
        double limit = 0;          // all other points have their coordinates within -limit and limit
    };

    // The steps, along each axis, of a grid that reaches all points of a box.
    using Steps = std::function<Vec3d(const Box3d& box)>;

    // Leaves out the farthest points until steps are no wider than a quarter of the distance between the neighbours of
    // any group of points near the origin. That distance is taken to be the diagonal of the group's box over the square
    // root of its number, as for points on a surface. Points are left out only if they are few relative to the others
    // or lie on a few places, as no-data values do; else it is the group at the origin that is odd, such as rounding
    // errors around 0. Absent when nothing is to be left out.
    std::optional<Finding> find(const Steps& steps) const;

    // Throws Error(invalid_argument) with counts, an example and the way out when there are such points. `what` is
    // where the positions are to be stored: "a tree".
    void refuse(const Steps& steps, const std::string& what) const;

    // The diagonal of a box over the square root of the number of points in it.
    static double mean_spacing(const Box3d& box, std::uint64_t points);

private:
    using Place = std::array<std::int16_t, 3>;  // in 64ths of the group's power of two
    static constexpr std::size_t few_places = 16;

    struct Group {
        std::uint64_t points = 0;
        Box3d box;
        double least = 0;  // smallest of the points' largest coordinates
        Vec3d first{};
        std::uint64_t first_number = 0;
        std::vector<Place> places;  // at most few_places + 1
        void see(const Place& place);
    };
    // Consecutive groups together.
    struct Union {
        std::uint64_t points = 0;
        Box3d box;
        std::size_t places = 0;
        void add(const Group& group);
    };

    std::map<int, Group> groups_;  // keyed by the exponent of the largest coordinate
    Group* last_ = nullptr;        // the group of the point before
    int last_exponent_ = 0;
    Box3d box_;
    std::uint64_t watched_ = 0;
};

// "leave them out with --largest-coordinate 1000": for hints.
std::string way_to_leave_out(double limit);

}  // namespace pcm
