// Which points are drawn as a sample.
#pragma once

#include "pcm/fit/point_normals.h"
#include "pcm/fit/random_numbers.h"
#include "pcm/fit/tuning.h"
#include "pcm/fit/working_points.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// All points equally, or those of good quality first (PROSAC, Chum and Matas 2005). Quality is how near a point's
// neighbours are to a plane; it is known of up to 1000 points, which are drawn at random. One thread.
class SampleDraw {
public:
    SampleDraw(const WorkingPoints& points, SampleNormals& normals, std::size_t sampled, bool progressive,
               std::uint64_t seed);

    // False: a point was drawn twice.
    bool draw(std::size_t* sample);
    // Shares of points that are near the best shape, in the part of them that is drawn from: the greatest sound one.
    // `is_near` is asked about points of known quality.
    template <class IsNear>
    double share(double share_of_all, const IsNear& is_near) const
    {
        const std::size_t least_part = fit_tuning().sampling.min_share_points;
        double best = share_of_all;
        std::size_t near = 0;
        for (std::size_t i = 0; i < order_.size(); ++i) {
            near += is_near(order_[i]);
            if (i + 1 >= least_part && i < part_)
                best = std::max(best, static_cast<double>(near) / static_cast<double>(i + 1));
        }
        return best;
    }

private:
    void grow();

    const WorkingPoints& points_;
    std::size_t sampled_;
    SampleNumbers random_;
    std::vector<std::uint32_t> order_;  // points of known quality, best first; empty: all are equal
    std::size_t part_ = 0;              // number of these that are drawn from
    double drawn_ = 0, until_ = 1, expected_ = 0;
};

}  // namespace pcm
