// How the attributes of several points become those of one point.
#pragma once

#include "pcm/cloud/attribute.h"

#include <string>
#include <string_view>
#include <vector>

namespace pcm {

enum class Combination {
    // The mean of the values, in double, or exactly where they are integers; rounded to the attribute's type at the
    // very end (halves up). Values that are NaN or infinite are left out; where all are, the result is NaN.
    mean,
    // The mean as above, then scaled to length 1: for normals. Where the mean vanishes: the first normal that is not 0.
    direction,
    // The value of most points; the smallest of several such values. For integers.
    majority,
};

// Whether an attribute of this name and an integer type names categories, counts or flags, which have no
// useful mean: classification, return numbers, flags, identities and indices, as LAS, E57 and this library name them.
bool is_categorical(std::string_view name);

// How each attribute is combined: `by_majority` and `by_mean` name exceptions from the rule above. Throws
// Error(invalid_argument) for names that the schema lacks, names in both lists, and a majority of floating-point
// values.
std::vector<Combination> combinations_of(const Schema& schema, const std::vector<std::string>& by_majority = {},
                                         const std::vector<std::string>& by_mean = {});

}  // namespace pcm
