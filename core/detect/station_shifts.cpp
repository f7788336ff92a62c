#include "pcm/detect/station_shifts.h"

#include "pcm/detect/node_sums.h"
#include "pcm/detect/refined_shape.h"
#include "pcm/detect/tuning.h"
#include "pcm/place/station_survey.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t least_gathered = 20;   // points of a plane
constexpr std::size_t most_references = 32;  // planes that show how far stations are apart
constexpr std::size_t least_of_station = 8;  // points that a station's mean is from
// Points of a plane, about; of very many planes fewer, so that they take 16 MB.
constexpr std::size_t most_gathered = 1000, fewest_gathered = 64, all_gathered = std::size_t(1) << 19;

// Keyed by place among the planes.
using PointsOfPlanes = std::map<std::size_t, std::vector<PointOfStation>>;

// Squared differences of the stations' mean distances from their mean, and the number of independent ones.
struct MeanDifferences {
    double squares = 0;
    std::uint32_t freedom = 0;
};

MeanDifferences differences_on(const Shape& shape, double threshold, const std::vector<PointOfStation>& points)
{
    struct Sum {
        double distance = 0;
        std::size_t count = 0;
    };
    std::map<std::uint32_t, Sum> sums;
    for (const PointOfStation& p : points) {
        const double d = signed_distance(shape, p.place);
        if (std::fabs(d) > threshold) continue;
        sums[p.station].distance += d;
        ++sums[p.station].count;
    }
    double sum = 0, squares = 0;
    std::uint32_t count = 0;
    for (const auto& [station, one] : sums) {
        if (one.count < least_of_station) continue;
        const double mean = one.distance / static_cast<double>(one.count);
        sum += mean;
        squares += mean * mean;
        ++count;
    }
    if (count < 2) return {};
    return {squares - sum * sum / count, count - 1};
}

}  // namespace

std::vector<PointOfStation> StationShifts::corrected(std::vector<PointOfStation> points) const
{
    for (PointOfStation& p : points) p.place = p.place - of(p.station);
    return points;
}

std::vector<Vec3d> StationShifts::of_points(const Tree& tree, NodeId node) const
{
    std::vector<Vec3d> all;
    if (!are_known()) return all;
    const Chunk chunk = tree.read_chunk(node, stations->columns());
    for (std::uint32_t i = 0; i < chunk.points; ++i) all.push_back(of(stations->at(chunk, i)));
    return all;
}

SeenPlanes::SeenPlanes(const ChosenPoints& points, const AssignedPoints& assigned,
                       const std::vector<Hypothesis>& hypotheses, const PointLabels& labels,
                       const StationShifts& shifts, const SeenPlanesOptions& options)
    : shifts_(shifts), options_(options)
{
    if (!shifts_.stations || shifts_.stations->source() == StationSource::none) return;
    for (std::uint32_t p = 0; p < assigned.parts.size(); ++p) {
        const SurfacePart& part = assigned.parts[p];
        const Hypothesis& from = hypotheses[part.hypothesis];
        if (!traits_of(from.shape.kind).is_flat() || part.some.size() < least_gathered) continue;
        const Shape shape = refined_shape(part.some, from.shape, 1.5 * from.threshold).value_or(from.shape);
        const double width = static_cast<double>(part.sampled) * options_.cell * options_.cell / part.box.diagonal();
        const bool is_narrow = width <= detect_tuning().contest.max_width * from.threshold;
        planes_.push_back({p, shape, from.threshold, rms_distance(shape, part.some), is_narrow, {}});
    }
    gather(points, assigned, labels);
    for (std::size_t i = 0; i < planes_.size(); ++i)
        if (is_quiet(planes_[i])) references_.push_back(i);
    std::stable_sort(references_.begin(), references_.end(), [&](std::size_t a, std::size_t b) {
        return assigned.parts[planes_[a].part].points > assigned.parts[planes_[b].part].points;
    });
    if (references_.size() > most_references) references_.resize(most_references);
    if (!shifts_.are_known()) find_shifts(points.tree());
}

void SeenPlanes::gather(const ChosenPoints& points, const AssignedPoints& assigned, const PointLabels& labels)
{
    const Tree& tree = points.tree();
    const SourceRounding rounding(tree.info());
    const std::size_t most =
        std::clamp(all_gathered / std::max<std::size_t>(planes_.size(), 1), fewest_gathered, most_gathered);
    constexpr auto no_plane = static_cast<std::size_t>(-1);
    std::vector<std::size_t> plane_of(assigned.parts.size(), no_plane);
    for (std::size_t i = 0; i < planes_.size(); ++i) plane_of[planes_[i].part] = i;
    ColumnSet columns = shifts_.stations->columns();
    columns.positions = true;
    const auto see = [&](PointsOfPlanes& to, NodeId node) {
        const std::vector<std::uint32_t> given = labels.get(node);
        std::optional<Chunk> chunk;
        for (std::uint32_t i = 0; i < given.size(); ++i) {
            if (given[i] == 0) continue;
            const std::uint32_t part = assigned.part_of(given[i] & ~interior_label);
            if (part == AssignedPoints::no_part || plane_of[part] == no_plane ||
                i % (1 + assigned.parts[part].points / most) != 0)
                continue;
            if (!chunk) chunk = tree.read_chunk(node, columns);
            to[plane_of[part]].push_back(
                {rounding(tree.info().grid.to_source(chunk->positions->grid(i))), shifts_.stations->at(*chunk, i)});
        }
    };
    const auto add = [&](const PointsOfPlanes& part) {
        for (const auto& [plane, some] : part) {
            std::vector<PointOfStation>& all = planes_[plane].points;
            all.insert(all.end(), some.begin(), some.end());
        }
    };
    sum_over_nodes<PointsOfPlanes>(tree, options_.threads, see, add, [&](double) { options_.check(); });
}

StationSums SeenPlanes::sums_of(const SeenPlane& plane)
{
    Box3d box;
    for (const PointOfStation& p : plane.points) box.extend(p.place);
    StationSums sums(plane.shape, box.centre(), std::max(box.diagonal(), plane.threshold));
    for (const PointOfStation& p : plane.points) sums.add(p.place, p.station);
    return sums;
}

bool SeenPlanes::is_quiet(const SeenPlane& plane) const
{
    const double most = detect_tuning().contest.min_noise * options_.noise;
    if (plane.rms <= most || plane.is_narrow || plane.points.empty()) return plane.rms <= most;
    const StationSums sums = sums_of(plane);
    return sums.is_determined() && sums.noise_within() <= most;
}

void SeenPlanes::find_shifts(const Tree& tree)
{
    if (references_.empty() ||
        !station_survey(tree, *shifts_.stations, planes_[references_.front()].shape.point).names_stations)
        return;
    std::vector<StationPart> parts;
    for (const std::size_t i : references_) {
        const StationSums sums = sums_of(planes_[i]);
        if (sums.stations() > 1 && sums.stations() <= StationEvidence::most_stations && sums.is_determined())
            parts.push_back({sums.evidence(sums.noise_within()), planes_[i].shape.axis});
    }
    shifts_.shifts = agreeing_evidence({}, parts).spread().shifts;
}

std::optional<double> SeenPlanes::left_along(const Vec3d& normal) const
{
    MeanDifferences all;
    for (const std::size_t i : references_) {
        const SeenPlane& plane = planes_[i];
        if (std::fabs(dot(plane.shape.axis, normal)) < detect_tuning().plates.min_cosine) continue;
        const std::vector<PointOfStation> points = shifts_.corrected(plane.points);
        const Shape shape = refined_shape(places_of(points), plane.shape, plane.threshold).value_or(plane.shape);
        const MeanDifferences here = differences_on(shape, plane.threshold, points);
        all.squares += here.squares;
        all.freedom += here.freedom;
    }
    if (all.freedom == 0) return std::nullopt;
    return std::sqrt(all.squares / all.freedom) * student_factor(all.freedom);
}

}  // namespace pcm
