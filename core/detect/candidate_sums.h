// A shape that the final fit of a detection improves, and what is added up over its points.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/detect/drawn_points.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/fit/shape_sums.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/extreme_points.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace pcm {

// Points that a candidate is fitted to: all; those whose neighbours are its own, too, and which lie inside of a face;
// or all inside of a face (face_interior.h).
enum class FittedTo { all, interior, face };

// Source coordinates and units.
struct FitCandidate {
    Shape shape;
    Vec3d middle{};
    double extent = 0;  // diagonal of the box around its points, > 0
    Vec3d corner{};     // smallest coordinates of that box
    double threshold = 0;
    bool whole = false, thin = false, of_strip = false;  // as those of its hypothesis
    std::uint32_t part = 0;                              // place in AssignedPoints::parts
    FittedTo fitted_to = FittedTo::interior;
};

// A point whose neighbours are the candidate's, and inside a face as face_interior.h has it, as all points of other
// shapes are; `shift`: that of its station, or null.
struct CandidatePoint {
    Vec3d place;
    std::uint64_t number = 0;
    bool inside = false, in_face = false;
    const Vec3d* shift = nullptr;
};

// What bounds, errors and doubts need of a candidate's points in addition to the sums.
struct CandidateFacts {
    CandidateFacts(const FitCandidate& candidate, std::size_t most);

    ExtremePoints ends;
    ErrorAgreement alike;
    DrawnPoints some;   // points it is fitted to, and the border of a face
    DrawnPoints moved;  // the same ones, where their stations most probably were
};

struct CandidateSums {
    // Maximum numbers of points that are drawn, for the outline of a face and for the facts; 0: neither is kept.
    CandidateSums(const FitCandidate& candidate, std::size_t of_outline, std::size_t of_facts);

    // `shape`: the candidate's. Sums do not depend on the order but for rounding.
    void add(const CandidatePoint& seen, const Shape& shape);
    void add(const CandidateSums& other);

    // What should be fitted to: enough of the candidate's points, or of a face, determine it.
    FittedTo chosen(double threshold) const;
    const ShapeSums& best() const;
    // Noise of the points that doubts come from: those next to a face's border may be of several surfaces.
    double drawn_noise(const ShapeFit& fit) const;

    ShapeSums interior, face, all;  // interior: points inside both ways
    FittedTo fitted_to;
    bool is_face = false;
    std::optional<DrawnPoints> outline;
    std::optional<CandidateFacts> facts;
};

}  // namespace pcm
