// What is asked of a point cloud tree.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct Query {
    std::optional<Box3d> box;             // source coordinates, both ends included; everything when absent
    std::optional<std::uint16_t> level;   // the cloud at this level; the whole cloud when absent
    std::vector<Condition> where;         // on attributes; all must be met (parse_condition() makes them from text)
    std::vector<std::string> attributes;  // names to read beside the position; unknown names are an error
    std::optional<Region> region;         // beside the box; both must hold
    unsigned reads_in_flight = 8;  // chunks that are read at once, ahead of the caller: more hide a network's latency,
                                   // and each takes the memory of a chunk
    ProgressFunction progress;     // called by the cursor, on the caller's thread; false: Error(cancelled)

    Selection selection() const
    {
        Selection selection;
        selection.box = box;
        selection.region = region;
        selection.where = where;
        return selection;
    }
};

}  // namespace pcm
