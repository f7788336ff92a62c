// Clicks on generated sites, whose exact truth says which answers are right.
#pragma once

#include "bench/detect/truth.h"
#include "pcm/place/fit_at.h"
#include "pcm/point_cloud.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm::bench {

// A generated site and places on it. One thread.
class ClickedSite {
public:
    // A tree with its .truth.json next to it, and `clicks` places: on primitives of at least 200 points, each of them
    // as often as any other. A third as many in addition are on ground and trees.
    ClickedSite(const std::filesystem::path& tree, std::size_t clicks, std::uint64_t seed);

    struct Counts {
        int right_good = 0, right_doubtful = 0, wrong_good = 0, wrong_doubtful = 0;
        int clutter_good = 0, clutter_doubtful = 0;  // on ground and trees
    };
    // A fit of the kind that fits best at each place. Right: it is the primitive's kind, nine tenths of its points are
    // the primitive's, and its radius is within 5 %, or three standard deviations. `list` prints each.
    void judge(bool list, Counts& counts) const;

private:
    struct Click {
        Vec3d place;
        std::uint32_t truth;  // 0: ground or trees
    };
    bool is_right(const FittedPrimitive& fitted, std::uint32_t truth) const;

    std::shared_ptr<PointCloud> cloud_;
    std::vector<True> truth_;
    std::vector<std::vector<std::uint16_t>> ids_;  // numbers of true primitives, by node
    std::vector<Click> clicks_;
};

}  // namespace pcm::bench
