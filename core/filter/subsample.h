// A part of a cloud's points that is evenly spread: to a spacing, or of a number.
//
// A result has exactly the spacing, or exactly the number. The levels of a tree are such parts already (tree/tree.h,
// Sampling), of other spacings and numbers: the level nearest to what is asked costs no more than reading it. Points
// keep their positions and attributes bit for bit.
#pragma once

#include "pcm/filter/result_tree.h"
#include "pcm/io/reader.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct SubsampleOptions {
    // Exactly one of the two.
    std::optional<double> spacing;        // source units
    std::optional<std::uint64_t> points;  // how many
    // With a spacing: no two points are nearer than it, and every point of the cloud has one that is (squares compared
    // in double). With a number: that many, unless the cloud has fewer. False: choose_level(), whose spacing may be
    // twice or half of the one asked for, and which may be all points.
    bool exact = true;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;  // memory of the reader
    unsigned threads = 0;                                   // 0: one per processor
};

// A level as the answer to a wish, without `exact`.
struct ChosenLevel {
    std::uint16_t level = 0;
    double spacing = 0;  // source units; 0: all points of the cloud
    std::uint64_t points = 0;
};

// The level whose spacing is nearest to the one asked for, as a ratio; the level of all points counts as half the
// spacing of the level before. For a number: the finest level with at most that many points, or the first.
ChosenLevel choose_level(const Tree& tree, const SubsampleOptions& options);

// What of the promise of the levels does not hold for this tree: after deletions, after appending, and where levels are
// one point per cell. Empty where all holds. For people.
std::string level_caveat(const Tree& tree);

// The chosen points of a tree. A level: its points. A number: those of a level, and of the next one as many as are
// missing, evenly along their order in the tree, which is one in space. A spacing: points are taken one after the other
// unless one that was taken is near; for that, space is divided into boxes with about as many points as the memory
// allows, and the points taken near the border of a box are kept until the adjacent boxes are done. Memory: as given,
// and those points. The result depends on the tree and the memory alone. Throws Error(invalid_argument) for a spacing
// that is not a positive number or so small that doubles cannot hold squares or quotients, a number of 0, or not
// exactly one wish.
std::unique_ptr<PointReader> open_subsample(std::shared_ptr<const Tree> tree, const SubsampleOptions& options);

struct SubsampleReport {
    BuildReport build;                 // points_in: the source's; points_out: chosen
    std::optional<ChosenLevel> level;  // without `exact`
    std::string caveat;                // level_caveat(), unless the spacing is exact
};

// The chosen points as a tree. `options.memory_bytes` and `options.threads` have no meaning here. Throws what
// open_subsample() and build_result() throw.
SubsampleReport subsample(const std::filesystem::path& tree, const SubsampleOptions& options,
                          const ResultOptions& result);

}  // namespace pcm
