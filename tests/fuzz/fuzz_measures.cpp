// Lists of measures. An accepted list is written again, and reads back as the same text; its numbers are computed, or
// refused.

#include "pcm/measure/measure_list.h"
#include "pcm/system/error.h"

#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace pcm;
    MeasureList list;
    try {
        list = MeasureList::parse(std::string(reinterpret_cast<const char*>(data), size));
    } catch (const Error&) {
        return 0;
    }
    const std::string text = list.text();
    if (MeasureList::parse(text).text() != text) std::abort();
    for (std::size_t i = 0; i < list.size(); ++i) {
        try {
            values_of(list[i]);
        } catch (const Error&) {
        }
    }
    return 0;
}
