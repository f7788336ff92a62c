#include "pcm/place/edge_answers.h"

#include "pcm/place/corner_at_place.h"
#include "pcm/place/face_at_place.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape.h"

#include <cmath>
#include <utility>

namespace pcm {
namespace {

bool is_good(const FittedPrimitive& found) { return found.primitive.fit.verdict == FitVerdict::good; }

bool is_flat(const FittedPrimitive& found) { return traits_of(found.primitive.fit.shape.kind).is_flat(); }

void doubt_narrow(ShapeFit& fit)
{
    if (fit.verdict != FitVerdict::good) return;
    doubt(fit, FitIssue::thin_arc,
          "the face at the place is hardly wider than its noise, so points of the faces next to it may have moved it");
}

}  // namespace

FittedPrimitive EdgeAnswers::or_face(FittedPrimitive found) const
{
    const bool may_be_two = !is_flat(found) && found.agreement > place_tuning().following.max_other_agreement;
    if (is_good(found) && !may_be_two) return found;
    std::optional<LocalFit> face = fit_face(cloud_, place_, options_);
    if (!face) return found;
    FittedPrimitive of_face = follow_(std::move(*face), {});
    return is_good(of_face) ? of_face : found;
}

FittedPrimitive EdgeAnswers::or_corner(FittedPrimitive found) const
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

bool EdgeAnswers::is_plane(const Primitive& found, const Shape& plane) const
{
    const ShapeFit& fit = found.fit;
    return fit.has_shape() && fit.shape.kind == ShapeKind::plane &&
           std::fabs(dot(fit.shape.axis, plane.axis)) >= std::cos(place_tuning().corners.max_angle) &&
           distance_to(fit.shape, place_) <= farthest_place(fit);
}

}  // namespace pcm
