// Normals, radii and other attributes of a tree's points by several processes.
#pragma once

#include "pcm/filter/neighbour_attributes.h"
#include "pcm/threads/team.h"
#include "pcm/update/target.h"

#include <filesystem>

namespace pcm {

// Collective: as compute_neighbour_attributes() on UpdateTarget(tree, choice), and the same values, whatever the number
// of ranks; the bytes are those of one process whose memory holds all of the attributes. All ranks have the same
// arguments, except for threads and progress, which are each rank's own; memory is for each of them.
//
// Ranks take units (knn/neighbourhoods.h), and then chunks, from shared counters. Which side the normals of joined
// pieces of surfaces point to is decided by rank 0, which also puts the tree together from the chunks. The folder
// NAME.part next to the result holds what is done as files of jobs: after an interruption, at any moment, the same
// call with any number of ranks resumes it. The report is rank 0's; the others' are empty.
NeighbourAttributeReport compute_neighbour_attributes_by(Team& team, const std::filesystem::path& tree,
                                                         const TargetChoice& choice,
                                                         const NeighbourAttributeOptions& options);

}  // namespace pcm
