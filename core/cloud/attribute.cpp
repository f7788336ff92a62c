#include "pcm/cloud/attribute.h"

#include "pcm/system/error.h"

#include <algorithm>

namespace pcm {

bool is_valid(ScalarType type) { return type >= ScalarType::i8 && type <= ScalarType::f64; }

std::size_t size_of(ScalarType type)
{
    switch (type) {
        case ScalarType::i8:
        case ScalarType::u8:
            return 1;
        case ScalarType::i16:
        case ScalarType::u16:
            return 2;
        case ScalarType::i32:
        case ScalarType::u32:
        case ScalarType::f32:
            return 4;
        case ScalarType::i64:
        case ScalarType::u64:
        case ScalarType::f64:
            return 8;
    }
    return 0;
}

std::string_view name_of(ScalarType type)
{
    static constexpr std::string_view names[] = {"i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64"};
    return is_valid(type) ? names[static_cast<std::size_t>(type) - 1] : std::string_view("?");
}

bool Attribute::operator==(const Attribute& other) const
{
    return name == other.name && type == other.type && components == other.components && scale == other.scale &&
           offset == other.offset && description == other.description;
}

void Schema::add(Attribute attribute)
{
    if (attribute.name.empty()) throw Error(ErrorCode::invalid_argument, {}, "an attribute needs a name");
    if (attribute.components == 0 || !is_valid(attribute.type))
        throw Error(ErrorCode::invalid_argument, {}, "attribute '" + attribute.name + "' has no components or no type");
    if (find(attribute.name))
        throw Error(ErrorCode::invalid_argument, {}, "attribute '" + attribute.name + "' appears twice");
    if (attributes_.size() == max_attributes)
        throw Error(ErrorCode::unsupported, {}, "more than " + std::to_string(max_attributes) + " attributes a point");
    attributes_.push_back(std::move(attribute));
}

std::optional<std::size_t> Schema::find(std::string_view name) const
{
    for (std::size_t i = 0; i < attributes_.size(); ++i)
        if (attributes_[i].name == name) return i;
    return std::nullopt;
}

bool Schema::is_beginning_of(const Schema& other) const
{
    return size() <= other.size() && std::equal(attributes_.begin(), attributes_.end(), other.attributes_.begin());
}

std::size_t Schema::point_bytes() const
{
    std::size_t sum = 0;
    for (const Attribute& attribute : attributes_) sum += attribute.bytes();
    return sum;
}

ColumnSet ColumnSet::whole(const Schema& schema)
{
    ColumnSet set = all(schema);
    set.sizes = true;
    return set;
}

ColumnSet ColumnSet::all(const Schema& schema)
{
    ColumnSet set;
    for (std::size_t i = 0; i < schema.size(); ++i) set.attributes.set(i);
    return set;
}

ColumnSet ColumnSet::named(const Schema& schema, const std::vector<std::string>& names)
{
    ColumnSet set;
    for (const std::string& name : names)
        if (const auto i = schema.find(name)) set.attributes.set(*i);
    return set;
}

}  // namespace pcm
