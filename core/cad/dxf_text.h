// Text in DXF files of AutoCAD 2000, which has no UTF-8.
#pragma once

#include <string>

namespace pcm {

// Characters beyond ASCII become \U+XXXX, which CAD programs show as what they are; control characters become blanks,
// and malformed UTF-8 "?". "%" and "^", which begin codes, are written so that they are shown as what they are.
std::string dxf_text(const std::string& utf8);

// None of <>/\":;?*|,=` and control characters. Bytes beyond ASCII may be.
bool may_be_in_layer_name(char c);
// A name that a layer may have: other characters become "_".
std::string dxf_layer_name(const std::string& name);

}  // namespace pcm
