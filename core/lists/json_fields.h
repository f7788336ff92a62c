// Reading lists that are kept as JSON: fields of objects, and errors that name them.
#pragma once

#include "pcm/cloud/vector.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace pcm {

// The bytes of a file; at most 64 MB. `what` the list has: "measures". Throws Error(bad_format) for a longer file, and
// what reading throws.
std::string read_list_file(const std::filesystem::path& file, const char* what);

// Fields of one object, which outlives this. All functions throw Error(bad_format), naming the field and the object,
// for a field that is of another type, or that is needed and not there.
class JsonFields {
public:
    using Json = nlohmann::ordered_json;

    // `where` names the object in errors: "measure 3".
    JsonFields(const Json& json, std::string where);

    bool has(const char* key) const { return json_.contains(key); }
    // Finite; 0 where it is not there. Not below 0 unless `negative`.
    double number(const char* key, bool needed, bool negative = false) const;
    // The same, where null is infinity.
    double number_or_null(const char* key) const;
    // A whole number from 0 to `most`; 0 where it is not there.
    std::uint64_t whole(const char* key, std::uint64_t most) const;
    std::string text(const char* key, bool needed) const;  // empty where it is not there
    bool flag(const char* key) const;                      // false where it is not there
    const Json& list(const char* key, bool needed) const;  // empty where it is not there
    Vec3d vector(const char* key) const;                   // three finite numbers
    JsonFields object(const char* key) const;
    std::string named(const char* key) const { return "'" + std::string(key) + "' of " + where_; }
    // Throws: the field, and what is wrong with it.
    [[noreturn]] void refuse(const char* key, const std::string& problem) const;

private:
    const Json& json_;
    std::string where_;
};

// Three finite numbers; `where` names the list in errors.
Vec3d vector_of(const nlohmann::ordered_json& json, const std::string& where);

}  // namespace pcm
