// Profiles: the points of clouds along a line, as a cross-section shows them.
//
// All is in plan: the line's points count without their z. A point of a cloud belongs to the profile when its distance
// to the line is at most half of the width, unless it lies before the beginning or behind the end (the ends are cut
// straight across; corners are round). It belongs to the segment that is nearest, of equally near ones the first, so
// that it is counted once. With t its place on the segment (0 to the segment's length, the foot of the perpendicular,
// or the end that is nearer): station = length of the segments before + t; offset = distance to the line, positive to
// the right of its direction, negative to the left; what is nearest to a corner lies on the corner's outer side.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/point_cloud.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct ProfileOptions {
    std::vector<Vec3d> line;                // two or more points
    double width = 1;                       // source units, 0 or more
    std::optional<double> lowest, highest;  // range of the points' z, both included
    // Where the cloud stands: line, width, heights and the points found are of that place. Absent: at its source
    // coordinates. Clips and conditions are on source coordinates and values always.
    std::optional<Affine> placement;
    std::optional<std::uint16_t> level;   // the cloud at this level; the whole cloud when absent
    std::vector<Condition> where;         // all must be met
    std::vector<Clip> clips;              // all must hold
    std::vector<std::string> attributes;  // to read; unknown names are an error
    ProgressFunction progress;
};

struct ProfilePoint {
    double station = 0, offset = 0;  // source units
    Vec3d position{};                // source coordinates, or what the placement makes of them
    std::uint32_t segment = 0;
};

// A line prepared for finding where points lie along it. Immutable; any number of threads.
class ProfileLine {
public:
    // Throws Error(invalid_argument) for fewer than two points, coordinates that are not finite, and a line without
    // length in plan. Points that repeat the one before in plan are left out.
    explicit ProfileLine(const std::vector<Vec3d>& points);

    double length() const { return stations_.back(); }
    std::size_t segments() const { return points_.size() - 1; }
    // Station, offset and segment of the position; nothing where it lies before the beginning or behind the end.
    std::optional<ProfilePoint> locate(const Vec3d& position) const;
    // All positions within half of `width` of segment k that locate() can give to it; z from `low` to `high`.
    Region around(std::size_t segment, double width, double low, double high) const;

private:
    std::vector<Vec3d> points_;  // z is 0
    std::vector<double> stations_;
    std::vector<double> turns_;  // at each point: above 0 to the left, below 0 to the right
};

// One point; its attributes are those of number `i` in the view.
using ProfileVisitor = std::function<void(const ProfilePoint& point, const PointView& view, std::size_t i)>;

// Calls `visit` for every point of the profile, in no particular order, in bounded memory. Outcome: points_in were
// read, points_out visited; error: every point of the cloud is nearer than this to one that the level has. Throws
// Error(invalid_argument) for a wrong line or width, for lowest > highest and for a placement that flattens,
// Error(cancelled), and what PointCloud::points() throws.
Outcome visit_profile(PointCloud& cloud, const ProfileOptions& options, const ProfileVisitor& visit);

// The profile for a plot: of the finest level (no finer than options.level) that has at most `most` points of it, or of
// the coarsest one, which may have more. Memory: the points; Error(invalid_argument) when level 0 has more than 16
// million.
struct ProfileSample {
    std::vector<ProfilePoint> points;
    // Values in the attributes' units, a column for each component of each attribute: [column][point].
    std::vector<std::vector<double>> attributes;
    std::optional<std::uint16_t> level;  // absent: the whole cloud, or options.level
    Outcome outcome;                     // error: as of visit_profile()
};
ProfileSample sample_profile(PointCloud& cloud, const ProfileOptions& options, std::size_t most);

struct ProfileFileOptions {
    bool overwrite = false;   // an existing file; else Error(exists)
    bool in_place = false;    // drawings: points at their source coordinates, not at (station, height)
    double exaggeration = 1;  // factor on heights in drawings that are not in place, above 0
};

// Writes the profile in the format of the extension, in bounded memory:
//
// - .csv: station, offset, x, y, z, and the attributes (NAME, or NAME.0, NAME.1, ... of several components), all
// digits.
// - .dxf: points of the layer pcm_profile at (station, z * exaggeration, 0) and the line pcm_profile_line below them;
// in
//   place, at their source coordinates, and the line given.
//
// Rows are in no particular order. Throws what visit_profile() and OutputFile throw; Error(invalid_argument) for other
// extensions; Error(unsupported) for .dxf without dxflib.
Outcome write_profile(PointCloud& cloud, const ProfileOptions& options, const std::filesystem::path& file,
                      const ProfileFileOptions& file_options = {});

}  // namespace pcm
