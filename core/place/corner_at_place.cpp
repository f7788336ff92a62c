#include "pcm/place/corner_at_place.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/even_noise.h"
#include "pcm/place/face_at_place.h"
#include "pcm/place/narrow_strip.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcm {
namespace {

constexpr int border_directions = 72;  // in which the border of a plane is looked for
constexpr int most_rounds = 6;         // in which the planes of a corner settle

double height(const Shape& plane, const Vec3d& p) { return dot(plane.axis, p - plane.point); }

class CornerSearch {
public:
    CornerSearch(const Vec3d& place, const FitPoints& points, double noise, const ShapeFitOptions& fit)
        : place_(place), noise_(noise), least_noise_(noise / 2), points_(points.sources())
    {
        ShapeFitOptions options = fit;
        options.kind = ShapeKind::plane;
        options.threshold = tuned_.plane_noises * noise;
        options.progress = {};
        const ShapeFit widest = fit_shape(points, options);
        if (!widest.has_shape()) return;
        corner_.widest = widest.shape;
        for (std::size_t i = 0; i < points_.size(); ++i)
            if (widest.is_inlier[i]) on_widest_.push_back(points_[i]);
    }

    std::optional<Corner> run()
    {
        if (static_cast<double>(on_widest_.size()) < tuned_.min_share * static_cast<double>(points_.size())) return {};
        Shape border = border_of_widest();
        const double within = border_distance_;
        if (within > tuned_.max_within * noise_) {
            if (std::fabs(height(corner_.widest, place_)) > tuned_.reach_noises * noise_) return {};
            corner_.noise = noise_;
            corner_.margin = within / noise_;
            return corner_;
        }
        if (orient(border)) find_back(border);
        border.point = place_ + within * border.axis;
        corner_.edge = border;
        for (int round = 0; round < most_rounds; ++round) refine();
        if (!is_edge_shown()) {
            corner_.edge.reset();
            corner_.margin = within / noise_;
            corner_.noise = noise_;
            return corner_;
        }
        set_face();
        return corner_;
    }

private:
    // The plane across the widest one beyond which fewest of its points lie, through the place.
    Shape border_of_widest()
    {
        const AxisFrame frame(corner_.widest.axis);
        const std::size_t beyond =
            std::min(on_widest_.size() - 1,
                     2 + static_cast<std::size_t>(tuned_.beyond_border * static_cast<double>(on_widest_.size())));
        Shape border = corner_.widest;
        border.point = place_;
        border_distance_ = infinity;
        std::vector<double> outwards(on_widest_.size());
        for (int k = 0; k < border_directions; ++k) {
            const Vec3d out = frame.at(2 * pi * k / border_directions);
            for (std::size_t i = 0; i < on_widest_.size(); ++i) outwards[i] = dot(out, on_widest_[i] - place_);
            const auto last = outwards.end() - 1 - static_cast<std::ptrdiff_t>(beyond);
            std::nth_element(outwards.begin(), last, outwards.end());
            if (*last < border_distance_) border_distance_ = *last, border.axis = out;
        }
        return border;
    }

    // The face at the border lies behind the widest one. False where no points show on which side.
    bool orient(const Shape& border)
    {
        Shape& widest = corner_.widest;
        double balance = 0;
        for (const Vec3d& p : points_) {
            const double d = height(widest, p);
            if (std::fabs(height(border, p)) <= tuned_.plane_noises * noise_ + std::fabs(border_distance_) &&
                std::fabs(d) > tuned_.plane_noises * noise_)
                balance += d > 0 ? 1 : -1;
        }
        const double at_place = height(widest, place_);
        if (balance == 0) balance = std::fabs(at_place) > noise_ ? at_place : 0;
        if (balance > 0) widest.axis = -1.0 * widest.axis;
        return balance != 0;
    }

    // The other face of a plate: where most of the points behind the widest one, away from the border, lie on one
    // plane.
    void find_back(const Shape& border)
    {
        std::vector<double> behind;
        for (const Vec3d& p : points_)
            if (height(border, p) < -tuned_.plane_noises * noise_ &&
                height(corner_.widest, p) < -tuned_.plane_noises * noise_)
                behind.push_back(height(corner_.widest, p));
        const auto count = static_cast<double>(behind.size());
        if (count < tuned_.min_back * static_cast<double>(points_.size())) return;
        const auto middle = behind.begin() + static_cast<std::ptrdiff_t>(behind.size() / 2);
        std::nth_element(behind.begin(), middle, behind.end());
        const double gap = *middle;
        const auto near = std::count_if(behind.begin(), behind.end(),
                                        [&](double d) { return std::fabs(d - gap) <= tuned_.plane_noises * noise_; });
        if (static_cast<double>(near) < tuned_.min_back_near * count) return;
        corner_.back = corner_.widest;
        corner_.back->point = corner_.widest.point + gap * corner_.widest.axis;
        corner_.back->axis = -1.0 * corner_.widest.axis;
    }

    struct Heights {
        std::array<double, 3> of{};  // widest, edge, back
        std::size_t greatest = 0;
        double next = 0;  // the greatest one of the others
    };
    Heights heights(const Vec3d& p) const
    {
        Heights found{
            {height(corner_.widest, p), height(*corner_.edge, p), corner_.back ? height(*corner_.back, p) : -infinity},
            0,
            0};
        for (std::size_t k = 1; k < 3; ++k)
            if (found.of[k] > found.of[found.greatest]) found.greatest = k;
        found.next = -infinity;
        for (std::size_t k = 0; k < 3; ++k)
            if (k != found.greatest) found.next = std::max(found.next, found.of[k]);
        return found;
    }

    // Moves the planes to the points that belong to them.
    void refine()
    {
        std::array<std::vector<Vec3d>, 3> own;
        for (const Vec3d& p : points_) {
            const Heights at = heights(p);
            if (std::fabs(at.of[at.greatest]) <= tuned_.reach_noises * noise_) own[at.greatest].push_back(p);
        }
        learn_noise(own);
        move(own[0], corner_.widest);
        move(own[1], *corner_.edge);
        if (corner_.back) move(own[2], *corner_.back);
    }

    // Noise of neighbours is that of several faces where these are narrow.
    void learn_noise(const std::array<std::vector<Vec3d>, 3>& own)
    {
        std::vector<double> away;
        for (const Vec3d& p : own[0]) away.push_back(std::fabs(height(corner_.widest, p)));
        for (const Vec3d& p : own[1]) away.push_back(std::fabs(height(*corner_.edge, p)));
        for (const Vec3d& p : own[2]) away.push_back(std::fabs(height(*corner_.back, p)));
        if (away.empty()) return;
        const auto middle = away.begin() + static_cast<std::ptrdiff_t>(away.size() / 2);
        std::nth_element(away.begin(), middle, away.end());
        if (*middle > 0) noise_ = std::min(noise_, std::max(least_noise_, 1.4826 * *middle));
    }

    // By least squares; along the directions in which the points are not spread by more than their noise, the plane
    // keeps its own.
    void move(const std::vector<Vec3d>& own, Shape& plane) const
    {
        if (own.size() < 4) return;
        Vec3d middle{};
        for (const Vec3d& p : own) middle = middle + (p - place_);
        middle = place_ + middle / static_cast<double>(own.size());
        SquareMatrix<2> spread{};
        std::array<double, 2> tilt{};
        const AxisFrame frame(plane.axis);
        const std::array<Vec3d, 2> along{frame.u, frame.v};
        for (const Vec3d& p : own) {
            const Vec3d d = p - middle;
            for (std::size_t a = 0; a < 2; ++a) {
                tilt[a] += dot(along[a], d) * dot(plane.axis, d);
                for (std::size_t b = 0; b < 2; ++b) spread[a][b] += dot(along[a], d) * dot(along[b], d);
            }
        }
        const Eigensystem<2> system = eigensystem<2>(spread);
        Vec3d axis = plane.axis;
        const double least = std::pow(tuned_.min_spread * noise_, 2) * static_cast<double>(own.size());
        for (std::size_t k = 0; k < 2; ++k) {
            if (!(system.values[k] > least)) continue;
            const Vec3d direction = system.vectors[k][0] * along[0] + system.vectors[k][1] * along[1];
            const double pull = system.vectors[k][0] * tilt[0] + system.vectors[k][1] * tilt[1];
            axis = axis - pull / system.values[k] * direction;
        }
        plane.axis = normalised(axis);
        plane.point = middle;
    }

    // Points of the edge's face that noise of the others does not explain.
    bool is_edge_shown() const
    {
        double own = 0, others = 0;
        for (const Vec3d& p : points_) {
            const Heights at = heights(p);
            const double away = at.of[1];
            if (std::fabs(away) > tuned_.plane_noises * noise_) continue;
            if (at.greatest == 1 && at.next < -noise_)
                own += 1;
            else
                others += 1;
        }
        return own >= tuned_.min_edge_points && own > tuned_.min_edge_share * others;
    }

    void set_face()
    {
        const Heights at = heights(place_);
        corner_.noise = noise_;
        corner_.face = static_cast<Corner::Face>(at.greatest);
        corner_.margin = (at.of[at.greatest] - at.next) / noise_;
        corner_.away = std::fabs(at.of[at.greatest]) / noise_;
        double held = 0;
        for (const Vec3d& p : points_) {
            const Heights own = heights(p);
            held += std::fabs(own.of[own.greatest]) <= tuned_.reach_noises * noise_;
        }
        corner_.held = held / static_cast<double>(points_.size());
    }

    const CornerAtPlaceTuning& tuned_ = place_tuning().corners;
    const Vec3d place_;
    double noise_;
    const double least_noise_;
    const std::vector<Vec3d> points_;
    std::vector<Vec3d> on_widest_;
    double border_distance_ = infinity;  // way from the place to the border, positive within it
    Corner corner_;
};

// One standard deviation: that of most of the points or of the nearest ones.
double noise_at(const NearPoints& close)
{
    const double of_most = automatic_threshold(close.points) / fit_tuning().thresholds.inlier_noises;
    const double nearest = even_noise(close.points.sources()).noise;
    return of_most > 0 && nearest > 0 ? std::min(of_most, nearest) : std::max(of_most, nearest);
}

// Whether the faces hold the points, and one of them the place: a pipe is no corner.
bool is_of_place(const Corner& corner)
{
    const CornerAtPlaceTuning& tuned = place_tuning().corners;
    return corner.edge && corner.away <= tuned.reach_noises && corner.held >= tuned.min_held;
}

// Whether the place may lie on the face next to it: fewer faces show that than show which one has it.
bool may_be_of_place(const std::optional<Corner>& corner)
{
    const CornerAtPlaceTuning& tuned = place_tuning().corners;
    if (!corner || !corner->edge) return false;
    return is_of_place(*corner) || (corner->away <= tuned.reach_noises && corner->held >= tuned.min_held_to_doubt &&
                                    corner->margin < tuned.min_margin);
}

bool is_clear(const std::optional<Corner>& corner)
{
    return corner && is_of_place(*corner) && corner->margin >= place_tuning().corners.min_margin;
}

// The face next to the widest one may end at the place, too.
Corner within(const Corner& corner, const Vec3d& place, const FitPoints& points, const ShapeFitOptions& fit)
{
    const std::optional<Region> side = corner.side(place);
    FitPoints own;
    own.origin = points.origin;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!side || side->contains(points.source(i))) own.add(points.source(i));
    std::optional<Corner> inner = corner_at(place, own, corner.noise, fit);
    if (!is_clear(inner)) {
        const std::optional<Corner> of_less = corner_at(place, own, corner.noise / 2, fit);
        if (is_clear(of_less)) inner = of_less;
    }
    if (!inner) return corner;
    inner->outer = corner.outer;
    for (const Shape* other :
         {&corner.widest, corner.edge ? &*corner.edge : nullptr, corner.back ? &*corner.back : nullptr})
        if (other && other != &corner.plane_at_place()) inner->outer.emplace_back(corner.plane_at_place(), *other);
    return *inner;
}

NearPoints points_in(const NearPoints& close, const std::optional<Region>& side, const Shape& plane, double threshold)
{
    NearPoints own;
    own.points.origin = close.points.origin;
    own.radius = close.radius;
    own.spacing = close.spacing;
    for (std::size_t i = 0; i < close.ids.size(); ++i) {
        const Vec3d p = close.points.source(i);
        if ((side && !side->contains(p)) || std::fabs(height(plane, p)) > threshold) continue;
        own.ids.push_back(close.ids[i]);
        if (close.points.has_normals())
            own.points.add(p, close.points.normal(i));
        else
            own.points.add(p);
    }
    own.found = own.ids.size();
    return own;
}

}  // namespace

const Shape& Corner::plane_at_place() const { return face == Face::edge ? *edge : face == Face::back ? *back : widest; }

std::optional<Region> Corner::side(const Vec3d& place) const
{
    const Shape& own = plane_at_place();
    std::vector<Region::Plane> sides;
    for (const auto& [ended, other] : outer)
        sides.push_back({ended.axis - other.axis, height(ended, place) - height(other, place)});
    for (const Shape* other : {&widest, edge ? &*edge : nullptr, back ? &*back : nullptr})
        if (other && other != &own)
            sides.push_back({own.axis - other->axis, height(own, place) - height(*other, place)});
    if (sides.empty()) return {};
    return Region::convex(place, sides);
}

std::optional<Corner> corner_at(const Vec3d& place, const FitPoints& points, double noise, const ShapeFitOptions& fit)
{
    return CornerSearch(place, points, noise, fit).run();
}

std::optional<Corner> corner_near(const Vec3d& place, const NearPoints& close, const ShapeFitOptions& fit)
{
    const double noise = noise_at(close);
    if (!(noise > 0)) return {};
    std::optional<Corner> corner = corner_at(place, close.points, noise, fit);
    if (!is_clear(corner)) {
        std::optional<Corner> of_less = corner_at(place, close.points, noise / 2, fit);
        if (is_clear(of_less) || (!may_be_of_place(corner) && may_be_of_place(of_less))) corner = std::move(of_less);
    }
    if (corner && corner->edge && !may_be_of_place(corner)) return {};
    const bool is_far = is_clear(corner) && corner->face != Corner::Face::widest &&
                        corner->margin > 2 * place_tuning().corners.max_within;
    return is_far ? within(*corner, place, close.points, fit) : corner;
}

std::optional<CornerFace> fit_corner(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options)
{
    const std::optional<NearPoints> close = near_faces(cloud, place, options);
    if (!close) return {};
    const std::optional<Corner> corner = corner_near(place, *close, options.fit);
    if (!corner) return {};
    CornerFace found{*corner, {}};
    if (corner->edge ? !is_clear(corner) : corner->margin < place_tuning().corners.max_within) return found;
    LocalFit local;
    const double threshold = place_tuning().evidence.spread_noises * corner->noise;
    local.near = points_in(*close, corner->side(place), corner->plane_at_place(), threshold);
    RefineOptions refine;
    refine.threshold = threshold;
    local.fit = refine_shape(local.near.points, corner->plane_at_place(), refine);
    local.fit.threshold = threshold;
    local.noise = fit_tuning().thresholds.inlier_noises * corner->noise;
    local.close = local.near;
    local.notes.push_back("there are several faces around the place: the " + grouped(local.near.ids.size()) +
                          " points of its own one were fitted");
    found.is_narrow = narrowest_spread(local.near.points.sources()) < place_tuning().corners.min_spread * corner->noise;
    if (local.fit.has_shape()) found.local = std::move(local);
    return found;
}

}  // namespace pcm
