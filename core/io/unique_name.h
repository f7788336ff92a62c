// Names of attributes, each of them once in a schema.
#pragma once

#include "pcm/cloud/attribute.h"

#include <string>

namespace pcm {

// `name`, or `name` with "_2", "_3", ... when the schema has it already.
std::string unique_name(const Schema& schema, const std::string& name);

}  // namespace pcm
