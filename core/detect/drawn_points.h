// Some of a part's points, drawn at random while all are streamed past.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcm {

// All points that were added; of more than `most` that many, any of them as probable as any other. The same ones in
// whatever order and however divided they are added. Memory: 32 bytes a point. One object by one thread.
class DrawnPoints {
public:
    explicit DrawnPoints(std::size_t most) : most_(most) {}

    void add(const Vec3d& p, std::uint64_t number);  // a number that no other point has
    void add(const DrawnPoints& other);              // with the same `most`
    std::vector<Vec3d> points() const;               // in an order that is at random, too, and the same each time

private:
    using Drawn = std::pair<std::uint64_t, Vec3d>;  // the least numbers that were drawn stay
    void add(const Drawn& one);

    std::size_t most_;
    std::vector<Drawn> heap_;
};

}  // namespace pcm
