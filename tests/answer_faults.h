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

// What an answer says of its error contradicts itself; empty: it does not.
inline std::string faults_of_accuracy(const ops::Json& answer)
{
    const std::string kind = answer.value("error_kind", "");
    if (kind == "exact")
        return answer["error"] == 0 && answer["error_unit"] == "" && answer["error_of"] == ""
                   ? ""
                   : "exact, with an error; ";
    if (kind != "bound" && kind != "95 %" && kind != "estimated") return "error_kind is '" + kind + "'; ";
    if (answer["error_of"] == "") return "an error of nothing; ";
    if (answer["error"].is_null()) return "";
    if (!(answer["error"] > 0)) return "an error of 0 that is not exact; ";
    return answer["error_unit"] == "" ? "an error without a unit; " : "";
}

// Keys of the head and the row that are missing or have another type, and keys that neither has; empty: none.
inline std::string faults_of_answer(const ops::Row& row, const ops::Json& answer)
{
    std::map<std::string, std::string> types;
    for (const std::vector<ops::ResultKey>& keys : {ops::head_keys(), row.results})
        for (const ops::ResultKey& key : keys) types.emplace(key.key, key.type);
    std::string faults = faults_of_accuracy(answer);
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
