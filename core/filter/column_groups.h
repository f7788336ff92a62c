// Groups of points whose attributes are combined.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/filter/combined_attributes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// Group g consists of the points order[begins[g]], ..., order[begins[g + 1] - 1]: numbers in columns.
struct PointGroups {
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> begins;  // one more than there are groups

    std::size_t size() const { return begins.empty() ? 0 : begins.size() - 1; }
    std::size_t points_of(std::size_t group) const { return begins[group + 1] - begins[group]; }
};

// Combines one attribute of groups of points. One thread.
class ColumnCombiner {
public:
    virtual ~ColumnCombiner() = default;
    // Adds points to the groups 0 .. groups.size() - 1, always as many; with one group it can be called repeatedly.
    virtual void add(const Column& column, const PointGroups& groups) = 0;
    // The result, one point per group; shapes `out`.
    virtual void finish(Column& out) = 0;
};

// `groups` of points. Memory: some 24 bytes for each component of a group; a majority of one group to which points are
// added repeatedly keeps the counts of at most a million different values: those of further ones are not counted.
std::unique_ptr<ColumnCombiner> make_combiner(const Attribute& attribute, Combination combination, std::size_t groups);

}  // namespace pcm
