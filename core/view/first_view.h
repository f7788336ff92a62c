// Where a cloud is first looked at from: from where it was scanned, where that is known, else obliquely from above. One
// place for windows and for pictures without one.
//
// Pure functions of a sample of the cloud's points, any thread; sampled_places() reads.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/metadata.h"
#include "pcm/cloud/vector.h"
#include "pcm/view/first_person.h"

#include <optional>
#include <vector>

namespace pcm {

// The picture that a view makes.
struct PictureShape {
    double angle = 45;  // vertical angle of view, degrees, below 180
    int width = 0, height = 0;
    int covered = 0;  // rows at the bottom that something hides, at most half of the height
};

// The place and the axes of the instrument of a scan, in source coordinates.
struct ScanPose {
    Vec3d eye{};
    Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    bool stated = false;  // else it may be what writers put there that know of none
};
// The poses that the metadata of a PCD, PTX or E57 file allow, likeliest first; none where there are several scans.
std::vector<ScanPose> scan_poses(const std::vector<Metadata>& metadata);

// The view from where the instrument was: of a camera (which looks along z, with y downwards: all points are in front
// of it) along its axis, of a scanner level, in the direction of most points;
// nearer where they are but a small part of the picture. Nothing where the points do not look as
// if they were seen from there: if points lie in almost the same direction, one would hide the other.
std::optional<EyePose> view_of_scan(const std::vector<Vec3d>& points, const ScanPose& pose,
                                    const PictureShape& picture);

// Obliquely from above, so that the points fill 85 % of the width or of the height; few that lie far outside may be out
// of view: one in 500 on each side, and those beyond three times the extent that 98 % have along an axis. Nothing
// without points or pixels.
std::optional<EyePose> view_from_above(std::vector<Vec3d> points, const PictureShape& picture);

// The former where one of the poses fits, else the latter.
std::optional<EyePose> first_view(const std::vector<Vec3d>& points, const std::vector<ScanPose>& poses,
                                  const PictureShape& picture);

// An even sample of the cloud, its coarsest chunks, source coordinates. Reads and waits; throws what L2Cache::get()
// throws.
std::vector<Vec3d> sampled_places(L2Cache& cache);

}  // namespace pcm
