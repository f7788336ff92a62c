#include "pcm/detect/errors_of_stations.h"

#include "pcm/detect/node_sums.h"
#include "pcm/detect/point_labels.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/point_stations.h"
#include "pcm/place/refit.h"
#include "pcm/place/station_errors.h"
#include "pcm/place/station_survey.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_points.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr const char* comparing = "Comparing stations";
constexpr std::size_t most_surveyed = 4;      // places around which surfaces are compared
constexpr std::uint64_t most_summed = 20000;  // points of a shape, about, that its stations are compared by
// Points of a shape, about, that errors along rays are found from; of very many shapes fewer, so that they take 64 MB.
constexpr std::size_t most_sampled = 2000, least_sampled = 200, all_sampled = std::size_t(2) << 20;

// Half of a shape's extent around its middle holds about all of its points.
double extent_of(const Primitive& primitive)
{
    const Shape& shape = primitive.fit.shape;
    Box3d box;
    for (const Vec3d& corner : primitive.bounds.outline) box.extend(corner);
    const double flat = box.empty() ? 0 : box.diagonal();
    return std::max({flat, primitive.bounds.to - primitive.bounds.from, 2 * shape.radius, primitive.fit.threshold});
}

// What is summed over the points of one shape.
struct ShapePoints {
    explicit ShapePoints(const StationSums& none) : sums(none) {}
    void add(const ShapePoints& other)
    {
        sums.add(other.sums);
        box.extend(other.box);
        sample.insert(sample.end(), other.sample.begin(), other.sample.end());
    }
    StationSums sums;
    Box3d box;
    std::vector<PointOfStation> sample;
};

// Keyed by label - 1.
using PointsOfShapes = std::map<std::uint32_t, ShapePoints>;
using AgreementOfShapes = std::map<std::uint32_t, ErrorAgreement>;

class StationsOfShapes {
public:
    StationsOfShapes(const Tree& tree, const DetectOptions& options, DetectReport& report)
        : tree_(tree),
          rounding_(tree.info()),
          threads_(thread_count(options.threads)),
          metres_per_unit_(metres_per_unit(tree.info().metadata)),
          registration_(options.registration / 1000 / metres_per_unit_),
          watch_(options.progress),
          report_(report),
          primitives_(report.primitives),
          stations_(tree)
    {
        report_.agreement.resize(primitives_.size(), 1);
    }

    void run()
    {
        watch_.report(comparing, 0, true);
        if (!primitives_.empty()) add_errors();
        watch_.finish("Done");
        report_.outcome.seconds += watch_.seconds();
    }

private:
    void add_errors()
    {
        survey();
        std::vector<ShapePoints> points = sum_points();
        std::vector<Shape> before;
        for (const Primitive& primitive : primitives_) before.push_back(primitive.fit.shape);
        for (std::size_t i = 0; i < primitives_.size() && is_known_; ++i)
            leave_turned(report_.agreement[i], points[i], primitives_[i]);
        if (is_known_) find_agreement(points);
        const StationSpread found = is_known_ ? spread_of(points) : StationSpread();
        for (std::size_t i = 0; i < primitives_.size(); ++i) {
            Primitive& primitive = primitives_[i];
            primitive.stations->stations = is_known_ ? number_of(points[i]) : 0;
            if (can_compare(points[i]))
                add_known_spread(points[i].sums, found, reach_, within_[i], report_.agreement[i], primitive);
            else
                add_unknown_spread(reach_, primitive);
            leave_ray_errors(points[i].sample, metres_per_unit_, primitive);
            keep_within(before[i], points[i].box, primitive.fit);
            report_.outcome.error = std::max(report_.outcome.error, primitive.fit.threshold);
        }
    }

    static std::uint32_t number_of(const ShapePoints& points)
    {
        return static_cast<std::uint32_t>(points.sums.stations());
    }

    bool can_compare(const ShapePoints& points) const
    {
        return is_known_ && points.sums.stations() <= StationEvidence::most_stations && points.sums.is_determined();
    }

    // Compares the stations around some of the shapes, from the largest to the smallest.
    void survey()
    {
        is_known_ = stations_.source() != StationSource::none;
        const std::size_t count = is_known_ ? std::min(primitives_.size(), most_surveyed) : 0;
        std::vector<StationSurvey> places;
        for (std::size_t i = 0; i < count; ++i) {
            const Shape& shape = primitives_[i * primitives_.size() / count].fit.shape;
            places.push_back(station_survey(tree_, stations_, shape.point));
            reach_ = places.back().reach;
            for (StationPart& part : places.back().parts()) surfaces_.push_back(std::move(part));
        }
        is_known_ = is_known_ && name_stations(places);
        if (!(reach_ > 0) && registration_ > 0)
            reach_ = station_survey(tree_, stations_, primitives_.front().fit.shape.point).reach;
        for (Primitive& primitive : primitives_) {
            StationFacts& facts = primitive.stations.emplace();
            facts.source = is_known_ ? stations_.source() : StationSource::none;
            facts.registration = registration_;
        }
    }

    // Calls see(part, label - 1, place, station, place in the chunk) for each point with a label.
    template <class Part, class See>
    void for_each_point(Part& part, NodeId node, const See& see) const
    {
        const std::vector<std::uint32_t> labels = report_.labels->get(node);
        if (std::all_of(labels.begin(), labels.end(), [](std::uint32_t l) { return l == 0; })) return;
        ColumnSet columns = stations_.columns();
        columns.positions = true;
        const Chunk chunk = tree_.read_chunk(node, columns);
        for (std::uint32_t i = 0; i < labels.size(); ++i)
            if (labels[i] > 0)
                see(part, labels[i] - 1, rounding_(tree_.info().grid.to_source(chunk.positions->grid(i))),
                    is_known_ ? stations_.at(chunk, i) : 0, i);
    }

    std::vector<ShapePoints> sum_points()
    {
        std::vector<ShapePoints> sums;
        for (const Primitive& one : primitives_)
            sums.emplace_back(StationSums(one.fit.shape, one.fit.shape.point, extent_of(one)));
        const std::vector<ShapePoints> none = sums;
        const std::size_t most =
            std::clamp(all_sampled / std::max<std::size_t>(primitives_.size(), 1), least_sampled, most_sampled);
        const auto see = [&](PointsOfShapes& part, NodeId node) {
            for_each_point(part, node,
                           [&](PointsOfShapes& to, std::uint32_t shape, const Vec3d& p, std::uint32_t station,
                               std::uint32_t number) {
                               const std::uint64_t points = primitives_[shape].points;
                               ShapePoints& own = to.emplace(shape, none[shape]).first->second;
                               own.box.extend(p);
                               if (is_known_ && number % (1 + points / most_summed) == 0) own.sums.add(p, station);
                               const bool is_flat = traits_of(primitives_[shape].fit.shape.kind).is_flat();
                               if (!is_flat && number % (1 + points / most) == 0) own.sample.push_back({p, station});
                           });
        };
        const auto add = [&](const PointsOfShapes& part) {
            for (const auto& [shape, points] : part) sums[shape].add(points);
        };
        sum_over_nodes<PointsOfShapes>(tree_, threads_, see, add,
                                       [&](double share) { watch_.report(comparing, 0.5 * share); });
        return sums;
    }

    // Agreement of neighbours that is left within stations.
    void find_agreement(const std::vector<ShapePoints>& points)
    {
        within_ = report_.agreement;
        std::vector<std::optional<ShiftedFit>> shifted(points.size());
        std::vector<ErrorAgreement> none;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const StationSums& sums = points[i].sums;
            none.emplace_back(points[i].box.min, points[i].box.diagonal() / place_tuning().growth.agreement_cubes);
            if (!(within_[i] > 1) || sums.stations() < 2 || !can_compare(points[i])) continue;
            const double noise = sums.noise_within();
            shifted[i] = sums.shifted(sums.evidence(noise).spread().spread, noise);
        }
        std::vector<ErrorAgreement> all = none;
        const auto see = [&](AgreementOfShapes& part, NodeId node) {
            for_each_point(
                part, node,
                [&](AgreementOfShapes& to, std::uint32_t shape, const Vec3d& p, std::uint32_t station, std::uint32_t) {
                    if (shifted[shape])
                        to.emplace(shape, none[shape])
                            .first->second.add(p, points[shape].sums.distance(*shifted[shape], p, station));
                });
        };
        const auto add = [&](const AgreementOfShapes& part) {
            for (const auto& [shape, agreement] : part) all[shape].add(agreement);
        };
        sum_over_nodes<AgreementOfShapes>(tree_, threads_, see, add,
                                          [&](double share) { watch_.report(comparing, 0.5 + 0.5 * share); });
        for (std::size_t i = 0; i < points.size(); ++i)
            if (shifted[i]) within_[i] = std::min(within_[i], all[i].factor());
    }

    StationSpread spread_of(const std::vector<ShapePoints>& points) const
    {
        std::vector<StationPart> parts = surfaces_;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (const StationSums& sums = points[i].sums;
                primitives_[i].fit.verdict == FitVerdict::good && sums.stations() > 1 && can_compare(points[i]))
                parts.push_back({sums.evidence(sums.noise_within() * within_[i]), primitives_[i].fit.shape.axis});
        return agreeing_evidence({}, parts).spread();
    }

    // What follows sees the points that face their stations.
    static void leave_turned(double alike, ShapePoints& points, Primitive& primitive)
    {
        std::vector<PointOfStation> facing =
            facing_points(StationDirections(primitive.fit.shape, points.sample), points.sample);
        if (facing.size() == points.sample.size()) return;
        leave_turned_points(facing, points.sample, alike, primitive.fit);
        StationSums sums(primitive.fit.shape, primitive.fit.shape.point, extent_of(primitive));
        for (const PointOfStation& p : facing) sums.add(p.place, p.station);
        points.sums = std::move(sums);
        points.sample = std::move(facing);
    }

    const Tree& tree_;
    const SourceRounding rounding_;
    const unsigned threads_;
    const double metres_per_unit_, registration_;  // the latter in source units
    Watch watch_;
    DetectReport& report_;
    std::vector<Primitive>& primitives_;
    const PointStations stations_;
    bool is_known_ = false;  // whether points say from which station they are
    double reach_ = 0;       // how far stations see, source units; 0: not needed
    std::vector<StationPart> surfaces_;
    std::vector<double> within_;  // factors of agreement within stations, keyed by label - 1
};

}  // namespace

void add_errors_of_stations(const std::shared_ptr<const Tree>& tree, const DetectOptions& options, DetectReport& report)
{
    StationsOfShapes(*tree, options, report).run();
}

}  // namespace pcm
