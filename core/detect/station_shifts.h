// How the stations of a scanner are shifted in a cloud, from the planes that were found in it.
#pragma once

#include "pcm/detect/assign_points.h"
#include "pcm/fit/ray_errors.h"
#include "pcm/fit/station_sums.h"
#include "pcm/place/point_stations.h"
#include "pcm/place/station_sample.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

// Most probable shifts of the stations, source units. Without any where the points do not name their stations.
struct StationShifts {
    std::shared_ptr<const PointStations> stations;
    std::map<std::uint32_t, Vec3d> shifts;  // keyed by station

    bool are_known() const { return !shifts.empty(); }
    Vec3d of(std::uint32_t station) const
    {
        const auto shift = shifts.find(station);
        return shift == shifts.end() ? Vec3d{} : shift->second;
    }
    // The points with their stations where they most probably were.
    std::vector<PointOfStation> corrected(std::vector<PointOfStation> points) const;
    // The shifts of all points of a node; none where they are unknown.
    std::vector<Vec3d> of_points(const Tree& tree, NodeId node) const;
};

// A plane's part of an assignment, with some of its points.
struct SeenPlane {
    std::uint32_t part = 0;
    Shape shape;
    double threshold = 0;    // source units
    double rms = 0;          // root mean square of the points' distances from it
    bool is_narrow = false;  // narrower than floors and walls are
    std::vector<PointOfStation> points;
};

struct SeenPlanesOptions {
    double noise = 0;  // noise of the cloud, source units
    double cell = 0;   // cell of the assignment's sample, source units
    unsigned threads = 1;
    std::function<void()> check;  // called at times, by the calling thread; may throw
};

// The planes of an assignment, whose points are read once. The shifts are those of the largest planes that have no more
// noise than the cloud, wide ones within their stations: a narrow plane in layers may be several. The result does not
// depend on threads.
class SeenPlanes {
public:
    // `shifts`: known already, or with stations only. Throws what reading and options.check throw.
    SeenPlanes(const ChosenPoints& points, const AssignedPoints& assigned, const std::vector<Hypothesis>& hypotheses,
               const PointLabels& labels, const StationShifts& shifts, const SeenPlanesOptions& options);

    const std::vector<SeenPlane>& planes() const { return planes_; }
    const StationShifts& shifts() const { return shifts_; }
    // Standard deviation of the stations' mean distances from planes of about this normal that their shifts leave,
    // source units; nothing where no plane shows it.
    std::optional<double> left_along(const Vec3d& normal) const;

private:
    void gather(const ChosenPoints& points, const AssignedPoints& assigned, const PointLabels& labels);
    static StationSums sums_of(const SeenPlane& plane);
    bool is_quiet(const SeenPlane& plane) const;
    void find_shifts(const Tree& tree);

    StationShifts shifts_;
    SeenPlanesOptions options_;
    std::vector<SeenPlane> planes_;
    std::vector<std::size_t> references_;  // places of the largest quiet ones
};

}  // namespace pcm
