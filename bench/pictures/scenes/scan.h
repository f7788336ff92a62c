// Point clouds of scenes: regular scans by their scanners.
#pragma once

#include "bench/pictures/scenes/look.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm::bench {

struct ScanPoint {
    Vec3d place{};  // metres from the scene's corner
    Rgb colour{}, label{};
};

// About `points` in number (within a few percent: rays are spaced evenly, and some see the sky), in scan lines, with
// 3 mm noise of the range. The same for any number of threads.
std::vector<ScanPoint> scan(const Scene& scene, const Eye& eye, std::uint64_t points, unsigned threads);

// At map coordinates (scene_origin), in the format of the file's extension, with colours or labels as rgb. Replaces the
// file.
void write_cloud(const std::filesystem::path& file, const std::vector<ScanPoint>& points, bool labels);

}  // namespace pcm::bench
