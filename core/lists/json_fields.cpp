#include "pcm/lists/json_fields.h"

#include "pcm/system/error.h"
#include "pcm/system/text_file.h"

#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

using Json = JsonFields::Json;

[[noreturn]] void refuse_format(const std::string& what) { throw Error(ErrorCode::bad_format, {}, what); }

}  // namespace

std::string read_list_file(const std::filesystem::path& file, const char* what)
{
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    return read_text_file(file, std::string("a list of ") + what, most_bytes);
}

JsonFields::JsonFields(const Json& json, std::string where) : json_(json), where_(std::move(where))
{
    if (!json_.is_object()) refuse_format(where_ + " is not an object");
}

void JsonFields::refuse(const char* key, const std::string& problem) const { refuse_format(named(key) + problem); }

double JsonFields::number(const char* key, bool needed, bool negative) const
{
    if (!has(key) && !needed) return 0;
    if (!has(key) || !json_[key].is_number()) refuse(key, " is not a number");
    const double value = json_[key].get<double>();
    if (!std::isfinite(value) || (value < 0 && !negative)) refuse(key, " is negative, or too large");
    return value;
}

double JsonFields::number_or_null(const char* key) const
{
    if (has(key) && json_[key].is_null()) return std::numeric_limits<double>::infinity();
    return number(key, false);
}

std::uint64_t JsonFields::whole(const char* key, std::uint64_t most) const
{
    if (!has(key)) return 0;
    if (!json_[key].is_number_unsigned() || json_[key].get<std::uint64_t>() > most)
        refuse(key, " is not a whole number from 0 to " + std::to_string(most));
    return json_[key].get<std::uint64_t>();
}

std::string JsonFields::text(const char* key, bool needed) const
{
    if (!has(key) && !needed) return {};
    if (!has(key) || !json_[key].is_string()) refuse(key, " is not a text");
    return json_[key].get<std::string>();
}

bool JsonFields::flag(const char* key) const
{
    if (!has(key)) return false;
    if (!json_[key].is_boolean()) refuse(key, " is neither true nor false");
    return json_[key].get<bool>();
}

const Json& JsonFields::list(const char* key, bool needed) const
{
    static const Json none = Json::array();
    if (!has(key) && !needed) return none;
    if (!has(key) || !json_[key].is_array()) refuse(key, " is not a list");
    return json_[key];
}

Vec3d JsonFields::vector(const char* key) const { return vector_of(list(key, true), named(key)); }

JsonFields JsonFields::object(const char* key) const
{
    if (!has(key)) refuse(key, " is not there");
    return {json_[key], named(key)};
}

Vec3d vector_of(const Json& json, const std::string& where)
{
    if (!json.is_array() || json.size() != 3) refuse_format(where + " is not three numbers");
    Vec3d vector;
    for (std::size_t a = 0; a < 3; ++a) {
        if (!json[a].is_number()) refuse_format(where + " is not three numbers");
        vector[a] = json[a].get<double>();
    }
    if (!is_finite(vector)) refuse_format(where + " is not finite");
    return vector;
}

}  // namespace pcm
