#include "pcm/place/station_errors.h"

#include "pcm/fit/ray_errors.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/refit.h"
#include "pcm/place/station_sample.h"
#include "pcm/place/station_scan.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_points.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t most_sampled_points = 4000;  // from which the bias of errors along rays is found

double together(double a, double b) { return std::hypot(a, b); }

void add_in_quadrature(ShapeErrors& errors, const ShapeErrors& other)
{
    errors.position = together(errors.position, other.position);
    errors.angle = together(errors.angle, other.angle);
    errors.radius = together(errors.radius, other.radius);
    errors.second = together(errors.second, other.second);
}

double turn_of(double shift, double reach) { return reach > 0 ? shift / reach : 0; }

// Where it is unknown which points are moved together.
ShapeErrors errors_of_unknown_stations(const ShapeFit& fit, const StationMoves& moves)
{
    const double spread = moves.shift;
    const double per_length = fit.errors.position > 0 ? spread / fit.errors.position : 0;
    ShapeErrors errors;
    errors.position = spread;
    if (std::isfinite(per_length) && std::isfinite(fit.errors.angle)) errors.angle = per_length * fit.errors.angle;
    if (traits_of(fit.shape.kind).axis != ShapeAxis::none) errors.angle = together(errors.angle, moves.turn);
    for (const ShapeSize& size : traits_of(fit.shape.kind).sizes)
        errors.*size.error = size.unit == SizeUnit::length ? spread : per_length * fit.errors.*size.error;
    return errors;
}

void doubt_uncertain_size(ShapeFit& fit)
{
    if (is_size_certain(fit)) return;
    doubt(fit, FitIssue::thin_arc,
          "the points cover too little of the shape for how far stations are apart, so its size is uncertain: take "
          "points farther around it");
}

// Planes may be rough.
void doubt_noise(double noise, double smooth, ShapeFit& fit)
{
    const bool is_flat = traits_of(fit.shape.kind).is_flat();
    if (is_flat || !(smooth > 0) || !(noise > place_tuning().following.max_noise_within * smooth)) return;
    doubt(fit, FitIssue::other_surface,
          "points of one station leave it by " + brief(noise) + ", those of smooth surfaces around by " +
              brief(smooth) + ": it may hold several surfaces, so take a smaller neighbourhood, or give a threshold");
}

// Agreement of neighbours that is left when the stations' shifts are removed.
double agreement_within(StationScan& scan, const StationSums& sums, double spread, double noise, const Box3d& box)
{
    const ShiftedFit shifted = sums.shifted(spread, noise);
    const ErrorAgreement none(box.min, box.diagonal() / place_tuning().growth.agreement_cubes);
    return scan
        .sums(none, [&](ErrorAgreement& part, const Vec3d& p,
                        std::uint32_t station) { part.add(p, sums.distance(shifted, p, station)); })
        .factor();
}

}  // namespace

void leave_ray_errors(const std::vector<PointOfStation>& sample, double metres_per_unit, Primitive& primitive)
{
    ShapeFit& fit = primitive.fit;
    if (traits_of(fit.shape.kind).is_flat() || sample.empty()) return;
    Box3d box;
    for (const PointOfStation& p : sample) box.extend(p.place);
    const RayErrorTuning& tuned = fit_tuning().ray_errors;
    const auto better =
        without_ray_errors(fit.shape, sample, box.centre(), box.diagonal(), tuned.widest_beam / metres_per_unit);
    if (!better) return;
    ShapeErrors left = difference_of(fit.shape, better->shape, box.centre());
    enlarge(left, tuned.left);
    const ShapeErrors of_beam = difference_of(better->shape, better->of_wider_beam, box.centre());
    fit.shape = better->shape;
    primitive.stations->ray_share = better->share;
    add_in_quadrature(fit.errors, left);
    add_in_quadrature(fit.errors, of_beam);
}

void keep_within(const Shape& before, const Box3d& box, ShapeFit& fit)
{
    const ShapeErrors moved = difference_of(before, fit.shape, box.centre());
    fit.threshold += moved.position + moved.radius + moved.angle * box.diagonal() / 2;
}

void add_unknown_spread(double reach, Primitive& primitive)
{
    StationFacts& facts = *primitive.stations;
    if (!(facts.registration > 0)) return;
    facts.turn = turn_of(facts.registration, reach);
    add_in_quadrature(primitive.fit.errors,
                      errors_of_unknown_stations(primitive.fit, {facts.registration, facts.turn}));
    doubt_uncertain_size(primitive.fit);
}

void add_known_spread(const StationSums& sums, const StationSpread& found, double reach, double within,
                      double& agreement, Primitive& primitive)
{
    StationFacts& facts = *primitive.stations;
    ShapeFit& fit = primitive.fit;
    facts.freedom = found.freedom;
    facts.spread = found.spread;
    if (const double as_one = sums.noise_as_one(); facts.stations > 1 && as_one > 0)
        enlarge(fit.errors, std::min(1.0, sums.noise_within() / as_one) * within / agreement);
    agreement = within;
    const double spread = std::max(found.spread * student_factor(found.freedom), facts.registration);
    if (!(spread > 0)) return;
    facts.turn = turn_of(spread, reach);
    add_in_quadrature(fit.errors, sums.errors_of({spread, facts.turn}));
    doubt_uncertain_size(fit);
}

namespace {

// `directions`: those of the shape before turned points were left out; null: all points count.
void add_spread_of_stations(const PointSet& points, StationsAround& around, const StationErrorOptions& options,
                            const StationDirections* directions, double& agreement, Primitive& primitive)
{
    StationFacts& facts = primitive.stations.emplace();
    facts.registration = options.registration;
    facts.source = around.are_named() ? around.points().source() : StationSource::none;
    const double reach = around.survey().reach;
    if (facts.source == StationSource::none) return add_unknown_spread(reach, primitive);
    StationScan scan(points, around.points(), {options.threads, part_of(options.progress, 0.25, 1), 3});
    const Box3d box = scan.sums(Box3d(), [](Box3d& part, const Vec3d& p, std::uint32_t) { part.extend(p); });
    const StationSums sums = scan.sums(StationSums(primitive.fit.shape, box.centre(), box.diagonal()),
                                       [&](StationSums& part, const Vec3d& p, std::uint32_t station) {
                                           if (!directions || directions->can_see(p, station)) part.add(p, station);
                                       });
    facts.stations = static_cast<std::uint32_t>(sums.stations());
    if (!sums.is_determined()) return;
    if (options.doubt_noise) doubt_noise(sums.noise_within(), around.survey().noise(), primitive.fit);
    if (facts.stations > StationEvidence::most_stations) return add_unknown_spread(reach, primitive);
    StationEvidence own;
    double within = agreement;
    if (facts.stations > 1) {
        const double noise = sums.noise_within();
        const double spread = sums.evidence(noise).spread().spread;
        if (agreement > 1) within = std::min(agreement, agreement_within(scan, sums, spread, noise, box));
        own = sums.evidence(noise * within);
    }
    add_known_spread(sums, around.spread_with(own), reach, within, agreement, primitive);
}

}  // namespace

void add_station_errors(const PointSet& points, StationsAround& around, const StationErrorOptions& options,
                        double& agreement, Primitive& primitive)
{
    if (!primitive.fit.has_shape() || points.empty()) return;
    if (traits_of(primitive.fit.shape.kind).is_flat())
        return add_spread_of_stations(points, around, options, nullptr, agreement, primitive);
    std::vector<PointOfStation> sample = station_sample(points, around.points(), most_sampled_points, options.threads,
                                                        part_of(options.progress, 0, 0.25));
    Box3d box;
    for (const PointOfStation& p : sample) box.extend(p.place);
    const Shape before = primitive.fit.shape;
    std::optional<StationDirections> directions;
    if (around.are_named()) {
        directions.emplace(before, sample);
        std::vector<PointOfStation> facing = facing_points(*directions, sample);
        if (facing.size() < sample.size()) leave_turned_points(facing, sample, agreement, primitive.fit);
        sample = std::move(facing);
    }
    add_spread_of_stations(points, around, options, directions ? &*directions : nullptr, agreement, primitive);
    leave_ray_errors(sample, options.metres_per_unit, primitive);
    keep_within(before, box, primitive.fit);
}

}  // namespace pcm
