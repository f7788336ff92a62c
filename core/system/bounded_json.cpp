#include "pcm/system/bounded_json.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t most_bytes = 128000000;
constexpr unsigned most_depth = 32;

// Adds up what a parsed value takes, and keeps nothing. Stops (false) where that is too much, and at what is not JSON.
class Estimate final : public nlohmann::json_sax<Json> {
public:
    bool null() override { return add(0); }
    bool boolean(bool) override { return add(0); }
    bool number_integer(number_integer_t) override { return add(0); }
    bool number_unsigned(number_unsigned_t) override { return add(0); }
    bool number_float(number_float_t, const string_t&) override { return add(0); }
    bool string(string_t& text) override { return add(sizeof(std::string) + allocated(text)); }
    bool binary(binary_t& bytes) override { return add(bytes.size()); }
    bool key(string_t& name) override
    {
        bytes_ += sizeof(std::string) + allocated(name);
        return bytes_ <= most_bytes;
    }
    bool start_object(std::size_t) override { return start(); }
    bool end_object() override { return end(); }
    bool start_array(std::size_t) override { return start(); }
    bool end_array() override { return end(); }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

    bool too_large() const { return bytes_ > most_bytes; }
    bool too_deep() const { return depth_ > most_depth; }

private:
    static constexpr std::uint64_t per_value = 2 * sizeof(Json);            // lists grow by doubling
    static constexpr std::uint64_t per_container = 3 * sizeof(void*) + 16;  // and what the heap needs for each
    static std::uint64_t allocated(const std::string& text) { return text.size() > 15 ? text.size() + 17 : 0; }

    bool add(std::uint64_t bytes)
    {
        bytes_ += per_value + bytes;
        return bytes_ <= most_bytes;
    }
    bool start() { return ++depth_ <= most_depth && add(per_container); }
    bool end()
    {
        --depth_;
        return true;
    }

    std::uint64_t bytes_ = 0;
    unsigned depth_ = 0;
};

}  // namespace

nlohmann::ordered_json parse_bounded_json(const std::string& text)
{
    Estimate estimate;
    Json::sax_parse(text, &estimate);
    if (estimate.too_large())
        throw Error(ErrorCode::bad_format, {},
                    "this holds more values than a list has: they would take more than " + bytes_text(most_bytes) +
                        " of memory",
                    "divide the list, or see whether the file is what you mean");
    if (estimate.too_deep())
        throw Error(ErrorCode::bad_format, {},
                    "lists and objects lie in each other deeper than " + std::to_string(most_depth) + " levels",
                    "see whether the file is what you mean");
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::bad_format, {}, std::string("this is not JSON: ") + error.what());
    }
}

}  // namespace pcm
