// The numbers of an operation's answer, as newer MeshLab and PyMeshLab take them from filters.
#pragma once

#include "pcm/ops/result.h"

#include <QVariant>

#include <map>
#include <string>

namespace pcm::host {

// Numbers, flags and lists of numbers; texts are left out, as Python's dict has no place for them. Members of an object
// get its name before theirs: fit_radius. A list of objects is its length, primitives_count, and a list of numbers for
// each member, primitives_shape_radius, with NaN for the objects that lack it; places are three lists, _x, _y and _z.
std::map<std::string, QVariant> numbers_of(const ops::Json& answer);

}  // namespace pcm::host
