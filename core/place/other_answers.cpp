#include "pcm/place/other_answers.h"

#include "pcm/place/corner_at_place.h"
#include "pcm/place/face_at_place.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/thin_pipe.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape.h"

#include <cmath>
#include <utility>

namespace pcm {
namespace {

bool is_good(const FittedPrimitive& found) { return found.primitive.fit.verdict == FitVerdict::good; }

bool is_flat(const FittedPrimitive& found) { return traits_of(found.primitive.fit.shape.kind).is_flat(); }

// Whether a thin pipe is still the same one where it was followed. Among the noise of a surface are pieces of pipes by
// chance.
bool is_followed(const FittedPrimitive& thin, double most_noise)
{
    const ShapeFit& fit = thin.primitive.fit;
    const double most = place_tuning().thin_pipes.max_change, radius = thin.local.shape.radius;
    return fit.shape.kind == ShapeKind::cylinder && fit.noise < most_noise && fit.shape.radius < most * radius &&
           radius < most * fit.shape.radius;
}

void doubt_narrow(ShapeFit& fit)
{
    doubt(fit, FitIssue::thin_arc,
          "the face at the place is hardly wider than its noise, so points of the faces next to it may have moved it");
}

}  // namespace

FittedPrimitive OtherAnswers::or_thin_pipe(FittedPrimitive found) const
{
    if (is_good(found) && found.primitive.fit.noise < place_tuning().thin_pipes.min_noise * smooth_noise_) return found;
    const double most = is_good(found) ? place_tuning().thin_pipes.max_noise * found.primitive.fit.noise : infinity;
    std::optional<LocalFit> pipe = fit_thin_pipe(cloud_, place_, options_, most);
    if (!pipe) return found;
    FittedPrimitive thin = follow_(std::move(*pipe), {});
    if (!is_good(thin) || !is_followed(thin, most)) return found;
    // The edge of two faces is a pipe of more noise.
    const std::optional<CornerFace> at = fit_corner(cloud_, place_, options_);
    const bool is_edge = at && at->corner.edge && at->corner.held >= place_tuning().corners.min_held &&
                         at->corner.noise < thin.primitive.fit.noise;
    return is_edge ? found : thin;
}

FittedPrimitive OtherAnswers::or_face(FittedPrimitive found) const
{
    const bool may_be_two = !is_flat(found) && found.agreement > place_tuning().following.max_other_agreement;
    if (is_good(found) && !may_be_two) return found;
    std::optional<LocalFit> face = fit_face(cloud_, place_, options_);
    if (!face) return found;
    FittedPrimitive of_face = follow_(std::move(*face), {});
    return is_good(of_face) ? of_face : found;
}

FittedPrimitive OtherAnswers::or_corner(FittedPrimitive found) const
{
    if (is_good(found) && !is_flat(found)) return found;
    std::optional<CornerFace> at = fit_corner(cloud_, place_, options_);
    if (!at) return found;
    const Corner& corner = at->corner;
    if (!is_flat(found) && corner.held < place_tuning().corners.min_held_of_curved) return found;
    const bool is_same = is_plane(found.primitive, corner.plane_at_place());
    const bool is_other = corner.edge ? !(is_good(found) && is_same) : is_good(found) && !is_same;
    if (at->local && is_other) {
        std::optional<Clip> clip;
        if (const auto side = corner.side(place_)) clip = Clip{*side, false};
        FittedPrimitive of_face = follow_(std::move(*at->local), clip);
        if (at->is_narrow) doubt_narrow(of_face.primitive.fit);
        const bool is_face = is_plane(of_face.primitive, corner.plane_at_place());
        if (is_face && (is_good(of_face) || at->is_narrow || (!is_good(found) && !is_same))) return of_face;
    }
    if (is_same && corner.edge && at->is_narrow) doubt_narrow(found.primitive.fit);
    if (is_good(found) && !(is_same && corner.margin >= place_tuning().corners.min_margin))
        doubt(found.primitive.fit, FitIssue::other_surface,
              "the place that was picked is at the edge of the plane, so it may belong to the face next to it: pick a "
              "place farther from the edge");
    return found;
}

bool OtherAnswers::is_plane(const Primitive& found, const Shape& plane) const
{
    const ShapeFit& fit = found.fit;
    return fit.has_shape() && fit.shape.kind == ShapeKind::plane &&
           std::fabs(dot(fit.shape.axis, plane.axis)) >= std::cos(place_tuning().corners.max_angle) &&
           distance_to(fit.shape, place_) <= farthest_place(fit);
}

}  // namespace pcm
