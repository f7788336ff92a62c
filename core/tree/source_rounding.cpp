#include "pcm/tree/source_rounding.h"

#include "pcm/bpc/byte_order.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr const char* key = "pcm.decimals";

// Unchanged where the block is not as it should be.
DecimalPlaces decimals_in(const Metadata& block)
{
    DecimalPlaces places{no_decimals, no_decimals, no_decimals};
    const std::string text(reinterpret_cast<const char*>(block.value.data()), block.value.size());
    std::size_t at = 0;
    for (int& of_axis : places) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        const std::string word = text.substr(at, end - at);
        at = std::min(end + 1, text.size());
        if (word == "-") continue;
        if (word.empty() || word.size() > 2 || word.find_first_not_of("0123456789") != std::string::npos) return places;
        if (const int digits = std::stoi(word); digits <= most_decimal_places) of_axis = digits;
    }
    return places;
}

}  // namespace

double power_of_ten(int places)
{
    static constexpr double powers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    return powers[places];
}

void DecimalCount::merge(const DecimalCount& other)
{
    places_ = std::max(places_, other.places_);
    largest_ = std::max(largest_, other.largest_);
}

void DecimalCount::save(ByteWriter& out) const
{
    out.put(static_cast<std::int32_t>(places_));
    out.put(largest_);
}

DecimalCount DecimalCount::load(ByteReader& in)
{
    DecimalCount count;
    count.places_ = in.get<std::int32_t>();
    count.largest_ = in.get<double>();
    return count;
}

int DecimalCount::places() const
{
    if (places_ > most_decimal_places || !(largest_ * power_of_ten(places_) < most_integer)) return no_decimals;
    return places_;
}

SourceRounding::SourceRounding(const DecimalPlaces& places)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (places[a] >= 0 && places[a] <= most_decimal_places) power_[a] = power_of_ten(places[a]);
}

SourceRounding::SourceRounding(const TreeInfo& info)
{
    single_ = info.position_type == ScalarType::f32;
    if (info.position_type != ScalarType::f64) return;
    for (const Metadata& block : info.metadata)
        if (block.key == key) *this = SourceRounding(decimals_in(block));
}

void set_decimals(std::vector<Metadata>& metadata, const DecimalPlaces& places)
{
    metadata.erase(
        std::remove_if(metadata.begin(), metadata.end(), [](const Metadata& block) { return block.key == key; }),
        metadata.end());
    std::string text;
    for (const int digits : places)
        text += (text.empty() ? "" : " ") + (digits < 0 ? std::string("-") : std::to_string(digits));
    if (text == "- - -") return;
    Metadata block{key, {}};
    block.value.resize(text.size());
    std::memcpy(block.value.data(), text.data(), text.size());
    metadata.push_back(std::move(block));
}

}  // namespace pcm
