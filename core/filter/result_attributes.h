// Attributes that a filter writes into a tree.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/update/tree_changes.h"

#include <cstddef>

namespace pcm {

// The place of an attribute in the tree's schema: of the one that has its name, whose values are to be overwritten, or
// of a new one. Throws Error(invalid_argument) when the tree has an attribute of that name but another type, and what
// TreeChanges::add_attribute() throws.
std::size_t place_for(TreeChanges& changes, const Attribute& attribute);

namespace attribute_name {
inline constexpr std::string_view curvature = "curvature";                  // f32
inline constexpr std::string_view normal_confidence = "normal_confidence";  // u8: NormalConfidence
inline constexpr std::string_view mean_distance = "mean_distance";          // f32, source units
inline constexpr std::string_view outlier = "outlier";                      // u8: 1 for an outlier, else 0
}  // namespace attribute_name

}  // namespace pcm
