// One pass over the points of a tree that a selection can choose, by all threads.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/select/select_points.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/tree/source_rounding.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// A test of a point's place, in addition to a selection. Any number of threads.
class PlaceTest {
public:
    virtual ~PlaceTest() = default;
    // Conservative like Region::relation(), for boxes of source coordinates. The points of a box inside are not asked
    // about: a test that looks at attributes calls no box that.
    virtual BoxRelation relation(const Box3d& box) const = 0;
    virtual bool holds(const Vec3d& p) const = 0;
    // Columns that narrow() looks at in addition to positions.
    virtual ColumnSet columns() const { return {}; }
    // Keeps those of the indices of points in `chunk` that hold; positions[k] are the source coordinates of some[k].
    virtual void narrow(const Chunk& chunk, const std::vector<Vec3d>& positions,
                        std::vector<std::uint32_t>& some) const;
};

// Some points of a node that were chosen.
struct ScannedPoints {
    NodeId node = no_node;
    ChunkPart part;                      // empty when the node was not read
    std::vector<std::uint32_t> indices;  // the chosen points in part.chunk, ascending; empty when it was not read
    std::vector<std::uint32_t> numbers;  // the same points in the node's whole chunk, ascending
};

// Source coordinates of the chosen points, whose part has positions.
std::vector<Vec3d> source_positions(const ScannedPoints& found, const Grid& grid, const SourceRounding& rounding);

struct ScanOptions {
    const PlaceTest* test = nullptr;   // may be null
    const PointSet* within = nullptr;  // only points of this set; may be null, and does not change meanwhile
    // That `part` is to have of all chosen points. Absent: nodes of which all points are chosen stay unread.
    std::optional<ColumnSet> columns;
    SelectOptions select;
    std::string stage = "Selecting points";
    double begin = 0, end = 1;  // range of the progress
};

// Calls take() once for each node with chosen points, on any thread, several at the same time. Throws what
// select_points() and take() throw.
void scan_points(const Tree& tree, const Selection& selection, const ScanOptions& options,
                 const std::function<void(const ScannedPoints&)>& take);

}  // namespace pcm
