// What the points of units (knn/neighbourhoods.h) got: columns of values, a file a unit, written by the ranks of a
// team.
//
// A file has, for each node with points in the unit, their numbers in the node's chunk and then their values, column by
// column; then bytes that belong to the unit as a whole. Its record says where all that is.
#pragma once

#include "pcm/cloud/box_tree.h"
#include "pcm/cluster/job_folder.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {

// Any number of threads may call.
class UnitResults {
public:
    // `units`: boxes of plan_units(). `widths`: bytes of a point in each column. `head_bytes`: size of each
    // unit's head.
    UnitResults(const JobFolder& jobs, const Tree& tree, const std::vector<Box3i>& units,
                std::vector<std::size_t> widths, std::size_t head_bytes);

    std::size_t units() const { return units_; }
    bool is_done(std::size_t unit) const;

    // `columns`: the values of the unit's points, keyed by number in it. `head`: few bytes; `more`: any number.
    void write(const NeighbourhoodUnit& unit, const std::vector<const void*>& columns,
               const std::vector<std::byte>& head, const std::vector<std::byte>& more) const;
    // For a unit without points.
    void write_empty(std::size_t unit) const;

    // Points of one node in a unit.
    struct Part {
        std::size_t unit = 0;
        NodeId node = no_node;
        std::vector<std::uint32_t> indices;
        std::vector<std::vector<std::byte>> columns;
    };
    using See = std::function<void(const Part& part)>;
    // The parts of a unit; of a node, in the order of the units. Throw Error(corrupt) for files of other work.
    void for_each_of_unit(std::size_t unit, const See& see) const;
    void for_each_of_node(NodeId node, const See& see) const;
    std::vector<std::byte> head(std::size_t unit) const;
    std::vector<std::byte> more(std::size_t unit) const;

    // All values of a node's points in one column.
    Column column(NodeId node, std::size_t number, const Attribute& attribute) const;

private:
    struct Place {
        NodeId node;
        std::uint32_t points;
        std::uint64_t offset;
    };
    struct Record {
        std::vector<std::byte> head;
        std::vector<Place> places;
        std::uint64_t more_at = 0, more_bytes = 0;
    };
    std::shared_ptr<const Record> record(std::size_t unit) const;
    Part read(const File& file, std::size_t unit, const Place& place) const;
    std::size_t point_bytes() const;

    const JobFolder& jobs_;
    const Tree& tree_;
    const std::size_t units_;
    const std::vector<std::size_t> widths_;
    const std::size_t head_bytes_;
    const BoxTree boxes_;
    mutable std::mutex mutex_;
    mutable std::map<std::size_t, std::shared_ptr<const Record>> records_;  // a few, keyed by unit
};

}  // namespace pcm
