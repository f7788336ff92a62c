// An attribute as bytes: the same in the headers of chunks, in cloud blocks and in the index of a tree.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/cloud/attribute.h"

namespace pcm {

void put_attribute(ByteWriter& out, const Attribute& attribute);
// Throws Error(corrupt) when the bytes end too early. Type, name and components are as they stand there: the caller
// checks them (Schema::add does).
Attribute get_attribute(ByteReader& in);
// Reads an attribute and adds it to the schema. Throws Error(corrupt), which names `path`, for one that no schema has.
const Attribute& get_attribute(ByteReader& in, Schema& schema, const std::filesystem::path& path);

}  // namespace pcm
