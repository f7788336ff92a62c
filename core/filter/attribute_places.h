// Where computed attributes are put in a tree's schema, and whether they can be computed.
#pragma once

#include "pcm/filter/neighbour_attributes.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// Places in the tree's schema.
struct AttributePlaces {
    std::optional<std::size_t> radius, normal, curvature, confidence, mean_distance;  // to write
    std::optional<std::size_t> known_normal;                                          // to measure radii across
    std::vector<std::size_t> written() const;
};

// Throw Error(invalid_argument) for options out of range; for scanners that the cloud does not name.
void check_options(const NeighbourAttributeOptions& options, const std::filesystem::path& path);
void check_scanners(const NeighbourAttributeOptions& options, const TreeInfo& info, const std::filesystem::path& path);

// Calls `place_for` for each attribute to write, in the order that exports have them. Throws what check_may_write()
// (result_attributes.h) and `place_for` throw.
AttributePlaces find_places(const Tree& tree, const WantedValues& wanted, bool overwrite,
                            const std::function<std::size_t(const Attribute&)>& place_for);

// Whether normals are to point to the same side along each surface.
bool is_consistent(const NeighbourAttributeOptions& options);

// Adds a note where more points lie on two surfaces than noise makes by chance.
void report_two_surfaces(std::uint64_t points, NeighbourAttributeReport& report);

}  // namespace pcm
