// The points of a box, thinned evenly, with neighbours and normals: what shapes are searched in.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/detect/cloud_part.h"
#include "pcm/filter/points_in_boxes.h"
#include "pcm/shapes/shape.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

namespace pcm {

class PointLabels;

// Points that an earlier search has found: those with a label above 0, but for labels that are open.
struct TakenPoints {
    std::shared_ptr<const PointLabels> labels;  // null: none is taken
    std::vector<bool> is_open{};                // keyed by label - 1; none: no label is

    bool has(std::uint32_t label) const { return label > 0 && (is_open.empty() || !is_open[label - 1]); }
};

// Reads the chosen points of boxes. Any number of threads.
class ChosenPoints {
public:
    ChosenPoints(const std::shared_ptr<const Tree>& tree, const Selection& limit, CloudPart part = {},
                 TakenPoints taken = {});

    // Some points of one node: `number[i]` in the node's whole chunk, `at[i]` its place in source coordinates,
    // `grid[i]` on the grid.
    struct Some {
        NodeId node = no_node;
        std::vector<std::uint32_t> number;
        std::vector<Vec3d> at;
        std::vector<Vec3i> grid;
    };
    // Calls take() with the points of levels 0..level in the box, both ends included, node by node in the order of the
    // tree. Throws what reading throws.
    void visit(const Box3i& box, std::uint16_t level, const std::function<void(const Some&)>& take) const;

    // Source coordinates of all points of a node, chosen or not.
    std::vector<Vec3d> positions(NodeId node) const;

    const Tree& tree() const { return *tree_; }
    // Whether the box may have chosen points.
    bool touches(const Box3i& box) const;
    Box3d source_box(const Box3i& box) const;

private:
    const std::shared_ptr<const Tree> tree_;
    const PointsInBoxes boxes_;
    const Selector selector_;
    const CloudPart part_;
    const TakenPoints taken_;
    const SourceRounding rounding_;
};

// Cells of a lattice that has its origin at the grid's.
class SampleLattice {
public:
    // cell: source units, positive.
    SampleLattice(const Tree& tree, double cell);
    Vec3i cell_of(const Vec3i& grid) const;
    // 63 bits, different for different cells but for one pair in 10^18.
    static std::uint64_t key_of(const Vec3i& cell);

private:
    Vec3d factor_{};
};

// Positions in a box and near a plane, cylinder or sphere; source coordinates and units.
struct Vicinity {
    Box3d box;
    Shape shape;
    double most = 0;  // distance from the shape

    bool contains(const Vec3d& p) const { return box.contains(p) && distance_to(shape, p) <= most; }
};

struct SampleSettings {
    std::uint16_t level = 0;  // points of coarser levels and of this one
    double cell = 0;          // one point of each cell of this size, source units; 0: all points
    double margin = 0;        // points around the box are there too
    double step = 0;          // longest edge, source units; 0: as the spacing around a point allows
    std::size_t most = 0;     // points of a sample of for_each_sample() in the box; 0: any number
    // Points elsewhere are left out; none: no point is. Normals and edges next to those have no meaning.
    std::vector<Vicinity> only{};
    std::function<void()> check{};  // called at least some times a second, by the thread that works; may throw
};

// One object by one thread at a time.
struct SurfaceSample {
    static constexpr std::size_t most_neighbours = 16;

    Vec3d origin{};                            // source coordinates
    std::vector<Vec3d> at;                     // relative to it
    std::vector<std::array<float, 3>> normal;  // unit, of any sign; 0 0 0 for points on one line
    std::vector<float> rough;                  // rms distance of the neighbours from their plane, source units
    std::vector<float> spacing;                // distance to the fourth neighbour (or the last), source units
    std::vector<std::uint8_t> inside;          // 1: in the box, 0: in the margin
    std::vector<std::uint32_t> edges;          // most_neighbours for each point, nearest first; itself where fewer
    std::unordered_map<std::uint64_t, std::uint32_t> by_cell;  // the point of a cell, by SampleLattice::key_of()

    static constexpr std::size_t block_points = 64;
    std::vector<Box3d> blocks;  // around block_points points each, in their order
    Box3d bounds;               // around all of them

    std::size_t size() const { return at.size(); }
    const std::uint32_t* neighbours(std::size_t i) const { return edges.data() + i * most_neighbours; }
    Vec3d normal_of(std::size_t i) const { return {normal[i][0], normal[i][1], normal[i][2]}; }
};

// Places of some points, relative to the sample's origin.
std::vector<Vec3d> places_of(const SurfaceSample& sample, const std::vector<std::uint32_t>& points);

// Calls use(i) for the points of a sample in a box and up to `most` from a plane, cylinder or sphere, ascending, and
// may do so for others of the box. `box`: source coordinates; `shape`: relative to the sample's origin.
template <class Use>
void for_points_near(const SurfaceSample& sample, const Box3d& box, const Shape& shape, double most, const Use& use)
{
    const Box3d here{box.min - sample.origin, box.max - sample.origin};
    if (!here.intersects(sample.bounds)) return;
    for (std::size_t b = 0; b < sample.blocks.size(); ++b) {
        const Box3d& block = sample.blocks[b];
        if (!here.intersects(block) || distance_to(shape, block.centre()) > most + 0.5001 * block.diagonal()) continue;
        const std::size_t end = std::min(sample.size(), (b + 1) * SurfaceSample::block_points);
        for (std::size_t i = b * SurfaceSample::block_points; i < end; ++i)
            if (here.contains(sample.at[i])) use(static_cast<std::uint32_t>(i));
    }
}

// Any number of points, whatever settings.most says. Throws what reading and settings.check throw.
SurfaceSample sample_surface(const ChosenPoints& points, const Box3i& box, const SampleSettings& settings);

// The two halves of a box across its longest side; none of a box of one grid position.
std::vector<Box3i> halves_of(const Box3i& box, const Vec3d& scale);

// Calls use() with the sample of the box; where that has more than settings.most points in the box, or a third more
// with the margin, with those of its halves, in turn, and so on. After each, freed memory goes back to the system.
// Throws what reading, settings.check and `use` throw, and Error(invalid_argument) where a box that is small relative
// to the step has more than twice as many points around it as settings.most.
void for_each_sample(const ChosenPoints& points, const Box3i& box, const SampleSettings& settings,
                     const std::function<void(const Box3i&, SurfaceSample)>& use);

}  // namespace pcm
