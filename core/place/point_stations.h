// From which station of a scanner each point of a tree was measured.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/shapes/station_facts.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// The source of the stations is chosen by the coarsest points of the tree, which are spread over the whole cloud. It is
// the first of the attributes `scan` (PTX, E57) and `point_source_id` (LAS) that has several values, each of many
// points, else gaps of half a minute and more in `gps_time`, within which a scanner is carried to its next station or
// an aircraft turns to its next strip. A cloud of one value or without gaps has one station or does not record them:
// these cannot be distinguished. Any number of threads.
class PointStations {
public:
    explicit PointStations(const Tree& tree);  // reads a chunk of each part; throws what that throws

    StationSource source() const { return source_; }
    // Whether the file itself says that they are: the numbers of scans that were made at several places.
    bool are_stated() const { return are_stated_; }
    const std::string& attribute() const { return attribute_; }  // its name; empty without a source
    ColumnSet columns() const;                                   // positions, and what at() looks at
    std::uint32_t at(const Chunk& chunk, std::size_t i) const;   // 0 without a source

private:
    void look_at_times(std::vector<double> times);

    StationSource source_ = StationSource::none;
    bool are_stated_ = false;
    std::string attribute_;
    std::size_t place_ = 0;  // in the schema
    double scale_ = 1, offset_ = 0;
    std::vector<double> begins_;  // start times of all stations but the first
};

}  // namespace pcm
