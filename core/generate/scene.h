// A synthetic laser scan with exact ground truth: ground, buildings, pipes, tanks and trees, seen from scanner stations
// with range noise, occlusion and a density that decreases with the square of the distance.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

struct SceneOptions {
    std::uint64_t points = 1000000;            // written, exactly
    Vec3d origin{500000.0, 4800000.0, 100.0};  // map coordinates of the scene's south-west corner
    double extent = 0;                         // side length of the scene, metres; 0: grows with the number of points
    double noise = 0.003;                      // standard deviation of the range, metres
    double scale = 0.001;                      // step of the LAS grid, metres
    std::uint64_t seed = 1;
    unsigned threads = 0;    // threads that cast rays; 0: one per processor
    bool overwrite = false;  // replace existing files
    ProgressFunction progress;
};

// One primitive of the scene, in source coordinates; exact, without range noise.
struct ScenePrimitive {
    enum class Kind { plane, cylinder, sphere } kind = Kind::plane;
    std::uint16_t id = 0;      // LAS point source id of its points; points of ground and vegetation have 0
    Vec3d point{};             // a point of the plane; a point on the axis; the centre
    Vec3d direction{};         // unit normal; unit axis; unused
    double radius = 0;         // cylinder and sphere
    std::uint64_t points = 0;  // written with this id
};

struct SceneReport {
    Outcome outcome;
    std::vector<ScenePrimitive> primitives;
    std::vector<std::string> notes;  // notes of the writer
};

// Writes the scene to `file` in the format of its extension (for las and laz: LAS 1.2, 1.4 from 4,294,967,296 points
// on, point format 2), and, when write_truth, the primitives as JSON next to it (`file` with the extension
// .truth.json). The same options give the same bytes on every machine and for any number of threads. Throws what
// create_writer() throws, Error(exists) when one of the files exists and is not to be overwritten, and
// Error(invalid_argument) for options out of range and for a scene that does not fit its grid. Progress is reported on
// the calling thread.
SceneReport generate_scene(const std::filesystem::path& file, const SceneOptions& options, bool write_truth = true);

}  // namespace pcm
