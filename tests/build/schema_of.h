// Short schemas for tests.
#pragma once

#include "pcm/cloud/attribute.h"

#include <initializer_list>
#include <string>
#include <utility>

namespace pcm::test {

// Attributes named a, b, c, ... of these types and numbers of components.
inline Schema schema_of(std::initializer_list<std::pair<ScalarType, unsigned>> types)
{
    Schema schema;
    char name = 'a';
    for (const auto& [type, components] : types) {
        Attribute attribute;
        attribute.name = std::string(1, name++);
        attribute.type = type;
        attribute.components = components;
        schema.add(attribute);
    }
    return schema;
}

}  // namespace pcm::test
