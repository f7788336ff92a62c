#include "pcm/bpc/attribute_bytes.h"

#include "pcm/system/error.h"

namespace pcm {

void put_attribute(ByteWriter& out, const Attribute& attribute)
{
    out.put(static_cast<std::uint8_t>(attribute.type));
    out.put(attribute.components);
    out.put(attribute.scale);
    out.put(attribute.offset);
    out.put_string(attribute.name);
    out.put_string(attribute.description);
}

Attribute get_attribute(ByteReader& in)
{
    Attribute attribute;
    attribute.type = static_cast<ScalarType>(in.get<std::uint8_t>());
    attribute.components = in.get<std::uint32_t>();
    attribute.scale = in.get<double>();
    attribute.offset = in.get<double>();
    attribute.name = in.get_string();
    attribute.description = in.get_string();
    return attribute;
}

const Attribute& get_attribute(ByteReader& in, Schema& schema, const std::filesystem::path& path)
{
    const Attribute attribute = get_attribute(in);
    try {
        schema.add(attribute);
    } catch (const Error& error) {
        throw Error(ErrorCode::corrupt, path, std::string("its attributes are invalid: ") + error.what());
    }
    return schema[schema.size() - 1];
}

}  // namespace pcm
