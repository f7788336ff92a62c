#include "pcm/io/unique_name.h"

namespace pcm {

std::string unique_name(const Schema& schema, const std::string& name)
{
    std::string candidate = name;
    for (int number = 2; schema.find(candidate); ++number) candidate = name + "_" + std::to_string(number);
    return candidate;
}

}  // namespace pcm
