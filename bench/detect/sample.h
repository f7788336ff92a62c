// The points of a cloud that fits in memory, as the peers of detection take them.
#pragma once

#include "bench/detect/truth.h"
#include "pcm/fit/fit_points.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace pcm::bench {

struct PeerSample {
    FitPoints points;                // with normals of 16 neighbours
    std::vector<std::uint32_t> ids;  // numbers of the true primitives
    double normals = 0;              // seconds that the normals took
};

PeerSample read_sample(const Tree& tree);

// What a peer found: shapes with the indices of their points.
class PeerResult {
public:
    explicit PeerResult(const PeerSample& sample);
    // `shape`: relative to the sample's origin.
    void add(Shape shape, const std::vector<std::size_t>& points);
    // Prints how the shapes of at least 500 points compare with the truth.
    void print(const std::filesystem::path& truth, bool list);

private:
    const PeerSample& sample_;
    std::vector<std::uint32_t> labels_;
    std::vector<Primitive> found_;
};

}  // namespace pcm::bench
