// The stages of a team's build in their order: folders of job files (job_folder.h).
//
// What a stage leaves stays until the jobs that read it are all done, and is given up then: the stages until
// `divisions` when the points are sorted, bins and their levels when the subtrees are built.
#pragma once

namespace pcm::stage {

inline constexpr const char* plan = "plan";  // how the input is read, and the cuts between bins
inline constexpr const char* batches = "batches";
inline constexpr const char* spools = "spools";    // doubles, before their grid is known
inline constexpr const char* samples = "samples";  // points of the spools
inline constexpr const char* cuts = "cuts";        // one job: the cuts between bins, from the samples
inline constexpr const char* spooled = "spooled";  // the rows of spools in bins
inline constexpr const char* divisions = "divisions";
inline constexpr const char* bins = "bins";
inline constexpr const char* sorted = "sorted";  // one job: what is known when all bins are sorted
inline constexpr const char* levels = "levels";
inline constexpr const char* levelled = "levelled";  // one job: what is known when all bins have their levels
inline constexpr const char* subtrees = "subtrees";
inline constexpr const char* above = "above";  // one job: the nodes above the subtrees
inline constexpr const char* data = "data";

}  // namespace pcm::stage
