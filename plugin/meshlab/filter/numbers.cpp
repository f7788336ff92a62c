#include "plugin/meshlab/filter/numbers.h"

#include "plugin/meshlab/plugin_bases.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace pcm::host {

namespace {

using Numbers = std::map<std::string, QVariant>;
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

bool is_number(const ops::Json& value) { return value.is_number() || value.is_boolean() || value.is_null(); }

double number_of(const ops::Json& value)
{
    if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
    return value.is_null() ? no_number : value.get<double>();
}

QVariant list_of(const std::vector<double>& values)
{
    Eigen::VectorXd list(static_cast<Eigen::Index>(values.size()));
    std::copy(values.begin(), values.end(), list.data());
    return QVariant::fromValue(list);
}

QVariant variant_of(const ops::Json& value)
{
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number_integer()) {
        const double number = value.get<double>();
        if (number >= std::numeric_limits<int>::min() && number <= std::numeric_limits<int>::max())
            return value.get<int>();
    }
    return number_of(value);
}

void add(const std::string& name, const ops::Json& value, Numbers& numbers);

void add_members(const std::string& before, const ops::Json& object, Numbers& numbers)
{
    for (const auto& [key, value] : object.items()) add(before.empty() ? key : before + "_" + key, value, numbers);
}

// Calls `visit` with each number below an object; x, y and z of a place have names of their own.
template <class Visit>
void visit_numbers(const std::string& before, const ops::Json& value, const Visit& visit)
{
    static constexpr std::array<const char*, 3> axes{"_x", "_y", "_z"};
    if (value.is_object()) {
        for (const auto& [key, member] : value.items()) visit_numbers(before + "_" + key, member, visit);
    } else if (value.is_array() && value.size() == axes.size()) {
        for (std::size_t a = 0; a < axes.size(); ++a) visit_numbers(before + axes[a], value[a], visit);
    } else if (value.is_number() || value.is_boolean()) {
        visit(before, number_of(value));
    }
}

// A list of numbers for each member that one of the objects has; the others have no number there.
void add_columns(const std::string& name, const ops::Json& objects, Numbers& numbers)
{
    std::map<std::string, std::vector<double>> columns;
    std::size_t row = 0;
    for (const ops::Json& object : objects) {
        visit_numbers(name, object, [&](const std::string& column, double number) {
            std::vector<double>& values = columns[column];
            if (values.empty()) values.resize(objects.size(), no_number);
            values[row] = number;
        });
        ++row;
    }
    for (const auto& [column, values] : columns) numbers[column] = list_of(values);
}

void add(const std::string& name, const ops::Json& value, Numbers& numbers)
{
    const auto all = [&](bool (*wanted)(const ops::Json&)) { return std::all_of(value.begin(), value.end(), wanted); };
    if (value.is_object()) {
        add_members(name, value, numbers);
    } else if (value.is_array() && !value.empty() && all(&is_number)) {
        std::vector<double> values;
        for (const ops::Json& element : value) values.push_back(number_of(element));
        numbers[name] = list_of(values);
    } else if (value.is_array()) {
        numbers[name + "_count"] = static_cast<int>(value.size());
        if (!value.empty() && all([](const ops::Json& element) { return element.is_object(); }))
            add_columns(name, value, numbers);
    } else if (!value.is_null() && is_number(value)) {
        numbers[name] = variant_of(value);
    }
}

}  // namespace

std::map<std::string, QVariant> numbers_of(const ops::Json& answer)
{
    Numbers numbers;
    add_members({}, answer, numbers);
    return numbers;
}

}  // namespace pcm::host
