// The kinds of shapes. Both tables, of what a shape is (shapes/shape_traits.h) and of how it is estimated
// (fit/models/shape_models.h), are made of this one list.
#pragma once

#include <cstdint>

namespace pcm {

// Calls KIND(name) for each. Append only: MeshLab's scripts keep the number.
#define PCM_SHAPE_KINDS(KIND) KIND(plane) KIND(cylinder) KIND(sphere) KIND(cone) KIND(torus)

#define PCM_SHAPE_ENUMERATOR(name) name,
enum class ShapeKind : std::uint8_t { PCM_SHAPE_KINDS(PCM_SHAPE_ENUMERATOR) };
#undef PCM_SHAPE_ENUMERATOR

}  // namespace pcm
