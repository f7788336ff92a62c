// Lists of primitives. An accepted list is written again, and reads back as the same text.

#include "pcm/cad/primitive_files.h"
#include "pcm/system/error.h"

#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace pcm;
    std::vector<Primitive> primitives;
    try {
        primitives = parse_primitives(std::string(reinterpret_cast<const char*>(data), size));
    } catch (const Error&) {
        return 0;
    }
    for (const Primitive& primitive : primitives) check(primitive.fit.shape);
    const std::string text = json_of(primitives);
    if (json_of(parse_primitives(text)) != text) std::abort();
    return 0;
}
