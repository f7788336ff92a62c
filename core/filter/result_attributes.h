// Attributes that a filter writes into a tree.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/tree/tree.h"
#include "pcm/update/tree_changes.h"

#include <cstddef>
#include <string>

namespace pcm {

// Whether an attribute may be written that is named by the user, or whose values a cloud can have from elsewhere.
// Throws Error(invalid_argument), unless `overwrite`, for a name that files of LAS or the library itself give a meaning
// (classification, intensity, gps_time, normal, ...), and for an attribute of the tree that has this name but not this
// description: by its description an attribute is known as one that the same operation made. Throws
// Error(invalid_argument) for an attribute of another type in any case.
void check_may_write(const Tree& tree, const Attribute& attribute, bool overwrite);

// The place of an attribute in the tree's schema: of the one that has its name, whose values are to be overwritten, or
// of a new one. Throws Error(invalid_argument) when the tree has an attribute of that name but another type, and what
// TreeChanges::add_attribute() throws.
std::size_t place_for(TreeChanges& changes, const Attribute& attribute);

// The same for a schema that is not a tree's yet, to which a new attribute is added.
std::size_t place_for(const Tree& tree, Schema& schema, const Attribute& attribute);

namespace attribute_name {
inline constexpr std::string_view curvature = "curvature";                  // f32
inline constexpr std::string_view normal_confidence = "normal_confidence";  // u8: NormalConfidence
inline constexpr std::string_view mean_distance = "mean_distance";          // f32, source units
inline constexpr std::string_view outlier = "outlier";                      // u8: 1 for an outlier, else 0
}  // namespace attribute_name

// What the library makes under a name of the user's choice, with the descriptions by which it is known again. At
// most 32 bytes, the length that LAS has for them.
Attribute selection_attribute(const std::string& name);  // u8: 1 for the points of a saved selection, else 0
Attribute outlier_attribute();
Attribute primitive_attribute(const std::string& name);  // u32: the number of the point's primitive, or 0

}  // namespace pcm
