// Radii of points by compute shaders, from their nearest neighbours among the chunks in video memory:
//
//     auto cloud = pcm::PointCloud::open("city.pct", {}, pcm::Access::write);
//     try {
//         pcm::compute_radii_on_gpu(cloud, std::make_shared<pcm::L1Cache>(), options);
//         cloud->close();    // now the tree has them
//     } catch (...) {
//         cloud->abandon();  // the tree is as it was
//         throw;
//     }
//
// The leaves are visited one after the other. Points that lie there, of all nodes from the root down, are a batch. They
// are compared with their own node's points, then with those of the other nodes on the path, then with those of any
// other node that is nearer than the neighbours found so far. Chunks pass through L2 into the L1, and radii go the same
// way back, so memory stays within the capacities of both caches, and some 40 MB of video memory in addition.
#pragma once

#include "pcm/gl/l1/l1_cache.h"
#include "pcm/point_cloud.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pcm {

struct GpuRadiiOptions {
    static constexpr std::size_t most_neighbours = 1024;
    std::size_t neighbours = 16;  // k, 1 to most_neighbours; the point itself is not counted
    // Measure across the cloud's attribute "normal" (3 components); a point whose normal is 0 or not finite has the
    // radius that it has without.
    bool normals = false;
    ProgressFunction progress;  // called after each batch at least
};

struct GpuRadiiReport {
    Outcome outcome;
    std::uint64_t batches = 0;
    std::uint64_t dispatches = 0;  // number of compute shader dispatches
};

// Computes the attribute "radius" (f32, source units) of all points: the largest |d - n (n . d)| of the offsets d to
// the k nearest points of the whole cloud, n being the normal, or, without normals, the largest |d|; 0 without
// neighbours. Any of several points at equal distance may be chosen. Offsets are exact at any coordinates. The
// neighbours are those that comparing in double gives; without normals radii are exact to 1e-6.
//
// `cloud` was opened for writing and has no other attribute of that name; it is added where it is missing. The radii
// are in the cloud's cache afterwards, and in the tree after flush() or close(). After an error part of them may be in
// the cache: abandon() the cloud. Throws Error(invalid_argument) for options out of range, an attribute "normal" that
// is missing, and an attribute "radius" of another type; Error(unsupported) when the current context has no compute
// shaders (OpenGL 4.3); Error(no_space) when the L1 or the device has too little memory; Error(cancelled); and what
// reading and writing throw. GL thread only: a context of the L1's share group must be current. Changes the current
// program and the bindings of shader storage and copy buffers.
GpuRadiiReport compute_radii_on_gpu(const std::shared_ptr<PointCloud>& cloud, const std::shared_ptr<L1Cache>& l1,
                                    const GpuRadiiOptions& options);

}  // namespace pcm
