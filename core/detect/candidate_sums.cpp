#include "pcm/detect/candidate_sums.h"

#include "pcm/detect/tuning.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape_traits.h"

namespace pcm {
namespace {

constexpr std::uint64_t least_inside = 20;  // points that a candidate is fitted to without the others

bool enough_interior_points(const CandidateSums& sums)
{
    const double enough = detect_tuning().merging.min_interior * static_cast<double>(sums.all.points());
    return sums.interior.points() >= least_inside && static_cast<double>(sums.interior.points()) >= enough;
}

// Whether the face without its border determines the angle nearly as well as all of it.
bool is_face_enough(const CandidateSums& sums, double threshold)
{
    if (sums.face.points() < least_inside) return false;
    const ShapeFit inner = sums.face.result(threshold), whole = sums.all.result(threshold);
    return inner.errors.angle * whole.noise <= detect_tuning().faces.max_growth * whole.errors.angle * inner.noise;
}

bool is_fitted(const CandidateSums& sums, const CandidatePoint& seen)
{
    return sums.fitted_to == FittedTo::all || (seen.in_face && (sums.fitted_to == FittedTo::face || seen.inside));
}

}  // namespace

CandidateFacts::CandidateFacts(const FitCandidate& candidate, std::size_t most)
    : ends(candidate.shape, candidate.middle),
      alike(candidate.corner, candidate.extent / place_tuning().growth.agreement_cubes),
      some(most),
      moved(most)
{
}

CandidateSums::CandidateSums(const FitCandidate& candidate, std::size_t of_outline, std::size_t of_facts)
    : interior(candidate.shape, candidate.middle, candidate.extent),
      face(interior),
      all(interior),
      fitted_to(candidate.fitted_to),
      is_face(traits_of(candidate.shape.kind).is_flat())
{
    if (of_facts > 0) facts.emplace(candidate, of_facts);
    if (of_outline > 0 && is_face) outline.emplace(of_outline);
}

void CandidateSums::add(const CandidatePoint& seen, const Shape& shape)
{
    const Vec3d& p = seen.place;
    all.add(p);
    if (seen.inside && seen.in_face) interior.add(p);
    if (is_face && seen.in_face) face.add(p);
    if (outline) outline->add(p, seen.number);
    if (!facts) return;
    facts->ends.add(p);
    if (fitted_to == FittedTo::interior && !seen.inside) return;
    facts->some.add(p, seen.number);
    if (seen.shift) facts->moved.add(p - *seen.shift, seen.number);
    if (is_fitted(*this, seen)) facts->alike.add(p, signed_distance(shape, p));
}

void CandidateSums::add(const CandidateSums& other)
{
    all.add(other.all);
    interior.add(other.interior);
    face.add(other.face);
    if (outline) outline->add(*other.outline);
    if (!facts) return;
    facts->ends.add(other.facts->ends);
    facts->alike.add(other.facts->alike);
    facts->some.add(other.facts->some);
    facts->moved.add(other.facts->moved);
}

FittedTo CandidateSums::chosen(double threshold) const
{
    if (enough_interior_points(*this)) return FittedTo::interior;
    return is_face && is_face_enough(*this, threshold) ? FittedTo::face : FittedTo::all;
}

const ShapeSums& CandidateSums::best() const
{
    return fitted_to == FittedTo::face ? face : fitted_to == FittedTo::interior ? interior : all;
}

double CandidateSums::drawn_noise(const ShapeFit& fit) const
{
    return fitted_to == FittedTo::face ? all.result(fit.threshold).noise : fit.noise;
}

}  // namespace pcm
