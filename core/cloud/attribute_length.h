// Which attributes are lengths, so that scaling a cloud scales them.
//
// An attribute's description marks a length: it ends with "source units", for an area "source units^2", for a
// curvature or a number per length "source units^-1", with any exponent of one digit. Files keep descriptions
// (bpc/FORMAT.md; extra bytes of LAS; comments of PLY and PCD), programs that do not know the unit carry them along.
// Attributes without them are lengths by their names alone: "radius" and "mean_distance", as older trees and other
// programs' files have them.
#pragma once

#include "pcm/cloud/attribute.h"

#include <string>
#include <string_view>

namespace pcm {

namespace attribute_unit {
inline constexpr std::string_view length = "source units";
inline constexpr std::string_view radius_description = "of the splat, source units";
}  // namespace attribute_unit

// The power of a length that the values are: 1 for lengths, 2 for areas, -1 for curvatures; 0 for all that does not
// change when the cloud is scaled.
int length_power(const Attribute& attribute);

// The description in at most `most` bytes (20 or more), as LAS has 32 for it: cut between characters of UTF-8, and so
// that what states a length stays.
std::string shortened_description(const std::string& description, std::size_t most);

}  // namespace pcm
