#include "pcm/lists/undo_list.h"

#include "pcm/system/error.h"

namespace pcm {

void check_list_name(const std::string& name, const char* what)
{
    constexpr std::size_t longest = 1000;
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    const char* wrong = name.empty()                                        ? "is empty"
                        : name.size() > longest                             ? "is longer than 1000 bytes"
                        : std::any_of(name.begin(), name.end(), is_control) ? "has control characters"
                                                                            : nullptr;
    if (wrong) throw Error(ErrorCode::invalid_argument, {}, std::string("the name of a ") + what + " " + wrong);
}

void refuse_index(const char* what, std::size_t index, std::size_t size)
{
    throw Error(ErrorCode::invalid_argument, {},
                std::string("there is no ") + what + " number " + std::to_string(index + 1) + "; the list has " +
                    std::to_string(size));
}

}  // namespace pcm
