#include "pcm/filter/common_schema.h"

#include "pcm/cloud/with_type.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

bool is_float(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }

bool same_kind(const Attribute& a, const Attribute& b)
{
    return a.type == b.type && a.scale == b.scale && a.offset == b.offset;
}

// Whether `wide` has all values of `type`.
bool holds(ScalarType wide, ScalarType type)
{
    return with_type(wide, [&](auto w) {
        return with_type(type, [&](auto t) {
            using W = std::numeric_limits<decltype(w)>;
            using T = std::numeric_limits<decltype(t)>;
            if (!T::is_integer) return !W::is_integer && W::digits >= T::digits;
            return W::digits >= T::digits && (W::is_signed || !T::is_signed);
        });
    });
}

// In this order the first that holds all of them is the smallest.
ScalarType common_type(const std::vector<const Attribute*>& all)
{
    static constexpr ScalarType types[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                           ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                           ScalarType::f32, ScalarType::f64};
    const bool floats = std::any_of(all.begin(), all.end(), [](const Attribute* a) { return is_float(a->type); });
    for (const ScalarType type : types) {
        if (floats && !is_float(type)) continue;
        if (std::all_of(all.begin(), all.end(), [&](const Attribute* a) { return holds(type, a->type); })) return type;
    }
    return ScalarType::f64;
}

Attribute common_attribute(const std::vector<const Attribute*>& all)
{
    Attribute common = *all[0];
    if (common.name == attribute_name::rgb && common.components == 3) {
        common.type = ScalarType::u16;
        common.scale = 1;
        common.offset = 0;
        return common;
    }
    const bool one_scale = std::all_of(all.begin(), all.end(), [&](const Attribute* a) {
        return a->scale == common.scale && a->offset == common.offset;
    });
    if (one_scale) {
        common.type = common_type(all);
    } else {
        common.type = ScalarType::f64;
        common.scale = 1;
        common.offset = 0;
    }
    return common;
}

template <class To>
To rounded(double value)
{
    if constexpr (std::is_floating_point_v<To>) {
        return static_cast<To>(value);
    } else {
        if (std::isnan(value)) return 0;
        const double least = static_cast<double>(std::numeric_limits<To>::min());
        const double most = static_cast<double>(std::numeric_limits<To>::max());
        return static_cast<To>(std::clamp(std::nearbyint(value), least, most));
    }
}

// What a raw colour is multiplied by to have 16 bits.
double colour_factor(ScalarType type)
{
    if (type == ScalarType::u8) return 257;
    return is_float(type) ? 65535 : 1;
}

}  // namespace

CommonSchemas common_schemas(const std::vector<Schema>& schemas)
{
    std::vector<std::vector<Attribute>> converted;
    for (const Schema& schema : schemas) converted.emplace_back(schema.begin(), schema.end());
    CommonSchemas result;
    for (std::size_t first = 0; first < schemas.size(); ++first)
        for (const Attribute& attribute : schemas[first]) {
            // All of this name, once: from the first cloud that has it.
            std::vector<const Attribute*> all;
            std::vector<Attribute*> targets;
            bool seen = false, differ = false;
            for (std::size_t s = 0; s < schemas.size(); ++s)
                if (const auto k = schemas[s].find(attribute.name);
                    k && schemas[s][*k].components == attribute.components) {
                    seen = seen || s < first;
                    differ = differ || !same_kind(schemas[s][*k], attribute);
                    all.push_back(&schemas[s][*k]);
                    targets.push_back(&converted[s][*k]);
                }
            if (seen || !differ) continue;
            const Attribute common = common_attribute(all);
            for (Attribute* target : targets) *target = common;
            std::string types;
            for (const Attribute* a : all)
                if (const std::string type(name_of(a->type)); types.find(type) == std::string::npos)
                    types += (types.empty() ? "" : ", ") + type;
            result.notes.push_back("attribute '" + attribute.name + "' has different types or scales (" + types +
                                   "); it is " + std::string(name_of(common.type)) + " for all points");
        }
    for (const std::vector<Attribute>& attributes : converted) {
        Schema schema;
        for (const Attribute& attribute : attributes) schema.add(attribute);
        result.schemas.push_back(std::move(schema));
    }
    return result;
}

void convert_column(const Attribute& from, const Column& column, const Attribute& to, Column& converted)
{
    converted = Column(to);
    converted.resize(column.size());
    const std::size_t count = column.size() * from.components;
    const bool colours = to.name == attribute_name::rgb && to.components == 3;
    with_type(from.type, [&](auto f) {
        using From = decltype(f);
        const From* const in = column.as<From>();
        return with_type(to.type, [&](auto t) {
            using To = decltype(t);
            To* const out = converted.as<To>();
            const bool exact = from.scale == to.scale && from.offset == to.offset && !colours;
            const double factor = colours ? colour_factor(from.type) : from.scale;
            const double offset = colours ? 0 : from.offset;
            for (std::size_t i = 0; i < count; ++i)
                out[i] = exact ? static_cast<To>(in[i]) : rounded<To>(static_cast<double>(in[i]) * factor + offset);
            return 0;
        });
    });
}

}  // namespace pcm
