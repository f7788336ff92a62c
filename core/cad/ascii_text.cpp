#include "pcm/cad/ascii_text.h"

#include "pcm/cad/utf8.h"

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <map>
#include <sstream>

namespace pcm {
namespace {

// Letters one after the other from a first one: "?" is no letter, "." is not written.
struct Letters {
    std::uint32_t first;
    const char* written;
};
constexpr Letters letters[] = {
    {0xC0,
     "A A A A Ae Aa Ae C E E E E I I I I D N O O O O Oe ? Oe U U U Ue Y Th ss a a a a ae aa ae c e e "
     "e e i i i i d n o o o o oe ? oe u u u ue y th y A a A a A a C c C c C c C c D d D d E e E e E e "
     "E e E e G g G g G g G g H h H h I i I i I i I i I i Ij ij J j K k k L l L l L l L l L l N n N n "
     "N n n N n O o O o O o Oe oe R r R r R r S s S s S s S s T t T t T t U u U u U u U u U u U u W w "
     "Y y Y Z z Z z Z z s"},
    {0x386,
     "A ? E I I ? O ? Y O i A V G D E Z I Th I K L M N X O P R ? S T Y F Ch Ps O I Y a e i i y a v g "
     "d e z i th i k l m n x o p r s s t y f ch ps o i y o y o"},
    {0x400,
     "E E Dj G Ye Dz I Yi J Lj Nj C K I U Dz A B V G D E Zh Z I I K L M N O P R S T U F Kh Ts Ch Sh "
     "Shch . Y . E Yu Ya a b v g d e zh z i i k l m n o p r s t u f kh ts ch sh shch . y . e yu ya e "
     "e dj g ye dz i yi j lj nj c k i u dz"},
    {0x490, "G g"},
};

const std::map<std::uint32_t, std::string>& written_letters()
{
    static const std::map<std::uint32_t, std::string> table = [] {
        std::map<std::uint32_t, std::string> all;
        for (const Letters& row : letters) {
            std::istringstream words(row.written);
            std::uint32_t code = row.first;
            for (std::string word; words >> word; ++code)
                if (word != "?") all[code] = word == "." ? "" : word;
        }
        return all;
    }();
    return table;
}

// Above ASCII; marks, signs and pictures are not part of words.
bool is_of_a_word(std::uint32_t code)
{
    if (code >= 0x10000) return code >= 0x20000 && code < 0x32000;  // ideographs
    if (code < 0x100 || code == not_utf8) return false;             // signs of Latin; not UTF-8
    if (code >= 0x2000 && code < 0x2c00) return false;              // punctuation to arrows and signs
    if (code >= 0x3000 && code < 0x3005) return false;              // punctuation of ideographs
    return !(code >= 0xd800 && code < 0xf900) && !(code >= 0xfe00 && code < 0xfe70);
}

}  // namespace

std::string ascii_text(const std::string& text)
{
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const std::uint32_t code = next_character(text, at);
        if (code < 0x80) {
            const char c = static_cast<char>(code);
            result += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '$' ? c : '_';
        } else if (const auto letter = written_letters().find(code); letter != written_letters().end()) {
            result += letter->second;
        } else if (is_of_a_word(code)) {
            char number[16];
            std::snprintf(number, sizeof number, "U%04X", static_cast<unsigned>(code));
            result += number;
        } else {
            result += '_';
        }
    }
    return result.empty() ? "_" : result;
}

}  // namespace pcm
