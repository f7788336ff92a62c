// How one chunk looks in one frame, beside the style of its cloud. No OpenGL here.
#pragma once

namespace pcm {

struct ChunkLook {
    float level = 0;     // for the colour mode `level`: the coarsest level among the chunk's points
    float error_px = 0;  // for the colour mode `error`
    // Points of a coarse level are farther apart than their radii, which were made for the whole cloud, and than
    // constant splats are large. So that they leave no gaps, splats have a least size: a radius in source units, but no
    // more than a number of pixels across.
    float least_radius = 0;
    float least_px = 0;
};

}  // namespace pcm
