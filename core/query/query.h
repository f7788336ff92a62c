// Which points of a cloud are wanted, and what of them.
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
    std::vector<std::string> attributes;  // names to read in addition to the position; unknown names are an error
    std::optional<Region> region;         // in addition to the box: points are inside of both
    std::vector<Clip> clips;              // all must hold, too
    unsigned reads_in_flight = 8;  // chunks that are read at the same time, ahead of the caller: more of them hide a
                                   // network's latency, and each takes the memory of a chunk
    ProgressFunction progress;     // called by the cursor, on the caller's thread; false: Error(cancelled)

    // Which points; attributes that the selection keeps or drops are not taken.
    void choose(const Selection& selection)
    {
        box = selection.box;
        region = selection.region;
        clips = selection.clips;
        where = selection.where;
    }
    Selection selection() const
    {
        Selection selection;
        selection.box = box;
        selection.region = region;
        selection.clips = clips;
        selection.where = where;
        return selection;
    }
};

}  // namespace pcm
