// Compares an answer of an operation with its row.
#pragma once

#include "pcm/ops/operation.h"

#include <map>
#include <string>

namespace pcm::test {

inline bool has_type(const ops::Json& value, std::string type)
{
    if (type.back() == '?') {
        if (value.is_null()) return true;
        type.pop_back();
    }
    if (type == "count") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "text") return value.is_string();
    if (type == "flag") return value.is_boolean();
    if (type == "list") return value.is_array();
    return type == "object" && value.is_object();
}

// Keys of the head and the row that are missing or have another type, and keys that neither has; empty: none.
inline std::string faults_of_answer(const ops::Row& row, const ops::Json& answer)
{
    std::map<std::string, std::string> types{{"command", "text"},        {"version", "text"},
                                             {"input", "list"},          {"output", "text?"},
                                             {"points", "count"},        {"seconds", "number"},
                                             {"warnings", "list"},       {"notes", "list"},
                                             {"points_in", "count"},     {"points_per_second", "number"},
                                             {"peak_rss_bytes", "count"}};
    for (const ops::ResultKey& key : row.results) types.emplace(key.key, key.type);
    std::string faults;
    for (const auto& [key, type] : types) {
        if (!answer.contains(key))
            faults += key + " is missing; ";
        else if (!has_type(answer[key], type))
            faults += key + " is " + answer[key].dump() + ", not a " + type + "; ";
    }
    for (const auto& [key, value] : answer.items())
        if (!types.count(key)) faults += key + " is not in the row; ";
    return faults;
}

}  // namespace pcm::test
