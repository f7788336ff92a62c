#include "pcm/filter/voxel_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcm {
namespace {

// Voxels with an estimate of the points in them.
struct Share {
    Box3i voxels;
    double points = 0;
};

Box3i voxels_of(const PointsInBoxes& cloud, const VoxelLattice& lattice, const Box3i& box)
{
    Box3i voxels;
    for (std::size_t a = 0; a < 3; ++a) {
        voxels.min[a] = lattice.index(cloud.source(box.min[a], a), a);
        voxels.max[a] = lattice.index(cloud.source(box.max[a], a), a);
    }
    return voxels;
}

// The leaves' points, and those of the inner nodes, which are spread over the leaves below.
std::vector<Share> shares_of(const PointsInBoxes& cloud, const VoxelLattice& lattice)
{
    const NodeTable& nodes = cloud.tree().nodes();
    std::vector<double> spread(nodes.size(), 0);
    std::vector<Share> shares;
    for (NodeId id = 0; id < nodes.size(); ++id) {
        const Node& node = nodes[id];
        const double points = spread[id] + node.points;
        double below = 0;
        for (const NodeId child : node.children)
            if (child != no_node) below += static_cast<double>(nodes[child].subtree_points);
        if (below > 0) {
            for (const NodeId child : node.children)
                if (child != no_node)
                    spread[child] = points * (static_cast<double>(nodes[child].subtree_points) / below);
        } else if (points > 0) {
            shares.push_back({voxels_of(cloud, lattice, node.box), points});
        }
    }
    return shares;
}

// Two boxes: the voxels below number `cut` of an axis, and the others.
std::pair<VoxelUnit, VoxelUnit> cut_unit(const VoxelUnit& unit, std::size_t axis, std::int64_t cut)
{
    std::pair<VoxelUnit, VoxelUnit> parts{unit, unit};
    parts.first.voxels.max[axis] = cut - 1;
    parts.second.voxels.min[axis] = cut;
    return parts;
}

// A cut that separates a single voxel from some of the others in its unit.
std::pair<VoxelUnit, VoxelUnit> cut_beside(const VoxelUnit& unit, const Vec3i& voxel)
{
    for (std::size_t a = 0; a < 3; ++a) {
        if (unit.voxels.min[a] < voxel[a]) return cut_unit(unit, a, voxel[a]);
        if (unit.voxels.max[a] > voxel[a]) return cut_unit(unit, a, voxel[a] + 1);
    }
    return {unit, unit};  // not reached: the unit has other voxels
}

std::size_t widest_axis(const Box3i& box)
{
    std::size_t widest = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (box.max[a] - box.min[a] > box.max[widest] - box.min[widest]) widest = a;
    return widest;
}

class Division {
public:
    Division(double most, std::vector<VoxelUnit>& units) : most_(most), units_(units) {}

    void divide(const VoxelUnit& unit, std::vector<Share> shares)
    {
        double points = 0;
        Box3i around;
        for (const Share& share : shares) {
            points += share.points;
            around.extend(share.voxels);
        }
        if (points <= most_ || unit.is_one()) {
            units_.push_back(unit);
            return;
        }
        const auto parts =
            around.min == around.max ? cut_beside(unit, around.min) : cut_at_median(unit, around, shares);
        std::vector<Share> lower, upper;
        for (Share& share : shares) part(share, parts, lower, upper);
        shares = {};
        divide(parts.first, std::move(lower));
        divide(parts.second, std::move(upper));
    }

private:
    static std::pair<VoxelUnit, VoxelUnit> cut_at_median(const VoxelUnit& unit, const Box3i& around,
                                                         std::vector<Share>& shares)
    {
        const std::size_t axis = widest_axis(around);
        const auto twice_centre = [axis](const Share& s) { return s.voxels.min[axis] + s.voxels.max[axis]; };
        std::sort(shares.begin(), shares.end(),
                  [&](const Share& a, const Share& b) { return twice_centre(a) < twice_centre(b); });
        double points = 0, before = 0;
        for (const Share& share : shares) points += share.points;
        std::size_t k = 0;
        while (k + 1 < shares.size() && before + shares[k].points < points / 2) before += shares[k++].points;
        // Between the voxels that are nearest to the centre of the share in the middle.
        const std::int64_t cut =
            shares[k].voxels.min[axis] + (shares[k].voxels.max[axis] - shares[k].voxels.min[axis] + 1) / 2;
        return cut_unit(unit, axis, std::clamp(cut, around.min[axis] + 1, around.max[axis]));
    }

    static void part(const Share& share, const std::pair<VoxelUnit, VoxelUnit>& parts, std::vector<Share>& lower,
                     std::vector<Share>& upper)
    {
        std::size_t axis = 0;
        while (parts.first.voxels.max[axis] == parts.second.voxels.max[axis]) ++axis;
        const std::int64_t cut = parts.second.voxels.min[axis];
        if (share.voxels.max[axis] < cut) return lower.push_back(share);
        if (share.voxels.min[axis] >= cut) return upper.push_back(share);
        Share one = share, other = share;
        one.voxels.max[axis] = cut - 1;
        other.voxels.min[axis] = cut;
        one.points *= static_cast<double>(cut - share.voxels.min[axis]) /
                      static_cast<double>(share.voxels.max[axis] - share.voxels.min[axis] + 1);
        other.points -= one.points;
        lower.push_back(one);
        upper.push_back(other);
    }

    const double most_;
    std::vector<VoxelUnit>& units_;
};

}  // namespace

std::vector<VoxelUnit> divide_into_units(const PointsInBoxes& cloud, const VoxelLattice& lattice, double points)
{
    std::vector<VoxelUnit> units;
    const TreeInfo& info = cloud.tree().info();
    if (info.points > 0)
        Division(points, units).divide({voxels_of(cloud, lattice, info.box)}, shares_of(cloud, lattice));
    return units;
}

Box3i grid_box_of(const PointsInBoxes& cloud, const VoxelLattice& lattice, const VoxelUnit& unit)
{
    const Box3i& box = cloud.tree().info().box;
    Box3i result;
    for (std::size_t a = 0; a < 3; ++a) {
        // The first position of the tree's box whose voxel has this number or a larger one.
        const auto first = [&](std::int64_t number) {
            std::int64_t begin = box.min[a], end = box.max[a] + 1;
            while (begin < end) {
                const std::int64_t middle = begin + (end - begin) / 2;
                if (lattice.index(cloud.source(middle, a), a) >= number)
                    end = middle;
                else
                    begin = middle + 1;
            }
            return begin;
        };
        result.min[a] = first(unit.voxels.min[a]);
        result.max[a] = first(unit.voxels.max[a] + 1) - 1;
    }
    return result;
}

std::pair<VoxelUnit, VoxelUnit> divide_unit(const VoxelUnit& unit, const VoxelLattice& lattice,
                                            const std::vector<Vec3d>& points)
{
    Box3d box;
    for (const Vec3d& p : points) box.extend(p);
    Box3i around;
    for (std::size_t a = 0; a < 3; ++a) {
        around.min[a] = lattice.index(box.min[a], a);
        around.max[a] = lattice.index(box.max[a], a);
    }
    if (around.min == around.max) return cut_beside(unit, around.min);
    const std::size_t axis = widest_axis(around);
    std::vector<double> coordinates;
    for (const Vec3d& p : points) coordinates.push_back(p[axis]);
    const auto middle = coordinates.begin() + static_cast<std::ptrdiff_t>(coordinates.size() / 2);
    std::nth_element(coordinates.begin(), middle, coordinates.end());
    return cut_unit(unit, axis, std::max(lattice.index(*middle, axis), around.min[axis] + 1));
}

}  // namespace pcm
