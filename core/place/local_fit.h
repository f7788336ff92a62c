// The shape at picked places: from which neighbourhood, and how near to the surface its points are.
//
// A neighbourhood of few points holds little but the shape, and hardly determines its size. The noise of neighbours is
// less than the distances of scanned points from a surface, since neighbours share errors of scanners. So where they
// are not given,
// - the neighbourhood is widened fourfold, three times at most, as long as the shape of the wider one still passes
//   through the places and most of the former points, holds half as many points again, and is less probable by chance
//   among the points there than the former shape. Where the shape of the first one does not pass through the place, a
//   quarter of its points is tried: a narrow face next to wider ones;
// - the threshold is the noise's own (automatic_threshold()) or 2, 4, 8 or 16 times that: the one at which it is
//   least probable that points spread evenly over the neighbourhood's depth lie so near a surface by chance (Moisan,
//   Stival 2004: an a contrario RANSAC). The first one that holds a surface of the places with all of its noise ends
//   that (`first_threshold`): wider ones add what is not the surface. One at which the noise rises by more than the
//   threshold has taken in another surface, and ends it, too; the threshold is then lowered to 3.3 times the noise
//   found. Kinds are compared with one noise and one distance, whatever thresholds they have (best_kind.h). Thresholds
//   and kinds that hold several surfaces (one_surface.h), and fits of twice the noise of another one at the place, are
//   taken only where there is nothing else, and are doubtful; where the closest points are those of two surfaces, a
//   half, a quarter and an eighth of the threshold are tried.
#pragma once

#include "pcm/fit/shape_fit.h"
#include "pcm/place/even_noise.h"
#include "pcm/place/near_points.h"
#include "pcm/point_cloud.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct LocalFit {
    NearPoints near;   // points around all places, each point once; thinned where they are many
    NearPoints close;  // the nearest (at most 500) points of each place, at full density
    ShapeFit fit;      // to `near`
    // Three standard deviations of the close points from their own surface, whatever its shape, source units; 0:
    // unknown.
    double noise = 0;
    bool is_first_threshold = false;  // whether wider ones were not tried (`first_threshold`)
    EvenNoise even;                   // points around the places; empty where a threshold is given
    std::string next_kind;            // the next best kind with its numbers, for people; empty: there is none
    std::optional<ShapeFit> higher;   // least noise of determined kinds of higher rank, where the best one is curved
    std::vector<std::string> notes;
};

// Whether a shape holds a fit's inliers, within noise that differs from place to place.
bool holds_inliers(const Shape& shape, const LocalFit& local);

struct LocalFitOptions {
    ShapeFitOptions fit;           // threshold 0: chosen
    std::vector<ShapeKind> kinds;  // candidates of choose_kind(); empty: fit.kind
    double radius = 0;             // neighbourhood of a place, source units
    std::size_t count = 0;         // or its number of points; both 0: chosen
    // Whether the first threshold that holds a surface of the places with all of its noise ends the search for one.
    bool first_threshold = true;
    Selection limit;
    ProgressFunction progress;

    // Whether the neighbourhood or the threshold is given, rather than chosen.
    bool is_given() const { return radius > 0 || count > 0 || fit.threshold > 0; }

    // Whether shapes of that kind are looked for, with a neighbourhood and a threshold that are chosen.
    bool may_choose(ShapeKind kind) const
    {
        const bool is_wanted =
            kinds.empty() ? fit.kind == kind : std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
        return is_wanted && !is_given();
    }

    // Is given the shape of the nearest points, where it is one of the places, before wider neighbourhoods are looked
    // at, which takes longer. Not called for a neighbourhood of given size. On the calling thread.
    std::function<void(const LocalFit&)> found_first;
};

// `places` are not empty, and finite. Throws what points_near() and fit_shape() throw.
LocalFit fit_locally(const PointCloud& cloud, const std::vector<Vec3d>& places, const LocalFitOptions& options);

// The shape of the largest neighbourhood whose noise is still that of the smallest ones (even_noise.h): a roof with a
// hundred points, for example. `wide`: what fit_locally() has found with the same arguments. Nothing where a threshold
// or a neighbourhood is given, where that neighbourhood is no narrower than the one of `wide`, where by the same test
// the noise of `wide` is no larger, and where no shape of the points passes through the places.
std::optional<LocalFit> fit_narrowly(const PointCloud& cloud, const std::vector<Vec3d>& places,
                                     const LocalFitOptions& options, const LocalFit& wide);

// Where the shape of `local` is only a piece: the best of those of options.kinds that have more numbers, in a wider
// neighbourhood, which determines them. Nothing where none of them is good there, or a neighbourhood or threshold was
// given.
std::optional<LocalFit> fit_more_numbers(const PointCloud& cloud, const std::vector<Vec3d>& places,
                                         LocalFitOptions options, const LocalFit& local);

}  // namespace pcm
