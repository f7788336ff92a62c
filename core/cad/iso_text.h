// Texts of ISO 10303-21 files: STEP and IFC.
#pragma once

#include <string>

namespace pcm {

// Takes what is whole from `text`, UTF-8. Characters beyond ASCII become four hexadecimal digits within \X2\ and \X0\,
// or eight within \X4\ and \X0\.
std::string iso_characters(std::string& text);

// The whole text in quotation marks, with those and the backslashes in it doubled and without control characters.
std::string iso_string(const std::string& text);

// The same of a label, which has 255 characters at most: its first ones.
std::string iso_label(const std::string& text);

// The shortest text that reads back as the number, with the decimal point that a REAL has; finite.
std::string iso_real(double number);

}  // namespace pcm
