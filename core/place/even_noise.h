// The largest neighbourhood of a place in which the surface's noise is that of the nearest points.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <vector>

namespace pcm {

struct EvenNoise {
    std::size_t count = 0;  // number of nearest points; 0: too few were given
    double noise = 0;       // standard deviation of these from a curved surface through them, source units
};

// `nearest`: points around a place, the nearest first. Neighbourhoods of 24 points and more, each half as large again
// as the one before, get surfaces of second degree by least squares; the largest one whose further points leave the
// surface by no more than chance allows, as its nearer ones do, is the answer. The test is Chow's (1960) of further
// observations: (S2 - S1) / (n2 - n1) against S1 / (n1 - 6), S the sums of squared residuals and n the numbers of
// points, has an F distribution where one surface with one noise has all points; a value that has a probability of less
// than 0.001 there ends the widening. Where neighbours share errors it ends early. One thread.
EvenNoise even_noise(const std::vector<Vec3d>& nearest);

// Whether a variance of `more` degrees of freedom is larger than one of `fewer` by more than chance allows (the F test,
// at the same level). Paulson's approximation (1942).
bool is_more_noise(double variance, double more, double than, double fewer);

}  // namespace pcm
