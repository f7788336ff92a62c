// The exact truth of a generated site, and what a detection found of it.
#pragma once

#include "pcm/shapes/primitive.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

namespace pcm::bench {

struct True {
    Shape shape;
    std::uint64_t points = 0;
};

// By id; 0: ground and trees.
std::vector<True> read_truth(const std::filesystem::path& file);

// Points by label, or 0, and true primitive: of all points of the cloud, which may be a sample of the site.
using Pairs = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>;

struct Score {
    std::map<ShapeKind, int> wanted, recalled, found, wrong;
    int clutter = 0, good_clutter = 0, split = 0;
    int good = 0, within = 0;
    bool has_sigmas = true;  // of the found ones; a peer gives none
    std::uint64_t clutter_points = 0;
    std::vector<double> positions;  // errors of the found ones, source units
    std::vector<double> worst;      // of each found one, the largest of its errors in standard deviations
};

// `list` prints each primitive.
Score compare(std::vector<True> truth, const std::vector<Primitive>& primitives, const Pairs& pairs,
              std::uint64_t least, bool list);
void print(Score& score);

}  // namespace pcm::bench
